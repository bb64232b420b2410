#include "clients/sweep/journal.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

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
  fs::create_directories(folder_, error);
  if (error) refuse(error.message());
  const fs::path description = folder_ / "sweep.json";
  const bool begun = fs::exists(description);
  if (!begun && fs::exists(folder_ / "runs.csv")) refuse("it has a runs.csv without sweep.json");
  if (begun) {
    const json before = json::parse(text_of(description), nullptr, false);
    const std::string differing = differences(before, definition);
    if (!differing.empty()) {
      throw Error(fmt::format("{} holds another sweep, which differs in {}; give another --output",
                              folder_.string(), differing));
    }
  }
  file_ = open((folder_ / "runs.csv").c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file_ < 0) refuse(std::strerror(errno));
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    throw Error(folder_.string() +
                ": another sweep is writing there; wait for it, or give "
                "another --output");
  }
  if (!begun) {
    std::ofstream stream(description);
    stream << definition.dump(1) << std::endl;
    if (!stream) refuse("sweep.json cannot be written");
  }
  resume(header);
}

Journal::~Journal() {
  if (file_ >= 0) close(file_);
}

void Journal::resume(const std::string& header) {
  const std::string text = text_of(folder_ / "runs.csv");
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
