#include "services/hardware/service.hpp"

#include <poll.h>

#include <algorithm>
#include <cstring>

#include "services/runtime/key.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStatusPeriod = kSecond / 10;
constexpr std::int64_t kBeatPeriod = kSecond / 100;
constexpr std::int64_t kReopen = kSecond / 2;
constexpr std::int64_t kHeardLately = kSecond;
constexpr std::int64_t kBeatPatience = kSecond / 10;

}  // namespace

HardwareService::HardwareService(const Rig& rig, Line& line, Bus& bus, Clock& clock, Daemon& daemon)
    : rig_(rig),
      line_(line),
      bus_(bus),
      clock_(clock),
      daemon_(daemon),
      hardware_(rig, random_id()),
      desk_(bus, daemon, hardware_, Channel::kHardwareStatus),
      followed_epoch_(hardware_.epoch()) {}

void HardwareService::run() noexcept {
  while (daemon_.next_round()) {
    const std::int64_t now = clock_.now_ns();
    listen(now);
    hear_device(now);
    keep_line(now);
    keep_time(now);
    follow_mode(now);
    send_to_device(now);
    report(now);
    rest(clock_.now_ns());
  }
  hardware_.notice(Event::kDisarm, "the hardware daemon has been stopped");
  send_beat(clock_.now_ns());  // the device's drives stop now, not after its own timeout
}

void HardwareService::listen(std::int64_t now) noexcept {
  while (const auto reception = bus_.receive()) {
    desk_.hear(*reception, now);
    follow_mode(now);
    desk_.answer();
  }
}

void HardwareService::hear_device(std::int64_t now) noexcept {
  for (auto payload = line_.receive(); !payload.empty(); payload = line_.receive()) {
    const auto heard = [&](auto& message) {
      return Line::decode(payload, message) && hardware_.plausible(message.header);
    };
    if (sensors_t sample; heard(sample)) {
      on_sample(sample, now);
    } else if (beat_t beat; heard(beat)) {
      if (beat.header.epoch != last_beat_.header.epoch) line_clock_.forget();
      last_beat_ = beat;
      last_beat_at_ = now;
      line_clock_.on_beat(beat, now);
      hardware_.on_beat(beat);
    } else if (reply_t answer, reply; heard(answer)) {
      if (hardware_.on_reply(answer, reply)) desk_.answer(reply);
    } else {
      line_.reject();
    }
  }
}

void HardwareService::on_sample(const sensors_t& sample, std::int64_t now) noexcept {
  if (!hardware_.on_sample(sample)) return;
  sample_at_ = now;
  if (line_clock_.known()) ages_.add(now - line_clock_.to_host(sample.header.sim_time_ns));
  follow_mode(now);
  publish();
  compute_.add(clock_.now_ns() - now);
}

/// Opens the line again where it was lost.
void HardwareService::keep_line(std::int64_t now) noexcept {
  const bool connected = line_.is_open() && sample_at_ >= 0 && now - sample_at_ < kHeardLately;
  hardware_.set_connected(connected);
  if (connected != was_connected_) {
    daemon_.log(connected ? LogLevel::kInfo : LogLevel::kWarning, "the device is {} on {}",
                connected ? "heard" : "silent", line_.path());
    was_connected_ = connected;
  }
  if (line_.is_open()) {
    line_.flush();
    return;
  }
  if (now < open_due_) return;
  open_due_ = now + kReopen;
  if (line_.open()) {
    said_closed_ = false;
    last_beat_ = {};
    line_clock_.forget();
    daemon_.log(LogLevel::kInfo, "{} is open", line_.path());
  } else if (!said_closed_) {
    said_closed_ = true;
    daemon_.log(LogLevel::kWarning, "{}: {}; trying again", line_.path(),
                std::strerror(line_.error()));
  }
}

/// What wall time alone may end: no device ticks while the line is silent.
void HardwareService::keep_time(std::int64_t now) noexcept {
  const std::int64_t patience = rig_.safety.command_timeout_ticks * rig_.loop.tick_ns();
  if (sample_at_ >= 0 && now - sample_at_ >= patience) {
    hardware_.notice(Event::kDeviceLost, "no sensors in time: check cable, power and firmware");
  }
  if (last_beat_at_ > 0 && now - last_beat_at_ >= kBeatPatience) {
    hardware_.notice(Event::kDeviceLost, "no beats in time: check the device's firmware");
  }
  reply_t reply;
  if (hardware_.overdue(now, reply)) desk_.answer(reply);
}

void HardwareService::send_beat(std::int64_t now) noexcept {
  beat_due_ = now + kBeatPeriod;
  beat_t beat{};
  hardware_.fill(beat);
  beat.header = {.rig_id = rig_.id,
                 .source = header_t::HARDWARE,
                 .epoch = hardware_.epoch(),
                 .sequence = ++beats_,
                 .tick = hardware_.tick(),
                 .sim_time_ns = hardware_.sim_time_ns(),
                 .sender_mono_ns = now};
  beat.sent_ns = clock_.now_ns();
  beat.echo_ns = last_beat_.sent_ns;
  beat.heard_ns = last_beat_at_;
  const LineCounters counters = line_.counters();
  beat.frames_received = counters.received;
  beat.frames_bad = counters.bad;
  beat.frames_dropped = counters.dropped;
  line_.send(beat);
}

void HardwareService::send_to_device(std::int64_t now) noexcept {
  if (auto command = hardware_.take_command()) line_.send(*command);
  while (auto request = hardware_.take_request()) line_.send(*request);
  if (now >= beat_due_) send_beat(now);
}

void HardwareService::publish() noexcept {
  const Stamp stamp{hardware_.epoch(), hardware_.sequence(), hardware_.tick(),
                    hardware_.sim_time_ns()};
  hardware_.fill(state_);
  hardware_.fill(sensors_);
  bus_.send(Channel::kState, state_, stamp);
  bus_.send(Channel::kSensors, sensors_, stamp);
}

/// A new mode or run is said at once, to the device first.
void HardwareService::follow_mode(std::int64_t now) noexcept {
  const Mode mode = hardware_.mode();
  if (mode == followed_mode_ && hardware_.epoch() == followed_epoch_) return;
  followed_mode_ = mode;
  followed_epoch_ = hardware_.epoch();
  if (mode != Mode::kRunning) line_.drop_commands();  // what waits must not act after the beat
  send_beat(now);
  publish_status(now);
  daemon_.log(mode == Mode::kFault ? LogLevel::kError : LogLevel::kInfo, "{} at tick {}{}{}",
              name_of(mode), hardware_.tick(), hardware_.why().empty() ? "" : ": ",
              hardware_.why());
}

void HardwareService::publish_status(std::int64_t now) noexcept {
  status_t status{};
  hardware_.fill(status);
  status.lateness_p50_ns = ages_.p50();
  status.lateness_p99_ns = ages_.p99();
  status.lateness_max_ns = ages_.max();
  status.compute_p50_ns = compute_.p50();
  status.compute_p99_ns = compute_.p99();
  status.compute_max_ns = compute_.max();
  desk_.send_status(status, now);
}

void HardwareService::publish_link(std::int64_t now) noexcept {
  line_clock_.fit(now);
  hardware_.set_clock_drift(1e-6 * line_clock_.drift_ppm());
  link_t link{};
  hardware_.fill(link);
  link.round_trip_p50_ns = line_clock_.round_trips().p50();
  link.round_trip_max_ns = line_clock_.round_trips().max();
  if (line_clock_.known()) {
    link.clock_offset_ns = line_clock_.offset_ns();
    link.clock_offset_sigma_ns = line_clock_.sigma_ns();
    link.clock_drift_ppm = line_clock_.drift_ppm();
  }
  const LineCounters counters = line_.counters();
  link.reconnects = std::max<std::int64_t>(0, counters.opened - 1);
  link.host_received = counters.received;
  link.host_bad = counters.bad;
  link.host_dropped = counters.dropped;
  link.device_received = last_beat_.frames_received;
  link.device_bad = last_beat_.frames_bad;
  link.device_dropped = last_beat_.frames_dropped;
  if (line_.is_open()) {
    set_text(link.text, "{}", line_.path());
  } else {
    set_text(link.text, "{}: {}", line_.path(), std::strerror(line_.error()));
  }
  bus_.send(Channel::kLink, link,
            {hardware_.epoch(), ++link_sequence_, hardware_.tick(), hardware_.sim_time_ns()});
}

/// STATUS and LINK at their rate, statistics at theirs.
void HardwareService::report(std::int64_t now) noexcept {
  if (now >= window_due_) {
    ages_.roll();
    compute_.roll();
    line_clock_.round_trips().roll();
    window_due_ = now + kSecond;
  }
  if (now < status_due_) return;
  status_due_ = now + kStatusPeriod;
  publish_status(now);
  publish_link(now);
}

/// Sleeps until bus or line has something, the line takes more, or something is due.
void HardwareService::rest(std::int64_t now) noexcept {
  const std::int64_t due = std::min({beat_due_, status_due_, now + 10 * kMillisecond});
  const timespec timeout{.tv_sec = 0, .tv_nsec = std::clamp<long>(due - now, 0, 10 * kMillisecond)};
  const auto events = static_cast<short>(line_.pending() ? POLLIN | POLLOUT : POLLIN);
  std::array<pollfd, 2> waited{{{.fd = bus_.descriptor(), .events = POLLIN, .revents = 0},
                                {.fd = line_.descriptor(), .events = events, .revents = 0}}};
  ::ppoll(waited.data(), line_.is_open() ? 2 : 1, &timeout, nullptr);
}

}  // namespace gyrotwin
