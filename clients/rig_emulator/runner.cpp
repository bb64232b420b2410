#include "clients/rig_emulator/runner.hpp"

#include <poll.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "services/runtime/error.hpp"
#include "services/runtime/mode.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t random_epoch() {
  std::uint64_t bits = 0;
  if (::getrandom(&bits, sizeof bits, 0) != sizeof bits) throw Error("no random numbers");
  return static_cast<std::int64_t>(bits >> 1);
}

const char* name_of(gyrotwin_stop stop) {
  switch (stop) {
    case GYROTWIN_STOP_NONE:
      return "";
    case GYROTWIN_STOP_HOST:
      return ": the host says so";
    case GYROTWIN_STOP_COMMANDS:
      return ": no valid command in time";
    case GYROTWIN_STOP_SILENCE:
      return ": no beat of the host in time";
    case GYROTWIN_STOP_ESTOP:
      return ": the E-stop is pressed";
    case GYROTWIN_STOP_NOT_HELD:
      return ": started while the host runs";
    case GYROTWIN_STOP_OTHER_RUN:
      return ": another run of the owner speaks";
  }
  return "";
}

}  // namespace

Runner::Runner(const Rig& rig, const EmulatorOptions& options, Terminal& terminal, Daemon& daemon)
    : terminal_(terminal),
      daemon_(daemon),
      clock_(host_, std::llround(1e9 * options.clock_offset_s), options.clock_drift_ppm),
      emulator_(rig, random_epoch(), clock_.now_ns()),
      pacer_(rig.loop.tick_ns(), OverrunPolicy::kSkip),
      asking_(options.from_stdin) {
  for (const std::string& trouble : options.troubles) emulator_.cause(parse_trouble(trouble, 0.0));
  if (options.truth.empty()) return;
  const std::int64_t every = std::llround(options.truth_period_s / rig.loop.tick_s());
  truth_.emplace(options.truth, emulator_.plant().machine(), std::max<std::int64_t>(1, every));
}

void Runner::run() {
  pacer_.anchor(clock_.now_ns());
  while (daemon_.next_round() && !terminal_.lost()) {
    rest();
    if (emulator_.reads()) receive();
    const std::int64_t now = clock_.now_ns();
    if (now >= pacer_.deadline()) tick(now);
    drain();
  }
  conclude();
}

/// Until a byte comes, or the next tick.
void Runner::rest() {
  const std::int64_t left = clock_.to_host(pacer_.deadline()) - host_.now_ns();
  if (left <= 0) return;
  const timespec timeout{.tv_sec = left / kSecond, .tv_nsec = left % kSecond};
  const auto await = [](bool whether, int descriptor) {
    return pollfd{.fd = whether ? descriptor : -1, .events = POLLIN, .revents = 0};
  };
  std::array<pollfd, 2> wait{await(emulator_.reads(), terminal_.descriptor()),
                             await(asking_, STDIN_FILENO)};
  ::ppoll(wait.data(), wait.size(), &timeout, nullptr);
  if (wait[1].revents != 0) ask();
}

void Runner::receive() {
  std::array<std::uint8_t, 4096> room;
  const auto bytes = terminal_.read(room);
  if (!bytes.empty()) emulator_.receive(bytes, clock_.now_ns());
}

void Runner::tick(std::int64_t now) {
  pacer_.begin(now);
  emulator_.tick(now);
  if (truth_) truth_->write(emulator_);
  follow();
  if (now < share_due_) return;
  share_due_ = now + kSecond;
  terminal_.share();
}

void Runner::drain() {
  while (!emulator_.outgoing().empty()) {
    const std::size_t count = terminal_.write(emulator_.outgoing());
    if (count == 0) return;
    emulator_.sent(count);
  }
}

/// Troubles from standard input, line by line.
void Runner::ask() {
  std::array<char, 512> text;
  const ssize_t count = ::read(STDIN_FILENO, text.data(), text.size());
  asking_ = count > 0;
  if (count > 0) asked_.append(text.data(), static_cast<std::size_t>(count));
  for (auto end = asked_.find('\n'); end != std::string::npos; end = asked_.find('\n')) {
    const std::string line = asked_.substr(0, end);
    asked_.erase(0, end + 1);
    if (line.empty()) continue;
    try {
      emulator_.cause(parse_trouble(line, emulator_.time_s()));
      daemon_.log(LogLevel::kInfo, "{:.3f} s: {}", emulator_.time_s(), line);
    } catch (const Error& error) {
      daemon_.log(LogLevel::kWarning, "{}", error.what());
    }
  }
}

/// Says what changes.
void Runner::follow() {
  const gyrotwin_device& device = emulator_.device();
  if (emulator_.restarts() != followed_restarts_) {
    followed_restarts_ = emulator_.restarts();
    daemon_.log(LogLevel::kInfo, "{:.3f} s: the firmware starts anew", emulator_.time_s());
  }
  if (device.mode == followed_mode_) return;
  followed_mode_ = device.mode;
  daemon_.log(LogLevel::kInfo, "{:.3f} s: {}{}", emulator_.time_s(), mode_name(device.mode),
              name_of(device.stop));
}

void Runner::conclude() {
  const gyrotwin_device& device = emulator_.device();
  if (terminal_.lost()) daemon_.log(LogLevel::kError, "{} is gone", terminal_.path());
  if (!emulator_.plant().sound()) {
    daemon_.log(LogLevel::kError, "the solver has failed; the plant has stood still since");
  }
  daemon_.log(LogLevel::kInfo,
              "{} ticks, {} of them more than a period late; frames received {}, bad {}, dropped "
              "{}; commands obeyed {}, refused {}; safe stops by itself {}",
              emulator_.plant().tick(), pacer_.overruns(), device.decoder.good, device.decoder.bad,
              device.outbox.dropped, device.commands_obeyed, device.commands_refused,
              device.safe_stops);
}

}  // namespace gyrotwin
