#include "services/hardware/hardware.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/onboard/drive_torques.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/observation_wire.hpp"
#include "services/runtime/refuse.hpp"

namespace gyrotwin {

namespace {

// Beats of a device that does not run although its owner does, before that is a stop.
constexpr int kPatientBeats = 10;
// Stamps and counts of a device are below this [ns], and sums of some of them within 63 bits.
constexpr std::int64_t kLast = std::int64_t{1} << 60;
// How far the rate of the device's samples may be off [1].
constexpr double kRateTolerance = 0.01;

const Rig& suited(const Rig& rig) {
  if (!rig.sensors) {
    throw Error(rig.file.string() +
                ": hardware needs [sensors]: where the IMU sits and what the encoders resolve");
  }
  if (rig.loop.clock != ClockMode::kRealtime) {
    throw Error(rig.file.string() + ": loop.clock must be realtime: a real plant waits for nobody");
  }
  return rig;
}

}  // namespace

Hardware::Hardware(const Rig& rig, std::int64_t epoch)
    : Owner(suited(rig), epoch), machine_(rig.build_machine()), estimator_(rig, machine_) {
  estimator_.forget();
}

void Hardware::entering(Event event, Mode to) noexcept {
  beats_not_running_ = 0;
  if (event == Event::kEstop) rotors_asked_.reset();
  if (to != Mode::kRunning) {
    command_.reset();
    asked_ = {};
  }
}

bool Hardware::pressed() const noexcept {
  // A button that is no longer heard is not one that was released.
  return has_estop_ && (!(sensors_.valid & sensors_t::VALID_ESTOP) || sensors_.estop != 0);
}

bool Hardware::on_command(const command_t& command) noexcept {
  if (!Owner::on_command(command)) return false;
  command_t limited_command = command;
  std::fill(std::begin(limited_command.value), std::end(limited_command.value), 0.0);
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
    limited_command.value[i] = limited(static_cast<int>(i), command.mode, command.value[i]);
  }
  // On the line a command is for the device's newest sample, and as old as the way to there.
  limited_command.for_tick = device_tick_.value_or(0);
  limited_command.valid_ticks =
      static_cast<std::int32_t>(command.for_tick + command.valid_ticks - tick_);
  from_wire(limited_command, asked_);
  command_ = limited_command;
  return true;
}

/// Within the motor line and the rig's torque limit.
double Hardware::limited(int drive, std::int32_t mode, double value) const noexcept {
  const model::Drive& d = machine_.drives[static_cast<std::size_t>(drive)];
  const double rate = machine_.drive_rate(drive, machine_.recall(estimator_.seen()));
  const auto [low, high] = d.range(rate);
  if (mode == command_t::TORQUE_NM) return std::clamp(value, low, high);
  if (!d.motor) return 0.0;
  const double supply = d.motor->supply_voltage;
  const double voltage = std::clamp(value, -supply, supply);
  const double torque = d.motor->torque(voltage, rate);
  if (torque >= low && torque <= high) return voltage;
  return d.motor->voltage(std::clamp(torque, low, high), rate);
}

std::optional<command_t> Hardware::take_command() noexcept {
  return std::exchange(command_, std::nullopt);
}

void Hardware::new_device(std::int64_t epoch) noexcept {
  if (device_epoch_ >= 0) enter(Event::kDeviceStopped, "the device has restarted; reset and arm");
  device_epoch_ = epoch;
  device_tick_.reset();
  device_mode_.reset();
  rate_.forget();
  has_estop_ = false;
  rotors_asked_.reset();
  estimator_.forget();
}

bool Hardware::plausible(const header_t& header) const noexcept {
  const auto counts = [](std::int64_t x, std::int64_t end) { return x >= 0 && x < end; };
  return header.rig_id == rig_.id && header.epoch >= 0 && header.epoch != epoch() &&
         counts(header.tick, kLast / rig_.loop.tick_ns()) && counts(header.sim_time_ns, kLast);
}

bool Hardware::on_sample(const sensors_t& sample) noexcept {
  if (sample.header.epoch != device_epoch_) new_device(sample.header.epoch);
  const std::int64_t ticks_gone = device_tick_ ? sample.header.tick - *device_tick_ : 1;
  if (ticks_gone <= 0) return false;
  device_tick_ = sample.header.tick;
  missed_ += ticks_gone - 1;
  rate_.on_sample(sample.header.tick, sample.header.sim_time_ns);
  sensors_ = sample;
  has_estop_ = has_estop_ || (sample.valid & sensors_t::VALID_ESTOP);
  estimate(ticks_gone);
  if (ticks(mode())) tick_ = std::min(tick_ + ticks_gone, kLast / rig_.loop.tick_ns());
  judge();
  return true;
}

/// A sample that never came is a tick without sensors; of many in a row, so many as make the
/// estimator forget.
void Hardware::estimate(std::int64_t ticks_gone) noexcept {
  const auto enough =
      static_cast<std::int64_t>(std::ceil(OnboardEstimator::kCoast / rig_.loop.tick_s())) + 2;
  for (std::int64_t i = std::min(ticks_gone - 1, enough); i > 0; --i) estimator_.step({});
  estimator_.step(sensors_);
}

/// What a new tick may end.
void Hardware::judge() noexcept {
  if (pressed()) enter(Event::kEstop, "the E-stop is pressed; release it, then reset and arm");
  if (mode() == Mode::kRunning && timed_out()) {
    enter(Event::kCommandLost,
          "no valid command in time; start the controller, then reset and arm");
  }
  const model::State state = machine_.recall(estimator_.seen());
  if (!state.finite()) {
    enter(Event::kNotFinite, "the estimate is not finite: a sensor tells nonsense");
  } else if ((estimator_.valid() & state_t::VALID_TILT) &&
             machine_.tilt(state) > rig_.safety.fall_tilt_rad) {
    fall();
  }
}

void Hardware::on_beat(const beat_t& beat) noexcept {
  if (beat.header.epoch != device_epoch_) new_device(beat.header.epoch);
  device_mode_ = beat.mode;
  obeyed_ = beat.commands_obeyed;
  device_stops_ = beat.safe_stops;
  if (mode() != Mode::kRunning) return;
  if (beat.mode == status_t::MODE_SAFE_STOP) {
    enter(Event::kDeviceStopped, "the device has stopped by itself; reset and arm");
  } else if (beat.mode == status_t::MODE_RUNNING) {
    beats_not_running_ = 0;
  } else if (++beats_not_running_ > kPatientBeats) {
    enter(Event::kDeviceStopped, "the device does not run; reset and arm");
  }
}

void Hardware::fill(beat_t& beat) const noexcept {
  beat.mode = static_cast<std::int32_t>(mode());
  beat.rotors = beat_t::ROTORS_AS_THEY_ARE;
  if (rotors_asked_ == true) beat.rotors = beat_t::ROTORS_ON;
  if (rotors_asked_ == false) beat.rotors = beat_t::ROTORS_OFF;
  beat.command_timeout_ticks = rig_.safety.command_timeout_ticks;
  switch (rig_.safety.drive) {
    case SafeStopDrive::kZeroTorque:
      beat.safe_stop = beat_t::ZERO_TORQUE;
      break;
    case SafeStopDrive::kBrake:
      beat.safe_stop = beat_t::BRAKE;
      break;
    case SafeStopDrive::kHoldSpeed:
      beat.safe_stop = beat_t::HOLD_SPEED;
      break;
  }
  beat.safe_stop_gain = rig_.safety.gain;
}

void Hardware::fill(state_t& state) const noexcept {
  state.mode = static_cast<std::int32_t>(mode());
  to_wire(estimator_.seen(), estimator_.valid() | state_t::VALID_DRIVES, state);
  const auto torque = drive_torques(machine_, estimator_.seen(), sensors_, asked_);
  std::copy(torque.begin(), torque.end(), std::begin(state.drive_torque_nm));
}

void Hardware::fill(sensors_t& sensors) const noexcept {
  const header_t header = sensors.header;
  sensors = sensors_;
  sensors.header = header;
}

void Hardware::fill(status_t& status) const noexcept {
  fill_owner(status);
  status.service = status_t::HARDWARE;
  status.clock = status_t::PACE_REALTIME;
  status.speed_factor = 1.0;
  if (status.text[0] != 0) return;
  if (mode() == Mode::kHeld) {
    hindered(status.text);
  } else {
    troubled(status.text);
  }
}

bool Hardware::troubled(Text& why) const noexcept {
  if (!connected_) {
    set_text(why, "the device is not heard: check cable and power");
    return true;
  }
  if (pressed()) {
    set_text(why, "the E-stop is pressed; release it first");
    return true;
  }
  if (!rate_.known()) return false;
  const double hz = rate_.hz() * (1.0 + clock_drift_);
  if (std::abs(hz / rig_.loop.rate_hz - 1.0) <= kRateTolerance) return false;
  set_text(why,
           "the device samples at {:.1f} Hz, loop.rate_hz is {:g}: set its firmware or the rig", hz,
           rig_.loop.rate_hz);
  return true;
}

bool Hardware::hindered(Text& why) const noexcept {
  if (troubled(why)) return true;
  if (!device_mode_) {
    set_text(why, "the device has not told its mode yet; arm again");
  } else if (*device_mode_ != status_t::MODE_HELD) {
    set_text(why, "the device is still in {}; wait a moment, then arm again",
             mode_name(*device_mode_));
  } else if (!rate_.known()) {
    set_text(why, "the device's rate is not known yet: that takes 0.5 s of stamped samples");
  } else if (machine_.layout.tilts() > 0 && !(estimator_.valid() & state_t::VALID_TILT)) {
    set_text(why, "the tilt is not known: gyro and accelerometer are silent");
  } else if (machine_.tilt(machine_.recall(estimator_.seen())) > rig_.safety.fall_tilt_rad) {
    set_text(why, "the tilt is beyond safety.fall_tilt_rad; prop the platform upright");
  } else {
    return false;
  }
  return true;
}

void Hardware::fill(link_t& link) const noexcept {
  link.connected = connected_ ? 1 : 0;
  link.device_mode = device_mode_.value_or(-1);
  link.device_epoch = device_epoch_;
  link.samples_missed = missed_;
  link.commands_obeyed = obeyed_;
  link.safe_stops = device_stops_;
}

}  // namespace gyrotwin
