#include "services/mirror/health.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "services/mirror/readings.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::array<const char*, kHealthSensors> kNames{
    "gyro",         "accelerometer",  "disc encoder", "gimbal encoders",
    "rotor speeds", "motor currents", "bus voltage",  "load cell"};
constexpr std::array<const char*, kHealthSensors> kUnits{"rad/s", "m/s^2", "rad", "rad",
                                                         "rad/s", "A",     "V",   "N"};

// A departure is one from so many of its sigmas on, and over below so many.
constexpr double kSure = 5.0, kOver = 2.0;
constexpr double kForgiving = 0.3;  // a verdict is taken back after this time [s]
// Sensors must disagree for so long to be named [s]: meanwhile the filter finds out what they are
// off by, or that something else is.
constexpr double kNaming = 0.1;
// Where several disagree it may be the gyro that misleads the filter, which believes it most: it is
// left out for so long [s].
constexpr double kTrial = 0.3;
constexpr double kPartSettles = 0.05;  // and parts of the model for so long [s]
constexpr double kDoubt = 60.0;        // or unsure for this time [s]

// From where on departures matter: moment as a share of U times 1 rad, friction of the model's at
// this speed and of the drive's limit, inertia and drives of the model's.
constexpr double kMoment = 0.03, kFriction = 0.3, kLeastFriction = 2e-3, kInertia = 0.05,
                 kDrive = 0.1;

// A bias is none that the rig file allows from so many of its sigmas on.
constexpr double kBiased = 5.0;

// Supply voltages differ by this share where nothing is wrong.
constexpr double kVoltage = 0.1;

// Sensors that one part of the model can make disagree.
constexpr int kFew = 2;

bool disagrees(const SensorJudge& judge) { return judge.verdict() == health_t::DISAGREES; }
bool is_late(const SensorJudge& judge) { return judge.verdict() == health_t::LATE; }

const Imperfection& imperfection_of(const Rig::Sensors& sensors, int sensor) {
  const std::array<const Imperfection*, kHealthSensors> all{
      &sensors.gyro,  &sensors.acceleration, &sensors.disc,    &sensors.gimbal,
      &sensors.rotor, &sensors.current,      &sensors.voltage, &sensors.load_cell};
  return *all[sensor];
}

double toppling_of(const Rig& rig) {
  return std::visit(
      [](const auto& p) {
        if constexpr (requires { model::reduce(p).U; }) return model::reduce(p).U;
        return 1.0;
      },
      rig.machine);
}

const Rig& with_sensors(const Rig& rig) {
  if (rig.sensors) return rig;
  throw Error("the health of a rig without sensors cannot be judged: add a table [sensors]");
}

}  // namespace

void Health::Part::take(double value, double sigma, double matters, int patience, int doubt,
                        int settling) noexcept {
  const double size = std::abs(value);
  sure = size > std::max(matters, kSure * sigma) ? std::min(sure + 1, settling) : 0;
  if (sure >= settling) off = true;
  if (sure > 0) {
    good = unsure = 0;
    return;
  }
  good = size + kOver * sigma < matters ? std::min(good + 1, patience) : 0;
  unsure = size - kOver * sigma < 0.5 * matters ? std::min(unsure + 1, doubt) : 0;
  if (good >= patience || unsure >= doubt) off = false;
}

Health::Health(const Rig& rig, const model::Machine& machine)
    : machine_(machine),
      patience_(static_cast<int>(kForgiving / rig.loop.tick_s())),
      doubt_(static_cast<int>(kDoubt / rig.loop.tick_s())),
      settling_(static_cast<int>(kPartSettles / rig.loop.tick_s())),
      naming_(static_cast<int>(kNaming / rig.loop.tick_s())),
      trial_length_(static_cast<int>(kTrial / rig.loop.tick_s())),
      toppling_(toppling_of(rig)),
      rotors_(with_sensors(rig), machine) {
  for (int s = 0; s < kHealthSensors; ++s) {
    sensor_[s] = SensorJudge(imperfection_of(*rig.sensors, s), channels_of({}, s, machine).count,
                             rig.loop.tick_s());
  }
  for (const model::Drive& drive : machine.drives) {
    if (drive.motor) supply_ = drive.motor->supply_voltage;
  }
  reset();
}

void Health::reset() noexcept {
  for (SensorJudge& judge : sensor_) judge.reset();
  biased_.fill(false);
  rotors_.reset();
  blamed_rotor_ = -1;
  losses_ = kUnknown;
  disagreeing_ = trial_ = 0;
  moment_ = {};
  friction_ = inertia_ = {};
  drive_ = {};
  health_ = {};
}

void Health::take(const Follower& follower, const sensors_t& sensors,
                  const model::Input& acting) noexcept {
  if (losses_ == kUnknown) losses_ = follower.losses();
  const Estimate& estimate = follower.estimate();
  const Innovation& rotors = follower.innovations()[kRotors];
  rotors_.take(estimate.state.rotor_speed,
               rotors.channels == machine_.rotors && !rotors.refused && follower.settled(), acting);
  if (follower.settled()) {
    judge_sensors(follower, sensors);
    judge_parts(follower);
    blame(follower);
  } else if (follower.losses() > losses_) {
    health_.verdict = health_t::DISAGREES;
    if (health_.blame == health_t::NOBODY || health_.blame == health_t::EXTERNAL_MOMENT) {
      health_.blame = health_t::MODEL;
      set_text(health_.text, "lost the rig: nothing explains its readings; starts anew");
    }
  }
  if (follower.settled()) losses_ = follower.losses();

  for (int i = 0; i < 2; ++i) {
    health_.external_moment_nm[i] = estimate.external_moment[i];
    health_.external_moment_sigma_nm[i] = estimate.external_moment_sigma[i];
  }
  health_.disc_friction_nm = estimate.disc_friction;
  health_.disc_friction_sigma_nm = estimate.disc_friction_sigma;
  for (int i = 0; i < 3; ++i) {
    health_.gyro_bias_rad_s[i] = estimate.gyro_bias[i];
    health_.accelerometer_bias_m_s2[i] = estimate.accelerometer_bias[i];
  }
}

void Health::judge_sensors(const Follower& follower, const sensors_t& sensors) noexcept {
  double sum = 0.0;
  int channels = 0;
  for (int s = 0; s < kHealthSensors; ++s) {
    const auto [value, count] = channels_of(sensors, s, machine_);
    Innovation innovation = follower.innovations()[s];
    if (s == kBusVoltage && count > 0) {
      // No part of the filter: it is the supply's, or it is not.
      const bool insane = !sane(*value);
      innovation.insane = insane;
      innovation.channels = insane ? 0 : 1;
      innovation.expected[0] = supply_;
      innovation.value[0] = *value - supply_;
      innovation.nis = std::abs(innovation.value[0]) > kVoltage * supply_ ? 25.0 : 1.0;
    }
    bool over = true;
    for (int i = 0; i < count; ++i) {
      const Bias bias = follower.bias(s, i);
      const double allowed = kBiased * std::max(bias.prior, sensor_[s].noise());
      if (std::abs(bias.value) - kSure * bias.sigma > allowed) {
        biased_[s] = true;
      }
      over &= std::abs(bias.value) - kOver * bias.sigma <= allowed;
    }
    biased_[s] &= !over;
    sensor_[s].take(sensors.valid & valid_bit(s), value, innovation, biased_[s]);

    health_.sensor_verdict[s] = sensor_[s].verdict();
    if (count == 0) continue;
    health_.innovation[s] = sensor_[s].rms();
    health_.nis[s] = sensor_[s].nis();
    health_.nis_limit[s] = sensor_[s].limit();
    sum += sensor_[s].nis() * count;
    channels += count;
  }
  health_.nis_total = channels > 0 ? sum / channels : 0.0;
}

void Health::judge_parts(const Follower& follower) noexcept {
  const Estimate& e = follower.estimate();
  for (int i = 0; i < 2; ++i) {
    moment_[i].take(e.external_moment[i], e.external_moment_sigma[i], kMoment * toppling_,
                    patience_, patience_);
  }
  if (machine_.disc_body != model::kFixed) {
    const model::DiscFriction& friction = machine_.disc_friction;
    const double here =
        friction.coulomb + friction.viscous * std::abs(e.state.v[machine_.layout.disc]);
    const double least = kLeastFriction * machine_.drives[0].torque_limit;
    friction_.take(e.disc_friction, e.disc_friction_sigma, std::max(least, kFriction * here),
                   patience_, doubt_, settling_);
  }
  inertia_.take(e.inertia, e.inertia_sigma, kInertia, patience_, doubt_, settling_);
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
    drive_[i].take(e.drive_strength[i] - 1.0, e.drive_strength_sigma[i], kDrive, patience_, doubt_,
                   settling_);
  }
  blamed_rotor_ = rotors_.blamed();
}

void Health::say_sensor(int sensor, const Follower& follower) noexcept {
  const char* name = kNames[sensor];
  switch (sensor_[sensor].verdict()) {
    case health_t::SILENT:
      return set_text(health_.text, "{}: silent", name);
    case health_t::INSANE:
      return set_text(health_.text, "{}: says what is no number", name);
    case health_t::STUCK:
      return set_text(health_.text, "{}: stuck", name);
    case health_t::LATE:
      return set_text(health_.text, "{}: late by {} ticks", name, sensor_[sensor].late_by());
    default:
      break;
  }
  if (!biased_[sensor]) {
    return set_text(health_.text, "{}: does not say what the model and the other sensors expect",
                    name);
  }
  Bias worst;
  for (int i = 0; i < sensor_[sensor].channels(); ++i) {
    const Bias bias = follower.bias(sensor, i);
    if (std::abs(bias.value) > std::abs(worst.value)) worst = bias;
  }
  set_text(health_.text, "{}: off by {:.3g} {}, {:.0f} times what it may be", name, worst.value,
           kUnits[sensor], std::abs(worst.value) / std::max(worst.prior, sensor_[sensor].noise()));
}

/// What is seen at once: silent, insane, stuck, late.
bool Health::blame_evident_sensor(const Follower& follower) noexcept {
  for (int s = 0; s < kHealthSensors; ++s) {
    if (sensor_[s].verdict() <= health_t::DISAGREES) continue;
    health_.blame = health_t::SENSOR + s;
    say_sensor(s, follower);
    return true;
  }
  return false;
}

bool Health::blame_part(const Follower& follower) noexcept {
  const Estimate& e = follower.estimate();
  if (blamed_rotor_ >= 0) {
    health_.blame = health_t::ROTOR;
    health_.blamed_index = blamed_rotor_;
    set_text(health_.text, "rotor {} runs at {:.0f} rad/s, its drive would give it {:.0f}",
             blamed_rotor_, e.state.rotor_speed[blamed_rotor_], rotors_.expected(blamed_rotor_));
    return true;
  }
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
    if (!drive_[i].off) continue;
    health_.blame = health_t::DRIVE;
    health_.blamed_index = static_cast<std::int32_t>(i);
    set_text(health_.text, "drive {} gives {:.0f} % of the torque it is asked for", i,
             100.0 * e.drive_strength[i]);
    return true;
  }
  if (friction_.off) {
    health_.blame = health_t::DISC_FRICTION;
    set_text(health_.text, "the disc turns against {:.3g} N m {} friction than modelled",
             std::abs(e.disc_friction), e.disc_friction > 0.0 ? "more" : "less");
    return true;
  }
  if (inertia_.off) {
    health_.blame = health_t::INERTIA;
    set_text(health_.text, "the structure's inertia is {:.0f} % {} than the model's",
             100.0 * std::abs(e.inertia), e.inertia > 0.0 ? "larger" : "smaller");
    return true;
  }
  return false;
}

/// One alone may be wrong; several that are would have a common reason, which is not known.
bool Health::blame_disagreeing_sensors(const Follower& follower) noexcept {
  if (disagreeing_ < naming_) return false;
  const int alone =
      static_cast<int>(std::find_if(sensor_.begin(), sensor_.end(), disagrees) - sensor_.begin());
  if (std::count_if(sensor_.begin(), sensor_.end(), disagrees) == 1) {
    health_.blame = health_t::SENSOR + alone;
    say_sensor(alone, follower);
  } else {
    health_.blame = health_t::MODEL;
    set_text(health_.text,
             "several sensors disagree with the model, and nothing simple explains it");
  }
  return true;
}

/// The simplest reason: what is seen directly first, what explains everything last.
void Health::blame(const Follower& follower) noexcept {
  health_.blamed_index = 0;
  const auto count = std::count_if(sensor_.begin(), sensor_.end(), disagrees);
  disagreeing_ = count > 0 ? std::min(disagreeing_ + 1, naming_) : 0;
  // A sensor that is late explains what comes of it.
  const bool explained = trial_ == 0 && std::any_of(sensor_.begin(), sensor_.end(), is_late);
  trial_ = count > 1 && !explained ? std::min(trial_ + 1, trial_length_) : 0;
  // Where hardly a sensor agrees, what the filter makes of them says nothing of the parts.
  const bool lost = count > kFew;
  if (blame_evident_sensor(follower) || (!lost && blame_part(follower)) ||
      blame_disagreeing_sensors(follower)) {
    health_.verdict = health_t::DISAGREES;
    return;
  }
  health_.verdict = health_t::AGREES;
  const bool pushed_x = moment_[0].off;
  if (pushed_x || moment_[1].off) {
    health_.blame = health_t::EXTERNAL_MOMENT;
    const int axis = pushed_x ? 0 : 1;
    return set_text(health_.text, "agrees; an unknown moment of {:.3g} N m about {} acts on it",
                    follower.estimate().external_moment[axis], axis == 0 ? 'x' : 'y');
  }
  health_.blame = health_t::NOBODY;
  set_text(health_.text, "agrees");
}

std::int32_t Health::distrusted() const noexcept {
  std::int32_t sensors = 0;
  for (int s = 0; s < kHealthSensors; ++s) {
    if (is_late(sensor_[s])) sensors |= valid_bit(s);
  }
  if (trial_ > 0 && trial_ < trial_length_) sensors |= valid_bit(kGyro);
  return sensors;
}

}  // namespace gyrotwin
