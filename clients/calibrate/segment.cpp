#include "clients/calibrate/segment.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "clients/calibrate/flow.hpp"
#include "services/integrator/plant.hpp"
#include "services/onboard/estimator.hpp"

namespace gyrotwin::calibration {

namespace {

constexpr std::size_t kSlopeTicks = 5;  // on both sides, for a rate from angles

/// What the angle sensors say, as a state; what they do not say is 0.
model::State seen_state(const sensors_t& sensors, const model::Machine& machine) {
  model::Observation seen;
  seen.disc_angle = sensors.disc_angle_rad;
  std::copy_n(sensors.gimbal_angle_rad, model::kMaxGyros, seen.gimbal_angle.begin());
  std::copy_n(sensors.rotor_speed_rad_s, model::kMaxGyros, seen.rotor_speed.begin());
  return machine.recall(seen);
}

/// Lines through what a sensor says of some coordinates around a moment: value and slope at it.
void fit_lines(const Stretch& stretch, std::size_t at, const model::Machine& machine,
               std::int32_t sensor, const std::vector<int>& coordinates, model::State& state) {
  const std::size_t first = at > kSlopeTicks ? at - kSlopeTicks : 0;
  const std::size_t last = std::min(stretch.moments.size() - 1, at + kSlopeTicks);
  double count = 0.0;
  double sum_t = 0.0;
  double sum_tt = 0.0;
  model::Coordinates sum_q = model::Coordinates::Zero();
  model::Coordinates sum_tq = model::Coordinates::Zero();
  for (std::size_t i = first; i <= last; ++i) {
    const auto& sensors = stretch.moments[i].sensors;
    if (!sensors || (sensors->valid & sensor) == 0) continue;
    const double t = stretch.tick_s * (static_cast<double>(i) - static_cast<double>(at));
    const model::Coordinates q = seen_state(*sensors, machine).q;
    if (!std::ranges::all_of(coordinates, [&](int c) { return std::isfinite(q[c]); })) continue;
    count += 1.0;
    sum_t += t;
    sum_tt += t * t;
    sum_q += q;
    sum_tq += t * q;
  }
  const double spread = count * sum_tt - sum_t * sum_t;
  if (spread <= 0.0) return;
  const model::Coordinates slope = (count * sum_tq - sum_t * sum_q) / spread;
  const model::Coordinates value = (sum_q - slope * sum_t) / count;
  for (const int coordinate : coordinates) {
    state.q[coordinate] = value[coordinate];
    state.v[coordinate] = slope[coordinate];
  }
}

/// A state at every moment: tilts by the onboard estimator, other angles by lines through them.
std::vector<model::State> guess(const Rig& rig, const model::Machine& machine,
                                const Stretch& stretch) {
  OnboardEstimator estimator(rig, machine);
  estimator.forget();
  std::vector<int> disc;
  std::vector<int> gimbals;
  if (machine.layout.disc != model::kFixed) disc.push_back(machine.layout.disc);
  for (const auto& gimbal : machine.layout.gimbals) gimbals.push_back(gimbal.coordinate);
  std::vector<model::State> states;
  for (std::size_t i = 0; i < stretch.moments.size(); ++i) {
    const auto& sensors = stretch.moments[i].sensors;
    estimator.step(sensors ? *sensors : sensors_t{});
    model::State state = machine.recall(estimator.seen());
    state.rotor_speed = machine.nominal_rotor_speed;
    fit_lines(stretch, i, machine, sensors_t::VALID_DISC, disc, state);
    fit_lines(stretch, i, machine, sensors_t::VALID_GIMBALS, gimbals, state);
    if (sensors && (sensors->valid & sensors_t::VALID_ROTORS) != 0) {
      const model::RotorSpeeds speed = seen_state(*sensors, machine).rotor_speed;
      for (std::size_t j = 0; j < speed.size(); ++j) {
        if (std::isfinite(speed[j])) state.rotor_speed[j] = speed[j];
      }
    }
    states.push_back(state);
  }
  return states;
}

model::RotorSpeeds mean_rotor_speeds(const std::vector<model::State>& states, std::size_t first,
                                     std::size_t last) {
  model::RotorSpeeds mean{};
  for (std::size_t i = first; i < last; ++i) {
    for (std::size_t j = 0; j < mean.size(); ++j) {
      mean[j] += states[i].rotor_speed[j] / static_cast<double>(last - first);
    }
  }
  return mean;
}

/// Makes the rows of one machine's segments and knows the biases that there are.
class RowMaker {
 public:
  RowMaker(const Rig& rig, const model::Machine& machine, const Cuts& cuts,
           std::vector<Bias>& biases)
      : rig_(rig), machine_(machine), cuts_(cuts), biases_(biases) {}

  void add(const Stretch& stretch, Segment& segment) {
    const std::size_t end = segment.continued ? segment.last : segment.last + 1;
    for (std::size_t i = segment.first; i < end; ++i) {
      const Moment& moment = stretch.moments[i];
      if (!moment.sensors || moment.tick % cuts_.every != 0) continue;
      for (const int reading : valid_readings(*moment.sensors, machine_)) {
        // What led to a stretch's first moment is unknown, and an accelerometer feels it.
        const SensorKind kind = kind_of(reading);
        if (!used(kind) || (i == 0 && kind == SensorKind::kAccelerometer)) continue;
        const Uncertainty off = uncertainty(*rig_.sensors, kind);
        const double sigma = off.sample * std::sqrt(repeats(stretch, i, reading));
        segment.rows.push_back(
            {i, reading, reading_of(*moment.sensors, reading), sigma, bias_of(reading, off.bias)});
      }
    }
  }

 private:
  bool used(SensorKind kind) const {
    return cuts_.use.empty() || std::ranges::find(cuts_.use, kind) != cuts_.use.end();
  }

  /// How many readings that count say the same on end, where rounding alone makes them differ: all
  /// of them together are off by one rounding, and tell as much as one.
  double repeats(const Stretch& stretch, std::size_t at, int reading) {
    if (!is_rounded(*rig_.sensors, kind_of(reading))) return 1.0;
    Same& run = same_[static_cast<std::size_t>(reading)];
    if (run.stretch != &stretch || at < run.first || at > run.last) {
      const auto same = [&](std::size_t i) {
        const auto& other = stretch.moments[i].sensors;
        return other &&
               reading_of(*other, reading) == reading_of(*stretch.moments[at].sensors, reading);
      };
      run = {&stretch, at, at};
      while (run.first > 0 && same(run.first - 1)) --run.first;
      while (run.last + 1 < stretch.moments.size() && same(run.last + 1)) ++run.last;
    }
    return std::max(1.0, static_cast<double>(run.last - run.first + 1) / cuts_.every);
  }

  int bias_of(int reading, double sigma) {
    if (sigma <= 0.0) return -1;
    const auto found = std::ranges::find(biases_, reading, &Bias::reading);
    if (found != biases_.end()) return static_cast<int>(found - biases_.begin());
    biases_.push_back({reading, sigma});
    return static_cast<int>(biases_.size()) - 1;
  }

  const Rig& rig_;
  const model::Machine& machine_;
  const Cuts& cuts_;
  std::vector<Bias>& biases_;

  /// Moments in which a reading stays the same.
  struct Same {
    const Stretch* stretch = nullptr;
    std::size_t first = 0, last = 0;
  };
  std::array<Same, kReadings> same_{};  // of each reading, the last ones looked at
};

}  // namespace

double default_length(const model::Machine& machine) { return machine.track ? 0.05 : 0.2; }

double seam_sigma(Eigen::Index i, int n) {
  if (i < n) return kSeam;
  return i < Eigen::Index{2} * n ? 10.0 * kSeam : 1e4 * kSeam;
}

model::Input input_of(const Moment& moment, const model::Machine& machine) {
  model::Input input = moment.input;
  if (!moment.current) return input;
  input.mode = model::DriveMode::kIdealTorque;
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    const auto& motor = machine.drives[i].motor;
    input.drive[i] =
        motor ? motor->torque_constant * motor->gear_ratio * (*moment.current)[i] : 0.0;
  }
  return input;
}

std::vector<Segment> cut(const Rig& rig, const model::Machine& machine,
                         const std::vector<Stretch>& stretches, const Cuts& cuts,
                         std::vector<Bias>& biases) {
  std::vector<Segment> segments;
  RowMaker rows(rig, machine, cuts, biases);
  const auto wanted = static_cast<std::size_t>(
      std::max<std::int64_t>(2, std::llround(cuts.length_s / rig.loop.tick_s())));
  for (const Stretch& stretch : stretches) {
    const std::vector<model::State> states = guess(rig, machine, stretch);
    const std::size_t ticks = stretch.moments.size() - 1;
    const std::size_t count = std::max<std::size_t>(1, (ticks + wanted / 2) / wanted);
    for (std::size_t k = 0; k < count; ++k) {
      Segment segment{&stretch, ticks * k / count, ticks * (k + 1) / count, k + 1 < count, {}, {},
                      {}};
      segment.held = mean_rotor_speeds(states, segment.first, segment.last);
      segment.start.resize(packed_size(machine));
      pack(machine, states[segment.first], segment.start.data());
      rows.add(stretch, segment);
      segments.push_back(std::move(segment));
    }
  }
  return segments;
}

namespace {

/// How long the input of a moment goes on, up to the end of the segment [tick].
std::size_t ticks_alike(const Segment& segment, std::size_t from) {
  const auto& moments = segment.stretch->moments;
  std::size_t to = from + 1;
  while (to < segment.last && !moments[from].current &&
         alike(moments[from].input, moments[to].input)) {
    ++to;
  }
  return to - from;
}

/// Rows of one moment, compared with the model there.
class Comparison {
 public:
  Comparison(const Segment& segment, const Neighbourhood& around, const Rig::Sensors& sensors,
             std::span<const double> biases, bool derivatives, Shot& shot)
      : segment_(segment),
        around_(around),
        sensors_(sensors),
        biases_(biases),
        derivatives_(derivatives),
        shot_(shot) {}

  void at(std::size_t moment, const Flow& flow) {
    if (next_ >= segment_.rows.size() || segment_.rows[next_].moment != moment) return;
    const model::Machine& machine = around_.machine;
    // An accelerometer feels what led here.
    const Moment& led = segment_.stretch->moments[moment > 0 ? moment - 1 : moment];
    const model::Input input = input_of(led, machine);
    const model::State state = flow.unpacked();
    const Readings predicted = predict(machine, state, input, sensors_);
    if (derivatives_) {
      const ReadingDerivatives d = reading_derivatives(around_, state, input, sensors_);
      const Eigen::Index n = d.by_state.cols();
      by_start_ = d.by_state * flow.sensitivity().leftCols(n);
      by_parameter_ =
          d.by_state * flow.sensitivity().rightCols(d.by_parameter.cols()) + d.by_parameter;
    }
    for (; next_ < segment_.rows.size() && segment_.rows[next_].moment == moment; ++next_) {
      const Row& row = segment_.rows[next_];
      const double bias = row.bias < 0 ? 0.0 : biases_[static_cast<std::size_t>(row.bias)];
      const auto i = static_cast<Eigen::Index>(next_);
      shot_.residual[i] = (predicted[row.reading] + bias - row.value) / row.sigma;
      if (!derivatives_) continue;
      shot_.by_start.row(i) = by_start_.row(row.reading) / row.sigma;
      shot_.by_parameter.row(i) = by_parameter_.row(row.reading) / row.sigma;
    }
  }

 private:
  const Segment& segment_;
  const Neighbourhood& around_;
  const Rig::Sensors& sensors_;
  std::span<const double> biases_;
  bool derivatives_;
  Shot& shot_;
  std::size_t next_ = 0;
  Eigen::MatrixXd by_start_, by_parameter_;
};

}  // namespace

bool shoot(const Segment& segment, const Neighbourhood& around, const Rig::Sensors& sensors,
           std::span<const double> start, std::span<const double> next,
           std::span<const double> biases, bool derivatives, Shot& shot) {
  const auto n = static_cast<Eigen::Index>(start.size());
  const auto parameters = static_cast<Eigen::Index>(around.pairs.size());
  shot.residual.resize(segment.size());
  if (derivatives) {
    shot.by_start.resize(segment.size(), n);
    shot.by_parameter.resize(segment.size(), parameters);
  }
  const model::Machine& machine = around.machine;
  const auto& moments = segment.stretch->moments;
  const double tick_s = segment.stretch->tick_s;
  Flow flow(around, segment.held, Eigen::Map<const Eigen::VectorXd>(start.data(), n), derivatives);
  Comparison compare(segment, around, sensors, biases, derivatives, shot);
  std::size_t alike_until = segment.first;
  for (std::size_t i = segment.first; i < segment.last; ++i) {
    compare.at(i, flow);
    if (i >= alike_until) alike_until = i + ticks_alike(segment, i);
    const double lasts = tick_s * static_cast<double>(alike_until - i);
    if (!flow.advance(input_of(moments[i], machine), tick_s, lasts)) return false;
  }
  if (!segment.continued) {
    compare.at(segment.last, flow);
    return true;
  }
  const auto rows = static_cast<Eigen::Index>(segment.rows.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const double sigma = seam_sigma(i, machine.coordinates());
    shot.residual[rows + i] = (flow.state()[i] - next[static_cast<std::size_t>(i)]) / sigma;
    if (!derivatives) continue;
    shot.by_start.row(rows + i) = flow.sensitivity().row(i).head(n) / sigma;
    shot.by_parameter.row(rows + i) = flow.sensitivity().row(i).tail(parameters) / sigma;
  }
  return true;
}

}  // namespace gyrotwin::calibration
