#include "clients/log/log.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "services/runtime/descriptor.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

std::pair<ReadAt, std::int64_t> open_log(const std::filesystem::path& path) {
  const auto file =
      std::make_shared<Descriptor>(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file->valid() || ::fstat(file->get(), &status) != 0) {
    throw Error(path.string() + ": cannot be read: " + std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) throw Error(path.string() + ": is no regular file");
  // Stretches that the disk does not give are left out, in steps of its blocks.
  const auto read = [file](std::int64_t offset, std::span<std::uint8_t> to) {
    constexpr std::size_t kBlock = 4096;
    std::size_t got = 0;
    while (got < to.size()) {
      const ssize_t count = ::pread(file->get(), to.data() + got, to.size() - got,
                                    offset + static_cast<std::int64_t>(got));
      if (count < 0 && errno == EINTR) continue;
      if (count == 0) break;
      const std::size_t unread = std::min(kBlock, to.size() - got);
      if (count < 0) std::memset(to.data() + got, 0, unread);
      got += count < 0 ? unread : static_cast<std::size_t>(count);
    }
    return got;
  };
  return {read, status.st_size};
}

/// The rig's key on this host, if there is one.
std::optional<Key> key_at_hand(const About& about) {
  try {
    return load_key(key_path(about.rig));
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

Log::Log(const std::filesystem::path& path) : Log(open_log(path), key_at_hand) {}

Log::Log(std::pair<ReadAt, std::int64_t> source, Catalog::FindKey find_key)
    : catalog_(std::move(find_key)),
      reader_(std::move(source.first), source.second,
              [this](const LogEvent& event) { return catalog_.examine(event); }) {}

std::optional<LogEvent> Log::next() {
  const auto event = reader_.next();
  if (event && is_log_channel(event->channel) && !catalog_.take(*event)) ++senseless_;
  return event;
}

std::string Log::damage_text() const {
  const Damage& damage = reader_.damage();
  std::string text;
  const auto add = [&text](std::string_view part) {
    text.append(text.empty() ? "" : "; ").append(part);
  };
  if (damage.bytes_lost + damage.events_lost > 0) {
    add(fmt::format("{} events lost, {} bytes are no event", damage.events_lost,
                    damage.bytes_lost));
  }
  if (damage.wrong_shape > 0) {
    add(fmt::format("{} events were not of their channel's type and size", damage.wrong_shape));
  }
  if (damage.wrong_signature > 0) {
    add(fmt::format("{} events did not have the rig's signature", damage.wrong_signature));
  }
  if (damage.times_repaired > 0) {
    add(fmt::format("{} times out of order, read as that of the event before",
                    damage.times_repaired));
  }
  if (senseless_ > 0) add(fmt::format("{} of its opening events make no sense", senseless_));
  return text.empty() ? "none" : text;
}

}  // namespace gyrotwin
