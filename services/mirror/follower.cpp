#include "services/mirror/follower.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "services/mirror/filter.hpp"
#include "services/mirror/first_guess.hpp"
#include "services/onboard/gh_filter.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

// Transients of the start are over after this time [s].
constexpr double kSettling = 1.0;

// Ticks that are bridged; after a longer silence it starts anew.
constexpr std::int64_t kLongestGap = 50;

// Bandwidth of the rotors' speeds [rad/s].
constexpr double kRotorBandwidth = 20.0;

// A rotor's reading that is off by so many sigmas has jumped.
constexpr double kRotorJump = 8.0;

// A push is up to so many times what the unknown moment is at the start.
constexpr double kHardestPush = 2000.0;

// A gyro that is off by so many sigmas shows a push, or a bias that has jumped.
constexpr double kOutlier = 4.0;

// A reading without noise is stuck when what is expected of it has moved by so many steps.
constexpr double kSteps = 6.0;

// A sensor that does not fit for so long is believed again, with a bias that nobody knows [s].
constexpr double kPatience = 0.05;

// Doubt: over this window [s], above this misfit per channel, a single one counted at most as the
// worst; again after a while [s].
constexpr double kWonderWindow = 0.05, kWonder = 1.6, kWorst = 10.0, kBetweenDoubts = 0.1;
// It starts anew.
constexpr double kLost = 6.0, kLostAtFirst = 3.0;

const Rig& with_sensors(const Rig& rig) {
  if (rig.sensors) return rig;
  throw Error(
      "a rig without sensors cannot be followed: add a table [sensors] to its rig file, as the "
      "shipped rigs have it");
}

}  // namespace

static_assert(static_cast<int>(kSensors) == kHealthSensors);

struct Follower::Core {
  Core(const Rig& of, const model::Machine& the_machine)
      : rig(with_sensors(of)),
        machine(the_machine),
        filter(rig, machine),
        rotor_filter(kRotorBandwidth, kRotorBandwidth, rig.loop.tick_s()) {}

  bool settled() const noexcept {
    return static_cast<double>(steps) * rig.loop.tick_s() > kSettling;
  }
  void start(const sensors_t& first) noexcept;
  void step(const sensors_t& sensors, const model::Input& input) noexcept;
  void hear_rotors(const sensors_t& sensors) noexcept;
  bool stands_still(int channel) noexcept;
  void look(const sensors_t& sensors) noexcept;
  void use() noexcept;
  void suspect_push() noexcept;
  void wonder(unsigned believed) noexcept;
  int odd_one_out() const noexcept;
  void fill() noexcept;

  const Rig& rig;
  const model::Machine& machine;
  Filter filter;
  GhFilter rotor_filter;
  std::array<Track, model::kMaxRotors> rotor{};
  std::array<bool, model::kMaxRotors> rotor_heard{};

  std::array<model::Input, Rig::Sensors::kMaxDelay + 1> acting{};  // ring, newest at steps
  std::int64_t steps = 0;                                          // since start()
  std::int64_t last_tick = 0;
  Prediction::Tick tick;
  Channels heard{};
  struct Repeats {
    double reading, expected;  // since it is the same
    std::int64_t count;        // how often again
  };
  std::array<Repeats, kMaxChannels> repeats{};
  std::int32_t distrusted = 0;                 // VALID_*
  unsigned used = 0;                           // channels that were heard, are sane and trusted
  std::array<unsigned, kSensors> of_sensor{};  // those that were heard and are sane
  std::array<int, kSensors> refused{};         // for so many ticks on end
  double misfit = 1.0;  // of all channels, each, on average over kWonderWindow
  std::int64_t since_doubt = 0;
  int losses = 0;
  Estimate estimate;
  std::array<Innovation, kSensors> innovations{};
};

Follower::Follower(const Rig& rig, const model::Machine& machine)
    : core_(std::make_unique<Core>(rig, machine)) {
  core_->start({});
}
Follower::~Follower() = default;

void Follower::start(const sensors_t& first) noexcept { core_->start(first); }
void Follower::step(const sensors_t& sensors, const model::Input& acting) noexcept {
  core_->step(sensors, acting);
}

void Follower::Core::start(const sensors_t& first) noexcept {
  const FirstGuess guess = first_guess(rig, machine, first);
  filter.start(guess.state, guess.sigma);

  rotor_heard.fill(false);
  tick.rotor_speed = machine.nominal_rotor_speed;
  tick.rotor_rate = {};
  hear_rotors(first);
  steps = 0;
  last_tick = first.header.tick;
  innovations = {};
  refused.fill(0);
  misfit = 1.0;
  since_doubt = 0;
  fill();
}

/// Rotor speeds are taken from their sensors, smoothed; nominal where there is nothing to hear. No
/// flywheel jumps: a reading that does is its sensor's affair.
void Follower::Core::hear_rotors(const sensors_t& sensors) noexcept {
  innovations[kRotors] = {};
  for (int j = 0; j < machine.rotors; ++j) {
    Innovation& innovation = innovations[kRotors];
    const double speed = sensors.rotor_speed_rad_s[j];
    const bool told = sensors.valid & valid_bit(kRotors);
    const bool usable = told && sane(speed);
    innovation.insane |= told && !usable;
    if (!usable) {
      rotor[j] = {machine.nominal_rotor_speed[j]};
    } else if (!rotor_heard[j]) {
      rotor[j] = {speed};
    } else {
      const Imperfection& imperfection = rig.sensors->rotor;
      const double sigma = std::hypot(imperfection.noise, imperfection.resolution / 3.0, 1e-6);
      rotor_filter.predict(rotor[j]);
      innovation.expected[j] = rotor[j].angle;
      innovation.value[j] = speed - rotor[j].angle;
      innovation.nis += innovation.value[j] * innovation.value[j] / (sigma * sigma);
      ++innovation.channels;
      if (std::abs(innovation.value[j]) < kRotorJump * sigma) {
        rotor_filter.correct(rotor[j], speed);
      } else {
        rotor[j].drift = 0.0;
        innovation.refused = true;
      }
    }
    rotor_heard[j] = usable;
    tick.rotor_speed[j] = rotor[j].angle;
    tick.rotor_rate[j] = machine.rotor_drive ? rotor[j].drift : 0.0;
  }
}

void Follower::Core::step(const sensors_t& sensors, const model::Input& input) noexcept {
  const int delay = rig.sensors->delay_ticks;
  const std::int64_t missing = std::max<std::int64_t>(sensors.header.tick - last_tick - 1, 0);
  if (missing > kLongestGap) {
    start(sensors);
    return;
  }
  last_tick = sensors.header.tick;
  for (std::int64_t k = 0; k <= missing; ++k) {
    acting[++steps % acting.size()] = input;
    // Until the delay is over, the sensors show the start.
    if (steps <= delay) continue;
    tick.acting = acting[(steps - delay) % acting.size()];
    if (k == missing) {
      innovations = {};
      hear_rotors(sensors);
    }
    filter.predict(tick);
  }
  if (steps > delay) {
    look(sensors);
    use();
  }
  if (misfit > (settled() ? kLost : kLostAtFirst) || !filter.mean().allFinite()) {
    ++losses;
    start(sensors);
    return;
  }
  fill();
}

/// Whether a channel says the same for longer than its noise allows or, where it has none, than
/// what is expected of it has moved.
bool Follower::Core::stands_still(int c) noexcept {
  const Reading& channel = filter.readings().channel[c];
  Repeats& repeat = repeats[c];
  if (heard[c] != repeat.reading) {
    repeat = {heard[c], filter.expected(c), 0};
    return false;
  }
  ++repeat.count;
  if (channel.many_repeats > 0) return repeat.count >= channel.many_repeats;
  const double moved = std::abs(filter.expected(c) - repeat.expected);
  return moved > kSteps * std::max(channel.resolution, std::sqrt(channel.variance));
}

/// What is heard against what is expected.
void Follower::Core::look(const sensors_t& sensors) noexcept {
  used = 0;
  const Readings& readings = filter.readings();
  of_sensor.fill(0);
  for (int c = 0; c < readings.count; ++c) {
    const Reading& channel = readings.channel[c];
    Innovation& innovation = innovations[channel.sensor];
    if (!(sensors.valid & valid_bit(channel.sensor))) continue;
    heard[c] = channels_of(sensors, channel.sensor, machine).value[channel.index];
    if (!sane(heard[c])) {
      innovation.insane = true;
      continue;
    }
    innovation.expected[channel.index] = filter.expected(c);
    innovation.value[channel.index] = heard[c] - filter.expected(c);
    if (stands_still(c)) {
      innovation.stuck = true;
      continue;
    }
    // Rounding errs afresh only when a step is passed.
    if (channel.rounds) filter.weigh(c, 1.0 + repeats[c].count);
    if (!(distrusted & valid_bit(channel.sensor))) used |= 1u << c;
    of_sensor[channel.sensor] |= 1u << c;
    ++innovation.channels;
  }
}

/// Bound of a sum of `count` squared normal numbers that is hardly ever passed (Wilson and
/// Hilferty).
double bound_of(int count) {
  constexpr double kOften = 5.2;  // in sigmas: once in 10^7
  const double v = 2.0 / (9.0 * count);
  const double root = 1.0 - v + kOften * std::sqrt(v);
  return count * root * root * root;
}

bool fits(const Filter& filter, const Channels& heard, unsigned use) {
  return use == 0 || filter.misfit(heard, use) <= bound_of(std::popcount(use));
}

/// Opens all that a push may be: the moment, and the bias of a gyro that shows it, for a bias that
/// has jumped looks the same at first. What the next readings say decides.
void Follower::Core::suspect_push() noexcept {
  const Unknowns& u = filter.unknowns();
  for (int i = 0; i < 2; ++i) {
    if (u.moment[i] >= 0) filter.open(tick, u.moment[i], kHardestPush * u.prior[u.moment[i]]);
  }
  for (int i = 0; i < 3; ++i) {
    const double innovation = std::abs(innovations[kGyro].value[i]);
    const double sigma = std::hypot(filter.expected_sigma(i), std::sqrt(filter.variance(i)));
    if (innovation > kOutlier * sigma) filter.open(tick, u.gyro_bias[i], innovation);
  }
}

/// The one sensor without which the others fit; -1: there is none.
int Follower::Core::odd_one_out() const noexcept {
  int odd = -1;
  double best = 1.0;
  for (int s = 0; s < kSensors; ++s) {
    const unsigned rest = used & ~of_sensor[s];
    if ((of_sensor[s] & used) == 0 || rest == 0) continue;
    const double share = filter.misfit(heard, rest) / bound_of(std::popcount(rest));
    if (share > best) continue;
    best = share;
    odd = s;
  }
  return odd;
}

/// Readings that do not fit have a reason, the simplest that explains them: a push, or one sensor.
void Follower::Core::use() noexcept {
  int odd = -1;
  if (!fits(filter, heard, used)) {
    suspect_push();
    if (!fits(filter, heard, used)) {
      filter.close();
      odd = odd_one_out();
      if (odd < 0) {
        suspect_push();
        odd = odd_one_out();
      }
    }
  }
  for (int s = 0; s < kSensors; ++s) {
    if (of_sensor[s] != 0) innovations[s].nis = filter.misfit(heard, of_sensor[s]);
    refused[s] = s == odd ? refused[s] + 1 : 0;
    innovations[s].refused = s == odd;
    if (refused[s] < kPatience / rig.loop.tick_s() || !settled()) continue;
    // What it says now may be right but for a new bias.
    refused[s] = 0;
    odd = -1;
    for (int c = 0; c < filter.readings().count; ++c) {
      const Reading& channel = filter.readings().channel[c];
      if (!(of_sensor[s] & (1u << c)) || channel.bias < 0) continue;
      filter.open(tick, channel.bias, std::abs(innovations[s].value[channel.index]));
    }
  }
  const unsigned believed = odd < 0 ? used : used & ~of_sensor[odd];
  wonder(believed);
  for (int c = 0; c < filter.readings().count; ++c) {
    if (believed & (1u << c)) filter.absorb(c, heard[c]);
  }
}

/// Where readings fit badly for some time, what was learned of the rig is no longer true: all of it
/// is opened again.
void Follower::Core::wonder(unsigned believed) noexcept {
  const double dt = rig.loop.tick_s();
  const int count = std::popcount(believed);
  if (count > 0) {
    const double per_channel = filter.misfit(heard, believed) / count;
    misfit += dt / kWonderWindow * (std::min(per_channel, kWorst) - misfit);
  }
  ++since_doubt;
  if (misfit < kWonder || !settled() || static_cast<double>(since_doubt) * dt < kBetweenDoubts)
    return;
  since_doubt = 0;
  const Unknowns& u = filter.unknowns();
  for (int i = 2 * u.coordinates; i < u.size; ++i) {
    const bool moment = i == u.moment[0] || i == u.moment[1];
    if (!moment && u.prior[i] > 0.0) filter.open(tick, i, u.prior[i]);
  }
}

/// The estimate, brought forward over the sensors' delay.
void Follower::Core::fill() noexcept {
  const Unknowns& u = filter.unknowns();
  const int n = u.coordinates;
  Filter::Point x = filter.mean();
  Prediction::Tick ahead = tick;
  for (int d = rig.sensors->delay_ticks - 1; d >= 0; --d) {
    if (steps - d < 1) continue;
    ahead.acting = acting[(steps - d) % acting.size()];
    filter.advance(ahead, x);
  }
  estimate = {};
  estimate.state.q.head(n) = x.head(n);
  estimate.state.v.head(n) = x.segment(n, n);
  estimate.state.rotor_speed = tick.rotor_speed;
  for (int i = 0; i < 3; ++i) {
    estimate.gyro_bias[i] = x[u.gyro_bias[i]];
    estimate.accelerometer_bias[i] = x[u.accelerometer_bias[i]];
  }
  const auto take = [&](int place, double& value, double& sigma, double scale, double offset) {
    if (place < 0) return;
    value = offset + scale * x[place];
    sigma = filter.sigma(place);
  };
  for (int i = 0; i < 2; ++i) {
    take(u.moment[i], estimate.external_moment[i], estimate.external_moment_sigma[i], 1.0, 0.0);
  }
  take(u.friction, estimate.disc_friction, estimate.disc_friction_sigma, 1.0, 0.0);
  take(u.inertia, estimate.inertia, estimate.inertia_sigma, 1.0, 0.0);
  for (std::size_t i = 0; i < u.strength.size(); ++i) {
    take(u.strength[i], estimate.drive_strength[i], estimate.drive_strength_sigma[i], -1.0, 1.0);
  }
}

void Follower::distrust(std::int32_t sensors) noexcept { core_->distrusted = sensors; }

const Estimate& Follower::estimate() const noexcept { return core_->estimate; }

bool Follower::settled() const noexcept { return core_->settled(); }

int Follower::losses() const noexcept { return core_->losses; }

std::int32_t Follower::valid() const noexcept {
  const model::Layout& layout = core_->machine.layout;
  std::int32_t valid = 0;
  if (layout.tilts() > 0) valid |= state_t::VALID_TILT;
  if (core_->machine.disc_body != model::kFixed) valid |= state_t::VALID_DISC_TILT;
  if (layout.disc != model::kFixed) valid |= state_t::VALID_DISC;
  if (!layout.gimbals.empty()) valid |= state_t::VALID_GIMBALS;
  if (core_->machine.rotors > 0) valid |= state_t::VALID_ROTORS;
  return valid;
}

Bias Follower::bias(int sensor, int channel) const noexcept {
  const Filter& filter = core_->filter;
  for (int c = 0; c < filter.readings().count; ++c) {
    const Reading& reading = filter.readings().channel[c];
    if (reading.sensor != sensor || reading.index != channel || reading.bias < 0) continue;
    return {filter.mean()[reading.bias], filter.sigma(reading.bias),
            filter.unknowns().prior[reading.bias]};
  }
  return {};
}

int Follower::dimension() const noexcept { return 2 * core_->machine.coordinates(); }

Follower::Covariance Follower::deviation() const noexcept {
  Deviations D = core_->filter.deviations();
  D.compress();
  const int n = dimension();
  return D.used().topLeftCorner(n, n).transpose();
}

model::State Follower::draw(int index, std::span<const double> normal) const noexcept {
  const int n = core_->machine.coordinates();
  const Covariance S = deviation();
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2 * model::kMaxCoordinates, 1> z(dimension());
  std::copy_n(normal.begin() + static_cast<std::ptrdiff_t>(index) * dimension(), dimension(),
              z.data());
  const auto step = (S.template triangularView<Eigen::Lower>() * z).eval();
  model::State state = core_->estimate.state;
  state.q.head(n) += step.head(n);
  state.v.head(n) += step.tail(n);
  return state;
}

const std::array<Innovation, kHealthSensors>& Follower::innovations() const noexcept {
  return core_->innovations;
}

}  // namespace gyrotwin
