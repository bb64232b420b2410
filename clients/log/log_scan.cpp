#include "clients/log/log_scan.hpp"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <utility>

#include "clients/log/log.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kLongestName = 60;   // MATLAB takes 63, and two may need telling apart
constexpr std::int64_t kLookEvery = 1024;  // events between looks at signals

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// "LIVE_STATE" for PROTOTYPE_B/LIVE/STATE of a rig with that prefix.
std::string identifier(std::string_view channel, const std::optional<About>& about) {
  if (about && !about->prefix.empty() && channel.starts_with(about->prefix + '/')) {
    channel.remove_prefix(about->prefix.size() + 1);
  }
  std::string name(channel.substr(0, kLongestName));
  for (char& c : name) {
    if (!is_letter(c) && !(c >= '0' && c <= '9')) c = '_';
  }
  return name.empty() || !is_letter(name.front()) ? "x" + name : name;
}

}  // namespace

LogScan::LogScan(std::filesystem::path file, Selection selection, std::int64_t every)
    : file_(std::move(file)),
      selection_(std::move(selection)),
      every_(every),
      terminal_(::isatty(STDERR_FILENO) == 1) {}

LogScan::~LogScan() { clear(); }

void LogScan::read(const std::function<void(const LogMessage&)>& use) {
  Log log(file_);
  Picker picker(selection_);
  for (LogStream& stream : streams_) stream.meant = stream.messages = 0;
  unknown_.clear();
  std::int64_t events = 0, bytes = 0;
  while (const auto event = log.next()) {
    bytes += static_cast<std::int64_t>(size_in_log(*event));
    if (++events % kLookEvery == 0) {
      show(fmt::format("{}: {} % read", file_.string(),
                       100 * (bytes + log.damage().bytes_lost) / log.size()));
    }
    if (!picker.takes(*event) || is_log_channel(event->channel)) continue;
    const LcmType* type = log.catalog().type_of(*event);
    if (type == nullptr) {
      ++unknown_[std::string(event->channel)];
      continue;
    }
    const std::size_t index = stream_of(log.catalog(), *event, *type);
    if (streams_[index].meant++ % every_ != 0) continue;
    ++streams_[index].messages;
    // The decimal fraction that was recorded, to the last digit.
    use({index, *event, *type, std::round(1e6 * picker.seconds()) / 1e6});
  }
  clear();
  about_ = log.catalog().about();
  rig_file_ = log.catalog().rig_file();
  damage_ = log.damage().any() ? log.damage_text() : "";
  if (events == 0) throw NotDone(file_.string() + ": no log, or nothing of one is left");
  picker.require_some();
  if (messages() == 0) {
    tell_losses();
    throw NotDone(file_.string() +
                  ": none of what is asked for is of a type that the log or "
                  "this program knows");
  }
}

std::int64_t LogScan::messages() const {
  std::int64_t sum = 0;
  for (const LogStream& stream : streams_) sum += stream.messages;
  return sum;
}

std::size_t LogScan::stream_of(const Catalog& catalog, const LogEvent& event, const LcmType& type) {
  auto channel = by_channel_.find(event.channel);
  if (channel == by_channel_.end()) {
    channel = by_channel_.emplace(std::string(event.channel), std::vector<std::size_t>()).first;
  }
  for (const std::size_t known : channel->second) {
    if (streams_[known].fingerprint == type.fingerprint) return known;
  }
  const std::string base = identifier(event.channel, catalog.about());
  std::string name = base;
  for (int i = 2; !names_.insert(name).second; ++i) name = base + '_' + std::to_string(i);
  channel->second.push_back(streams_.size());
  streams_.push_back({channel->first, name, type.fingerprint});
  return streams_.size() - 1;
}

void LogScan::show(const std::string& doing) {
  if (interrupt_.wanted()) throw NotDone("interrupted");
  if (!terminal_ || doing == shown_) return;
  shown_ = doing;
  std::fprintf(stderr, "\r\x1b[K%s", doing.c_str());
}

void LogScan::clear() {
  if (!shown_.empty()) std::fputs("\r\x1b[K", stderr);
  shown_.clear();
}

void LogScan::tell_losses() {
  clear();
  if (!damage_.empty()) {
    std::fprintf(stderr, "%s is damaged: %s\n", file_.c_str(), damage_.c_str());
  }
  for (const auto& [channel, count] : unknown_) {
    std::fprintf(stderr, "left out: %lld messages on %s, which are of no known type\n",
                 static_cast<long long>(count), channel.c_str());
  }
}

}  // namespace gyrotwin
