#include "services/mirror/sensor_judge.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

namespace {

// Ticks without a reading that make a sensor silent; insane readings on end that make it insane.
constexpr int kSilent = 20, kInsane = 3;

// Stuck for so many ticks: a late encoder may stand still for a moment when the disc turns back.
constexpr int kStuck = 20;

// The limit of the mean NIS: so many of its standard deviations above 1, but no closer than this.
constexpr double kSigmas = 8.0, kLeastLimit = 1.5;

// A disagreement is over below this share of the way from 1 to the limit.
constexpr double kOver = 0.5;

// One reading counts at most so much: a single one does not make a disagreement.
constexpr double kWorst = 25.0;

// A delay explains a disagreement when it leaves this share of the misfit.
constexpr double kExplained = 0.4;
constexpr int kLeastLag = 3;

// A verdict is taken back after this time [s].
constexpr double kForgiving = 0.3;

}  // namespace

SensorJudge::SensorJudge(const Imperfection& imperfection, int channels, double tick_s)
    : channels_(channels),
      share_(tick_s / kWindow),
      patience_(static_cast<int>(kForgiving / tick_s)) {
  const double noise = imperfection.noise, resolution = imperfection.resolution;
  variance_ = std::max(noise * noise + resolution * resolution / 12.0, 1e-12);
  const double independent = (2.0 - share_) / share_ * std::max(channels, 1);
  limit_ = std::max(kLeastLimit, 1.0 + kSigmas * std::sqrt(2.0 / independent));
  reset();
}

void SensorJudge::reset() noexcept {
  nis_ = 1.0;
  square_ = 0.0;
  silent_ = insane_ = stuck_ = good_ = 0;
  past_ = {};
  lag_misfit_.fill(0.0);
  ticks_ = 0;
  late_by_ = 0;
  verdict_ = channels_ == 0 ? +health_t::NONE : +health_t::AGREES;
}

double SensorJudge::rms() const noexcept { return std::sqrt(square_); }

/// How well the reading fits what was expected some ticks ago.
void SensorJudge::compare_with_past(const double* value, const Innovation& innovation) noexcept {
  past_[static_cast<std::size_t>(ticks_ % kLags)] = innovation.expected;
  for (int lag = 0; lag < kLags; ++lag) {
    const auto& then = past_[static_cast<std::size_t>((ticks_ + kLags - lag) % kLags)];
    double sum = 0.0;
    for (int i = 0; i < channels_; ++i) sum += (value[i] - then[i]) * (value[i] - then[i]);
    lag_misfit_[lag] += share_ * (sum / (channels_ * variance_) - lag_misfit_[lag]);
  }
}

/// @return ticks by which the sensor is late; 0: it is not, or that would explain nothing
int SensorJudge::best_lag() const noexcept {
  if (ticks_ < 2 * kLags) return 0;
  const auto best = std::min_element(lag_misfit_.begin(), lag_misfit_.end());
  const int lag = static_cast<int>(best - lag_misfit_.begin());
  const bool explains = *best < kExplained * lag_misfit_[0];
  return lag >= kLeastLag && lag < kLags - 1 && explains ? lag : 0;
}

/// What is wrong at this tick; AGREES: nothing.
std::int32_t SensorJudge::seen(bool heard, const double* value, const Innovation& innovation,
                               bool biased) noexcept {
  silent_ = heard ? 0 : std::min(silent_ + 1, kSilent);
  insane_ = innovation.insane ? std::min(insane_ + 1, kInsane) : 0;
  stuck_ = innovation.stuck ? std::min(stuck_ + 1, kStuck) : 0;
  if (silent_ >= kSilent) return health_t::SILENT;
  if (insane_ >= kInsane) return health_t::INSANE;
  if (stuck_ >= kStuck) return health_t::STUCK;
  if (innovation.channels != channels_) return verdict_;  // too little to judge by

  double square = 0.0;
  for (int i = 0; i < channels_; ++i) {
    square += innovation.value[i] * innovation.value[i] / channels_;
  }
  square_ += share_ * (square - square_);
  nis_ += share_ * (std::min(innovation.nis / channels_, kWorst) - nis_);
  compare_with_past(value, innovation);
  ++ticks_;

  const bool before = verdict_ == health_t::DISAGREES || verdict_ == health_t::LATE;
  if (nis_ > (before ? 1.0 + kOver * (limit_ - 1.0) : limit_)) {
    const int lag = best_lag();
    if (lag > 0) late_by_ = lag;
    return lag > 0 ? +health_t::LATE : +health_t::DISAGREES;
  }
  return biased ? +health_t::DISAGREES : +health_t::AGREES;
}

void SensorJudge::take(bool heard, const double* value, const Innovation& innovation,
                       bool biased) noexcept {
  if (channels_ == 0) return;
  const std::int32_t now = seen(heard, value, innovation, biased);
  good_ = now == health_t::AGREES ? std::min(good_ + 1, patience_) : 0;
  if (now == health_t::DISAGREES && verdict_ == health_t::LATE) return;
  if (now != health_t::AGREES || good_ >= patience_) verdict_ = now;
}

}  // namespace gyrotwin
