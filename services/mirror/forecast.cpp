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
      course_(rig, kHorizon, step_) {
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
  lawful_ = busy_ = false;
  moments_known_ = 0;
  remembered_tick_ = 0;
  falls_in_row_ = shares_ = 0;
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
void Forecast::remember(const Estimate& estimate, const header_t& at, bool lawful) noexcept {
  const double tick = rig_.loop.tick_s();
  if (at.tick / moment_period_ != remembered_tick_ / moment_period_) {
    moments_[moments_known_ % kMoments] = estimate.external_moment;
    count_up(moments_known_, kMoments);
  }
  remembered_tick_ = at.tick;
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

bool Forecast::step(const Follower& follower, const header_t& at,
                    const model::State* stopped_from) noexcept {
  const bool lawful = stopped_from == nullptr;
  if (!follower.estimate().state.finite()) return false;
  remember(follower.estimate(), at, lawful);
  if (lawful != lawful_) {
    busy_ = false;
    falls_in_row_ = shares_ = 0;
    lawful_ = lawful;
  }
  const bool due = at.tick / period_ != at_.tick / period_;
  const bool told = busy_ && mean_known_ && due;
  if (told) conclude(at);
  if (!busy_) begin(follower, at, stopped_from);
  work();
  return told;
}

void Forecast::begin(const Follower& follower, const header_t& at,
                     const model::State* stopped_from) noexcept {
  const Estimate& estimate = follower.estimate();
  const Eigen::Vector2d lasting = lasting_moment();
  at_ = at;
  busy_ = true;
  mean_known_ = false;
  outset_ = {.state = estimate.state,
             .memory = memory_,
             .lawful = stopped_from == nullptr,
             .stopped_from = stopped_from ? *stopped_from : model::State(),
             .lasting_moment = lasting,
             .fading_moment = estimate.external_moment - lasting,
             .fade_s = settings_.fade_s,
             .disc_friction = estimate.disc_friction,
             .drive_strength = estimate.drive_strength};
  for (double& strength : outset_.drive_strength) strength = std::clamp(strength, 0.0, 1.0);

  const auto turn = static_cast<int>(kStarts * (at.tick / period_) % kDraws);
  const double* moments = normals_.data() + kDraws * follower.dimension();
  for (int i = 0; i < kStarts; ++i) {
    const int draw = (turn + i) % kDraws;
    starts_[i].state = follower.draw(draw, normals_);
    starts_[i].moment = {moments[2 * draw] * estimate.external_moment_sigma.x(),
                         moments[2 * draw + 1] * estimate.external_moment_sigma.y()};
  }
  started_ = 1;
  course_.begin(outset_);
  // Beyond the limit from the start on: there is nothing to advance.
  if (course_.over()) keep_mean();
}

void Forecast::keep_mean() noexcept {
  outcome_ = course_.outcome();
  mean_known_ = true;
}

void Forecast::begin_start(int index) noexcept {
  Outset outset = outset_;
  outset.state = starts_[index].state;
  outset.fading_moment += starts_[index].moment;
  course_.begin(outset);
}

/// A tick's portion: the estimate's course, then those of as many starts as there is time for.
void Forecast::work() noexcept {
  for (int i = 0; i < portion_; ++i) {
    if (course_.over()) {
      if (started_ > kStarts) return;
      begin_start(started_++ - 1);
    }
    if (course_.advance()) continue;
    if (started_ == 1) {
      keep_mean();
    } else {
      share_[shares_ % kShare] = course_.outcome().falls();
      count_up(shares_, kShare);
    }
  }
}

double Forecast::share() const noexcept {
  const int known = std::min(shares_, kShare);
  const auto fallen = std::count(share_.begin(), share_.begin() + known, true);
  return (static_cast<double>(fallen) + (outcome_.falls() ? 1.0 : 0.0)) / (known + 1.0);
}

void Forecast::conclude(const header_t& now) noexcept {
  falls_in_row_ = outcome_.falls() ? std::min(falls_in_row_ + 1, settings_.confirm) : 0;
  const bool falls = falls_in_row_ >= settings_.confirm;
  forecast_ = {};
  forecast_.header = at_;
  forecast_.header.sequence = now.tick / period_;
  forecast_.outcome = forecast_t::STANDS;
  if (falls) forecast_.outcome = forecast_t::FALLS;
  forecast_.law = outset_.lawful ? 1 : 0;
  forecast_.horizon_ns = nanoseconds(kHorizon);
  forecast_.falls_in_ns = falls ? nanoseconds(outcome_.fell_at) : -1;
  forecast_.peak_tilt_rad = outcome_.peak_tilt;
  forecast_.peak_in_ns = nanoseconds(outcome_.peak_at);
  forecast_.final_tilt_rad = outcome_.tilt;
  forecast_.tilt_margin_rad = rig_.safety.fall_tilt_rad - outcome_.peak_tilt;
  forecast_.gimbal_margin_rad = outcome_.gimbal_margin;
  forecast_.saturates_in_ns = nanoseconds(outcome_.saturated_at);
  forecast_.fall_probability = share();
  forecast_.age_ns = now.sim_time_ns - at_.sim_time_ns;
  busy_ = false;
}

}  // namespace gyrotwin
