#include "clients/sweep/journal.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "clients/common/file_text.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::chrono::milliseconds kLookAgain{10};
constexpr int kLooks = 100;  // a killed sweep's workers, which hold its lock too, are about to end

/// Keys in which two definitions differ.
std::string differences(const json& before, const json& now) {
  std::string names;
  for (const auto& [key, value] : now.items()) {
    if (!before.contains(key) || before[key] != value) {
      names += (names.empty() ? "`" : ", `") + key + '`';
    }
  }
  return names;
}

}  // namespace

Journal::Journal(fs::path folder, const json& definition, const std::string& header)
    : folder_(std::move(folder)) {
  std::error_code error;
  if (fs::exists(folder_) && !fs::is_directory(folder_)) refuse("is a file, not a folder");
  const fs::path parent = fs::absolute(folder_ / "").parent_path().parent_path();
  if (!fs::is_directory(parent)) refuse("there is no folder " + parent.string() + " to put it in");
  fs::create_directory(folder_, error);
  if (error) refuse(error.message());
  try {
    lock();
    define(definition);
    file_ = open((folder_ / "runs.csv").c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (file_ < 0) refuse(std::strerror(errno));
    resume(header);
  } catch (...) {
    close_all();
    throw;
  }
}

Journal::~Journal() { close_all(); }

void Journal::close_all() const {
  for (const int file : {file_, lock_}) {
    if (file >= 0) close(file);
  }
}

void Journal::lock() {
  lock_ = open((folder_ / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) refuse(std::strerror(errno));
  for (int look = 0; flock(lock_, LOCK_EX | LOCK_NB) != 0; ++look) {
    if (look == kLooks) {
      throw Error(folder_.string() +
                  ": another sweep is writing there; wait for it, or give "
                  "another --output");
    }
    std::this_thread::sleep_for(kLookAgain);
  }
}

void Journal::define(const json& definition) const {
  const fs::path description = folder_ / "sweep.json";
  if (!fs::exists(description)) {
    if (fs::exists(folder_ / "runs.csv")) refuse("it has a runs.csv without sweep.json");
    return write_whole(description, definition.dump(1) + '\n');
  }
  const json before = json::parse(file_text(description), nullptr, false);
  if (!before.is_object() && !(before.is_null() && definition.is_null())) {
    refuse("its sweep.json cannot be read: it is no whole JSON object");
  }
  const std::string differing = differences(before, definition);
  if (!differing.empty()) {
    throw Error(fmt::format("{} holds another sweep, which differs in {}; give another --output",
                            folder_.string(), differing));
  }
}

/// All of it is there, or nothing.
void Journal::write_whole(const fs::path& file, const std::string& text) const {
  const fs::path draft = file.string() + ".new";
  const int there = open(draft.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (there < 0) refuse(std::strerror(errno));
  const bool written =
      write(there, text.data(), text.size()) == std::ssize(text) && fsync(there) == 0;
  close(there);
  std::error_code error;
  if (written) fs::rename(draft, file, error);
  if (!written || error) refuse(file.filename().string() + " cannot be written");
}

void Journal::resume(const std::string& header) {
  const std::string text = file_text(folder_ / "runs.csv");
  const std::size_t whole = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
  if (ftruncate(file_, static_cast<off_t>(whole)) != 0) refuse(std::strerror(errno));
  if (whole == 0) return put(header);
  if (!text.starts_with(header)) refuse("runs.csv has other columns than this sweep");
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(whole);
  std::size_t begin = header.size();
  for (std::int64_t run = 0; begin < whole; ++run) {
    if (!text.substr(begin, 24).starts_with(fmt::format("{},", run))) {
      refuse(fmt::format("runs.csv: the line of run {} is missing", run));
    }
    begin = static_cast<std::size_t>(
        std::find(text.begin() + static_cast<std::ptrdiff_t>(begin), end, '\n') - text.begin() + 1);
    written_ = run + 1;
  }
}

void Journal::take(std::int64_t run, std::string line) {
  waiting_.emplace(run, std::move(line));
  std::string ready;
  while (!waiting_.empty() && waiting_.begin()->first == written_) {
    ready += waiting_.begin()->second;
    waiting_.erase(waiting_.begin());
    ++written_;
  }
  if (!ready.empty()) put(ready);
}

void Journal::put(const std::string& text) {
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t size = write(file_, text.data() + sent, text.size() - sent);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) refuse(std::strerror(errno));
    sent += static_cast<std::size_t>(size);
  }
}

void Journal::refuse(const std::string& why) const {
  throw Error(fmt::format("{}: {}; give another --output", folder_.string(), why));
}

}  // namespace gyrotwin
