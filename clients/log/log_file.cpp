#include "clients/log/log_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "messages/big_endian.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kNumberAt = 4, kTimeAt = 12, kChannelSizeAt = 20, kDataSizeAt = 24;

std::string reason() { return std::strerror(errno); }

Descriptor create(const std::filesystem::path& path) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.valid()) return file;
  if (errno == EEXIST) {
    throw Error(path.string() + ": exists already and is kept; name another file, or remove it");
  }
  throw Error(path.string() + ": cannot be made: " + reason());
}

}  // namespace

void append_event(LogBytes& to, const LogEvent& event) {
  const std::size_t at = to.size();
  to.resize(at + size_in_log(event));
  std::uint8_t* out = to.data() + at;
  put_big_endian(kLogSync, out);
  put_big_endian(static_cast<std::uint64_t>(event.number), out + kNumberAt);
  put_big_endian(static_cast<std::uint64_t>(event.time_us), out + kTimeAt);
  put_big_endian(static_cast<std::uint32_t>(event.channel.size()), out + kChannelSizeAt);
  put_big_endian(static_cast<std::uint32_t>(event.data.size()), out + kDataSizeAt);
  out += kLogHeader;
  std::memcpy(out, event.channel.data(), event.channel.size());
  if (!event.data.empty()) {
    std::memcpy(out + event.channel.size(), event.data.data(), event.data.size());
  }
}

LogEvent first_event(std::span<const std::uint8_t> events) {
  const auto channel_size = big_endian<std::uint32_t>(events, kChannelSizeAt);
  const auto data_size = big_endian<std::uint32_t>(events, kDataSizeAt);
  return {.number = static_cast<std::int64_t>(big_endian<std::uint64_t>(events, kNumberAt)),
          .time_us = static_cast<std::int64_t>(big_endian<std::uint64_t>(events, kTimeAt)),
          .channel = {reinterpret_cast<const char*>(events.data()) + kLogHeader, channel_size},
          .data = events.subspan(kLogHeader + channel_size, data_size)};
}

LogWriter::LogWriter(std::filesystem::path path) : path_(std::move(path)), file_(create(path_)) {}

void LogWriter::append(std::span<std::uint8_t> events) {
  std::int64_t count = 0;
  for (std::size_t at = 0; at < events.size(); ++count) {
    const std::size_t size = size_in_log(first_event(events.subspan(at)));
    put_big_endian(static_cast<std::uint64_t>(events_ + count), events.data() + at + kNumberAt);
    at += size;
  }
  for (std::size_t written = 0; written < events.size();) {
    const ssize_t taken = ::write(file_.get(), events.data() + written, events.size() - written);
    if (taken < 0 && errno == EINTR) continue;
    if (taken <= 0) give_up(events, written);
    written += static_cast<std::size_t>(taken);
  }
  events_ += count;
  size_ += static_cast<std::int64_t>(events.size());
}

/// Ends the file with the last whole event that is in it.
void LogWriter::give_up(std::span<const std::uint8_t> events, std::size_t written) {
  const std::string why = reason();
  std::size_t whole = 0;
  while (whole < written) {
    const std::size_t end = whole + size_in_log(first_event(events.subspan(whole)));
    if (end > written) break;
    whole = end;
    ++events_;
  }
  size_ += static_cast<std::int64_t>(whole);
  const bool cut = ::ftruncate(file_.get(), size_) == 0 && ::fsync(file_.get()) == 0;
  throw NotDone(path_.string() + ": no more can be written: " + why + "; its first " +
                std::to_string(events_) + " events are kept" +
                (cut ? "" : " (`gyrotwin log recover` reads them)"));
}

}  // namespace gyrotwin
