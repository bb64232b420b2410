#include "services/mirror/forecast.hpp"

#include <algorithm>
#include <cmath>

#include "services/onboard/noise.hpp"

namespace gyrotwin {

namespace {

constexpr std::uint64_t kSeed = 1;  // of the starts

std::int64_t nanoseconds(double seconds) {
  return seconds < 0.0 ? -1 : std::llround(1e9 * seconds);
}

/// Counts what went into a ring. From `size` on only its place is kept, modulo `size`: the count
/// never overflows.
void count_up(int& count, int size) noexcept {
  if (++count == 2 * size) count = size;
}

}  // namespace

Forecast::Forecast(const Rig& rig, const model::Machine& machine, const ForecastSettings& settings)
    : rig_(rig),
      machine_(machine),
      settings_(settings),
      law_(make_law(rig)),
      step_(coarsest_step(rig)),
      period_(std::max<std::int64_t>(1, std::llround(1.0 / (kRate * rig.loop.tick_s())))),
      portion_(
          static_cast<int>(std::ceil(kCourses * kHorizon / step_ / static_cast<double>(period_)))),
      normals_(static_cast<std::size_t>(kDraws) * (2 * machine.coordinates() + 2)),
      moment_period_(std::max<std::int64_t>(
          1, std::llround(settings.lasting_s / (kMoments - 1) / rig.loop.tick_s()))),
      course_(rig, kHorizon, step_),
      start_course_(rig, kHorizon, step_) {
  // In pairs of opposites, so that their mean is the estimate.
  const std::size_t width = normals_.size() / kDraws;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    for (std::size_t i = 0; i < width; ++i) {
      const double x = normal(kSeed, draw / 2, i);
      const std::size_t place = i < width - 2 ? draw * (width - 2) + i
                                              : kDraws * (width - 2) + 2 * draw + i - (width - 2);
      normals_[place] = draw % 2 == 0 ? x : -x;
    }
  }
}

void Forecast::reset() noexcept {
  lawful_ = false;
  busy_ = starting_ = false;
  forecast_.header.sequence = -1;
  shares_ = draw_ = 0;
  falls_since_ns_ = -1;
  alarmed_ = false;
  moments_known_ = 0;
  now_ = {};
}

/// What has acted all the time lately, in each direction: the least of it. A push, and what the
/// filter makes of it while it comes to terms with it, is none of that.
Eigen::Vector2d Forecast::lasting_moment() const noexcept {
  Eigen::Vector2d lasting = Eigen::Vector2d::Zero();
  if (moments_known_ < kMoments) return lasting;
  for (int axis = 0; axis < 2; ++axis) {
    double low = moments_[0][axis], high = low;
    for (const Eigen::Vector2d& moment : moments_) {
      low = std::min(low, moment[axis]);
      high = std::max(high, moment[axis]);
    }
    lasting[axis] = low > 0.0 ? low : std::min(high, 0.0);
  }
  return lasting;
}

/// What the present alone does not tell: the law's memory, and for how long a moment has acted.
void Forecast::remember(const Estimate& estimate, bool lawful) noexcept {
  const double tick = rig_.loop.tick_s();
  if (!law_) return;
  const model::Observation seen = machine_.observe(estimate.state);
  // A law that begins to act, in another run as well, remembers nothing.
  if (!lawful || !lawful_) {
    memory_ = law_->start(seen);
  } else if (law_->states() > 0) {
    const DriveTorques wanted = law_->torque(seen, memory_);
    memory_ += tick * law_->rates(seen, memory_, wanted, within_limits(machine_, seen, wanted));
  }
}

void Forecast::follow(const Estimate& estimate, const header_t& at,
                      const model::State* stopped_from) noexcept {
  if (!estimate.state.finite()) return;
  if (at.tick / moment_period_ != now_.tick / moment_period_) {
    moments_[moments_known_ % kMoments] = estimate.external_moment;
    count_up(moments_known_, kMoments);
  }
  now_ = at;
  const bool lawful = stopped_from == nullptr;
  remember(estimate, lawful);
  if (!lawful) stopped_from_ = *stopped_from;
  if (lawful == lawful_) return;
  alarmed_ = false;
  break_off();
  lawful_ = lawful;
}

void Forecast::break_off() noexcept {
  busy_ = starting_ = false;
  shares_ = 0;
  falls_since_ns_ = -1;
}

/// A tick's portion: the estimate's course, then those of as many starts as there is time for.
bool Forecast::work(const Follower& follower) noexcept {
  if (!follower.estimate().state.finite()) return false;
  if (!busy_ && now_.tick / period_ != forecast_.header.sequence) {
    at_ = now_;
    course_.begin(outset(follower.estimate()));
    busy_ = true;
  }
  bool told = false;
  for (int i = 0; i < portion_; ++i) {
    if (busy_) {
      if (course_.advance()) continue;
      conclude(course_.outcome());
      told = true;
    } else if (!advance_start(follower)) {
      break;
    }
  }
  return told;
}

Outset Forecast::outset(const Estimate& estimate) const noexcept {
  const Eigen::Vector2d lasting = lasting_moment();
  Outset outset{.state = estimate.state,
                .memory = memory_,
                .lawful = lawful_,
                .stopped_from = stopped_from_,
                .lasting_moment = lasting,
                .fading_moment = estimate.external_moment - lasting,
                .fade_s = settings_.fade_s,
                .disc_friction = estimate.disc_friction,
                .drive_strength = estimate.drive_strength};
  for (double& strength : outset.drive_strength) strength = std::clamp(strength, 0.0, 1.0);
  return outset;
}

/// A step of a start's course, which goes on over the next forecasts until it is over.
/// @return false: it is over. To draw another costs more than steps do: that is left to the next
/// tick
bool Forecast::advance_start(const Follower& follower) noexcept {
  if (!starting_) begin_start(follower);
  starting_ = start_course_.advance();
  if (starting_) return true;
  share_[shares_ % kShare] = start_course_.outcome().falls();
  count_up(shares_, kShare);
  return false;
}

void Forecast::begin_start(const Follower& follower) noexcept {
  const Estimate& estimate = follower.estimate();
  const double* moment = normals_.data() + kDraws * follower.dimension() + 2 * draw_;
  Outset start = outset(estimate);
  start.state = follower.draw(draw_, normals_);
  start.fading_moment.x() += moment[0] * estimate.external_moment_sigma.x();
  start.fading_moment.y() += moment[1] * estimate.external_moment_sigma.y();
  draw_ = (draw_ + 1) % kDraws;
  start_course_.begin(start);
}

/// Of the estimate's course and the last starts', those that fall.
double Forecast::share(bool falls) const noexcept {
  const int known = std::min(shares_, kShare);
  const auto fallen = std::count(share_.begin(), share_.begin() + known, true);
  return (static_cast<double>(fallen) + (falls ? 1.0 : 0.0)) / (known + 1.0);
}

/// The more time is left, the longer an alarm may wait to be sure.
void Forecast::watch(const Outcome& outcome) noexcept {
  if (!outcome.falls()) {
    falls_since_ns_ = -1;
    alarmed_ = false;
    return;
  }
  if (falls_since_ns_ < 0) falls_since_ns_ = at_.sim_time_ns;
  const double wait = std::max(settings_.confirm_s, settings_.patience * outcome.fell_at);
  alarmed_ |= at_.sim_time_ns - falls_since_ns_ >= nanoseconds(wait);
}

void Forecast::conclude(const Outcome& outcome) noexcept {
  busy_ = false;
  watch(outcome);
  forecast_ = {};
  forecast_.header = at_;
  forecast_.header.sequence = at_.tick / period_;
  forecast_.outcome = forecast_t::STANDS;
  if (alarmed_) forecast_.outcome = forecast_t::FALLS;
  forecast_.law = lawful_ ? 1 : 0;
  forecast_.horizon_ns = nanoseconds(kHorizon);
  forecast_.falls_in_ns = alarmed_ ? nanoseconds(outcome.fell_at) : -1;
  forecast_.peak_tilt_rad = outcome.peak_tilt;
  forecast_.peak_in_ns = nanoseconds(outcome.peak_at);
  forecast_.final_tilt_rad = outcome.tilt;
  forecast_.tilt_margin_rad = rig_.safety.fall_tilt_rad - outcome.peak_tilt;
  forecast_.gimbal_margin_rad = outcome.gimbal_margin;
  forecast_.saturates_in_ns = nanoseconds(outcome.saturated_at);
  forecast_.fall_probability = share(outcome.falls());
  forecast_.age_ns = now_.sim_time_ns - at_.sim_time_ns;
}

}  // namespace gyrotwin
