#include "clients/simulate/simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "clients/simulate/sampled_loop.hpp"
#include "services/integrator/plant.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr double kDefaultSample = 0.01;  // [s]
constexpr double kLongestPiece =
    0.01;  // of adaptive stepping, so that no short pulse is missed [s]
// Times closer than this share of a second (or of themselves) are the same, but for rounding.
constexpr double kSameTime = 1e-12;
// Share of a tick that is surely inside of it and changes nothing else.
constexpr double kInside = 1e-9;
// Share of a sample or step that is no more than rounding.
constexpr double kSameCount = 1e-6;
// Tick periods are whole nanoseconds, rates need not be: how far a tick may be from what is meant.
constexpr double kSameTick = 1e-9;  // [s]

std::string seconds(double t) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", t);
  return text;
}

/// The steps between which spectators look on, and how many of them make a sample. All are equal
/// but, where time does not go in ticks, the last.
struct Grid {
  double step;  // [s]
  std::int64_t steps_per_sample;
  double sample;  // [s]
  std::int64_t steps;
  double last_step;  // [s]

  double time(std::int64_t i) const {
    if (i == steps && last_step != step) return time(i - 1) + last_step;
    const std::int64_t samples = i / steps_per_sample;
    return static_cast<double>(samples) * sample + static_cast<double>(i % steps_per_sample) * step;
  }
  double length(std::int64_t i) const { return i + 1 == steps ? last_step : step; }
  bool sample_at(std::int64_t i) const { return i % steps_per_sample == 0 || i == steps; }
};

/// How many ticks an option's time is.
/// @throws Error when it falls between two
std::int64_t ticks_in(const char* option, double time, double tick) {
  const double wanted = time / tick;
  const double count = std::max(1.0, std::round(wanted));
  if (std::abs(time - count * tick) <= kSameTick * count) return static_cast<std::int64_t>(count);
  const double below = std::floor(wanted);
  throw Error(std::string(option) + " " + seconds(time) + ": time goes in ticks of " +
              seconds(tick) + " s here; the nearest that fit are " +
              (below > 0.0 ? seconds(below * tick) + " and " : "") + seconds((below + 1.0) * tick) +
              " (continuous feedback with the adaptive stepper takes any)");
}

Grid tick_grid(double tick, const Scenario& scenario) {
  const std::int64_t nearest = std::max(std::llround(kDefaultSample / tick), 1LL);
  const std::int64_t count =
      scenario.sample ? ticks_in("--sample", *scenario.sample, tick) : nearest;
  const double sample = scenario.sample.value_or(static_cast<double>(count) * tick);
  return {tick, count, sample, ticks_in("--duration", scenario.duration, tick), tick};
}

Grid free_grid(const Scenario& scenario) {
  const double sample = scenario.sample.value_or(kDefaultSample);
  const double count = std::max(1.0, std::ceil(sample / kLongestPiece - kSameCount));
  const double step = sample / count;
  const double whole = std::floor(scenario.duration / step + kSameCount);
  const double rest = scenario.duration - whole * step;
  Grid grid{step, static_cast<std::int64_t>(count), sample, static_cast<std::int64_t>(whole), step};
  if (rest > kSameCount * std::min(step, scenario.duration)) {
    ++grid.steps;
    grid.last_step = rest;
  }
  return grid;
}

Grid grid_of(const Rig& rig, const Scenario& scenario) {
  const bool ticks = scenario.sampled || scenario.stepping.kind != StepPolicy::Kind::kAdaptive;
  return ticks ? tick_grid(rig.loop.tick_s(), scenario) : free_grid(scenario);
}

/// A gust or a wind acts in the last fifth of the run.
bool random_to_the_end(const Rig& rig, const Scenario& scenario) {
  constexpr double kLate = 0.8;
  return std::ranges::any_of(scenario.events, [&](const Scenario::Event& event) {
    const request_t& request = event.request;
    if (request.verb != request_t::DISTURB) return false;
    if (request.kind != request_t::GUST && request.kind != request_t::WIND) return false;
    const double begin = static_cast<double>(request.start_tick) * rig.loop.tick_s();
    const double length = static_cast<double>(request.duration_ns) * 1e-9;
    return request.duration_ns == 0 || begin + length > kLate * scenario.duration;
  });
}

bool finite(const model::Input& input) {
  return std::all_of(input.drive.begin(), input.drive.end(),
                     [](double x) { return std::isfinite(x); }) &&
         input.force.allFinite() && input.moment.allFinite();
}

/// Machine, law and inputs as one differential equation in (packed state, law's memory), in the
/// time since the last grid point.
class LoopOde : public Ode {
 public:
  /// @param law null: the drives are held, or the scenario's
  LoopOde(const model::Machine& machine, const Scenario& scenario, const Law* law)
      : machine_(machine), scenario_(scenario), law_(law) {}

  int size() const noexcept override { return packed_size(machine_) + (law_ ? law_->states() : 0); }

  void rates(double t, const double* y, double* dy) noexcept override {
    const int n = packed_size(machine_);
    const model::State state = unpack(machine_, y, scenario_.start.rotor_speed);
    // A law that sees no finite state cannot help it.
    if (act(t, state, y + n, dy + n)) check(state);
    packed_rates(machine_, state, input_, dy);
  }

  /// Where local time 0 is [s].
  void start_at(double t) { origin_ = t; }
  /// A time inside the coming piece [s].
  void stay_within(double t) { within_ = t; }
  /// What acts over the tick beside the scenario's external loads.
  void hold(const model::Input& input) {
    input_ = input;
    held_ = {input.force, input.moment};
    input_finite_ = input_finite_ && finite(input_);
  }

  /// What acts at local time t, the law's memory being z. The last input stays readable.
  void look(double t, const model::State& state, const double* z) noexcept {
    std::array<double, kMaxLawStates> ignored;
    if (act(t, state, z, ignored.data())) check(state);
  }
  const model::Input& input() const { return input_; }
  bool input_finite() const { return input_finite_; }

 private:
  void check(const model::State& state) noexcept {
    input_finite_ = input_finite_ && (finite(input_) || !state.finite());
  }

  /// @return whether the input was made for this instant
  bool act(double t, const model::State& state, const double* z, double* dz) noexcept {
    if (scenario_.sampled && !scenario_.external.value) return false;
    // A hair inside the piece: a formula that jumps at its end has not jumped yet.
    const double inside = within_ + (origin_ + t - within_) * (1.0 - kInside);
    const Instant now{inside, within_, state};
    if (scenario_.external.value) {
      const Wrench wrench = scenario_.external.value(now);
      input_.force = held_.force + wrench.force;
      input_.moment = held_.moment + wrench.moment;
    }
    if (law_) ask_law(state, z, dz);
    if (!scenario_.sampled && scenario_.torque) input_.drive = scenario_.torque->value(now);
    return true;
  }

  void ask_law(const model::State& state, const double* z, double* dz) noexcept {
    const model::Observation seen = machine_.observe(state);
    LawState memory = LawState::Zero();
    std::copy_n(z, law_->states(), memory.data());
    input_.drive = law_->torque(seen, memory);
    if (law_->states() == 0) return;
    const DriveTorques given = within_limits(machine_, seen, input_.drive);
    const LawState rates = law_->rates(seen, memory, input_.drive, given);
    std::copy_n(rates.data(), law_->states(), dz);
  }

  const model::Machine& machine_;
  const Scenario& scenario_;
  const Law* law_;
  double origin_ = 0.0;
  double within_ = 0.0;
  Wrench held_;         // over the tick; sampled feedback
  model::Input input_;  // of the last evaluation
  bool input_finite_ = true;
};

class Run {
 public:
  Run(const Rig& rig, const model::Machine& machine, const Scenario& scenario, Spectator& spectator)
      : machine_(machine),
        scenario_(scenario),
        spectator_(spectator),
        grid_(grid_of(rig, scenario)),
        law_(scenario.sampled || scenario.torque ? nullptr : make_law(rig)),
        ode_(machine, scenario, law_.get()),
        stepper_(ode_, scenario.stepping),
        y_(static_cast<std::size_t>(ode_.size())),
        state_(scenario.start),
        outcome_{.verdict =
                     Verdict(rig, machine, scenario.duration, random_to_the_end(rig, scenario))} {
    if (!scenario.sampled && scenario.stepping.kind == StepPolicy::Kind::kQuick) {
      throw Error(
          "quick steps go to the end of a tick at once and may miss what comes in between: they "
          "need sampled feedback; add --feedback sampled, or take --stepper adaptive");
    }
    if (scenario.sampled) {
      sampled_.emplace(rig, machine, scenario);
    } else if (rig.loop.state == StateSource::kEstimate || !scenario.events.empty()) {
      throw Error("estimates and scenario files go in ticks: they need sampled feedback");
    }
    pack(machine, state_, y_.data());
    if (law_) {
      const LawState memory = law_->start(machine.observe(state_));
      std::copy_n(memory.data(), law_->states(), law_memory());
    }
    breakpoints_ = scenario.external.breakpoints;
    if (!scenario.sampled && scenario.torque) {
      const auto& more = scenario.torque->breakpoints;
      breakpoints_.insert(breakpoints_.end(), more.begin(), more.end());
      std::sort(breakpoints_.begin(), breakpoints_.end());
    }
  }

  Outcome go() {
    using End = Outcome::End;
    outcome_.verdict.note(0.0, machine_, state_);
    if (!scenario_.sampled) {
      ode_.stay_within(0.5 * grid_.length(0));
      ode_.look(0.0, state_, law_memory());
    }
    show();
    for (std::int64_t i = 0; i < grid_.steps; ++i) {
      if (!spectator_.go_on(outcome_)) {
        outcome_.end = End::kStopped;
        return outcome_;
      }
      const bool done = step(i);
      if (!ode_.input_finite() || !done) {
        outcome_.end = ode_.input_finite() ? End::kNotFinite : End::kInputNotFinite;
        return outcome_;
      }
      outcome_.t = grid_.time(i + 1);
      outcome_.verdict.note(outcome_.t, machine_, state_);
      if (grid_.sample_at(i + 1)) show();
    }
    return outcome_;
  }

 private:
  double* law_memory() { return y_.data() + packed_size(machine_); }

  void show() {
    spectator_.sample(
        {outcome_.t, state_, ode_.input(), sampled_ ? sampled_->estimate() : nullptr});
  }

  /// One grid step, cut at breakpoints so that the right-hand side is smooth within each piece.
  bool step(std::int64_t i) {
    const double t = grid_.time(i);
    const double length = grid_.length(i);
    ode_.start_at(t);
    if (sampled_) ode_.hold(sampled_->over_tick(i, t, state_));
    if (sampled_ && sampled_->stopped_at() == i) outcome_.safe_stop_at = t;
    const double same = std::min(kSameTime * std::max(1.0, t), kSameCount * length);
    double begin = 0.0;  // since t, as the live plant counts
    auto cut = std::upper_bound(breakpoints_.begin(), breakpoints_.end(), t + same);
    while (begin < length) {
      double end = length;
      if (cut != breakpoints_.end() && *cut - t < length - same) end = *cut++ - t;
      if (end - begin <= same) continue;
      ode_.stay_within(t + 0.5 * (begin + end));
      if (!stepper_.advance(begin, end, y_)) return false;
      begin = end;
    }
    const model::State next = unpack(machine_, y_.data(), scenario_.start.rotor_speed);
    if (!next.finite()) return false;
    state_ = next;
    ode_.look(length, state_, law_memory());
    if (sampled_) sampled_->look(i, state_, ode_.input());
    return true;
  }

  const model::Machine& machine_;
  const Scenario& scenario_;
  Spectator& spectator_;
  const Grid grid_;
  const std::unique_ptr<Law> law_;  // of continuous feedback
  LoopOde ode_;
  Stepper stepper_;
  std::optional<SampledLoop> sampled_;
  std::vector<double> breakpoints_;
  std::vector<double> y_;
  model::State state_;
  Outcome outcome_;
};

}  // namespace

Outcome simulate(const Rig& rig, const model::Machine& machine, const Scenario& scenario,
                 Spectator& spectator) {
  return Run(rig, machine, scenario, spectator).go();
}

model::Machine with_ideal_drives(model::Machine machine) {
  for (model::Drive& drive : machine.drives) {
    drive.motor.reset();
    drive.torque_limit = std::numeric_limits<double>::infinity();
  }
  return machine;
}

}  // namespace gyrotwin
