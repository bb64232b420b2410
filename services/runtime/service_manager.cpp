#include "services/runtime/service_manager.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>

namespace gyrotwin {

namespace {

constexpr std::chrono::seconds kBetweenTexts{1};

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// 0 where there is no number.
std::int64_t number(std::string_view text) {
  std::int64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Of systemd's watchdog over this process, not over one that has started it; 0: there is none.
std::chrono::microseconds watchdog_time() {
  const std::string_view watched = environment("WATCHDOG_PID");
  if (!watched.empty() && number(watched) != ::getpid()) return {};
  return std::chrono::microseconds(std::max<std::int64_t>(0, number(environment("WATCHDOG_USEC"))));
}

}  // namespace

// The protocol of sd_notify(3), whose own function would wait for a manager that does not read.
ServiceManager::ServiceManager() : feeding_period_(watchdog_time() / 4) {
  const std::string_view path = environment("NOTIFY_SOCKET");
  if (path.empty() || path.size() >= sizeof address_.sun_path) return;
  address_.sun_family = AF_UNIX;
  path.copy(address_.sun_path, path.size());
  if (path.front() == '@') address_.sun_path[0] = 0;  // a name that is no file
  address_size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  socket_ = Descriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

bool ServiceManager::notify(std::string_view message) const {
  return ::sendto(socket_.get(), message.data(), message.size(), MSG_NOSIGNAL,
                  reinterpret_cast<const sockaddr*>(&address_), address_size_) >= 0;
}

void ServiceManager::hear_rounds(std::uint64_t rounds, Time now) {
  if (!listens() || rounds == rounds_) return;
  const bool up = rounds_ != 0;
  if (up && (feeding_period_ == feeding_period_.zero() || now - fed_at_ < feeding_period_)) return;
  if (!notify(up ? "WATCHDOG=1" : "READY=1")) return;
  rounds_ = rounds;
  fed_at_ = now;
}

void ServiceManager::show(std::string_view status, Time now) {
  if (!listens() || status == shown_) return;
  if (!shown_.empty() && now - shown_at_ < kBetweenTexts) return;
  if (!notify("STATUS=" + std::string(status))) return;
  shown_ = status;
  shown_at_ = now;
}

void ServiceManager::stopping() {
  if (listens() && !stopping_) stopping_ = notify("STOPPING=1");
}

}  // namespace gyrotwin
