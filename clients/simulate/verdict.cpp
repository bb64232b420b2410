#include "clients/simulate/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "clients/common/tilt.hpp"

namespace gyrotwin {

namespace {

constexpr double kEarlierPart = 0.8;  // of the run
constexpr double kClearly = 0.01;     // more, as a share
constexpr double kNothing = 1e-9;     // that rounding alone may make [rad]
constexpr double kEnd = 0.1;          // of the run, in which what lasts is seen
constexpr double kLongestEnd = 2.0;   // [s]
constexpr double kMostly = 0.5;       // of the last part in a stop
const double kUpright = radians(1.0);

template <class... Args>
std::string print(const char* format, Args... args) {
  char text[160];
  std::snprintf(text, sizeof text, format, args...);
  return text;
}

}  // namespace

Verdict::Verdict(const Rig& rig, const model::Machine& machine, double duration, bool random)
    : has_tilt_(machine.layout.tilts() > 0),
      stops_carry_(has_tilt_ && (machine.track || machine.layout.disc == model::kFixed)),
      random_(random),
      limit_(has_tilt_ ? rig.safety.fall_tilt_rad : 0.0),
      duration_(duration) {}

void Verdict::note(double t, const model::Machine& machine, const model::State& state) noexcept {
  const double before = tilt_;
  tilt_ = machine.tilt(state);
  const double margin = machine.gimbal_margin(state);
  const double measure = has_tilt_ ? tilt_ : -margin;
  if (!fell_at_ && measure > limit_) {
    const bool crossed = has_tilt_ && before < limit_ && t > t_;
    fell_at_ = crossed ? t_ + (limit_ - before) / (tilt_ - before) * (t - t_) : t;
  }
  if (t > duration_ - std::min(kEnd * duration_, kLongestEnd)) {
    late_ += t - t_;
    if (margin <= 0.0) in_stop_ += t - t_;
  }
  t_ = t;
  double& largest = t <= kEarlierPart * duration_ ? earlier_ : later_;
  largest = std::max(largest, measure);
}

double Verdict::largest_tilt() const noexcept {
  return has_tilt_ ? std::max(earlier_, later_) : 0.0;
}
double Verdict::least_margin() const noexcept { return -std::max(earlier_, later_); }

bool Verdict::leans() const noexcept {
  return stops_carry_ && !fell_at_ && tilt_ > kUpright && in_stop_ > kMostly * late_;
}

bool Verdict::growing() const noexcept {
  return !random_ && later_ > earlier_ + kClearly * std::abs(earlier_) + kNothing;
}

std::string Verdict::leaning_text() const {
  return print("leans on its gimbal stops at %.3g deg", degrees(tilt_));
}

std::string Verdict::text() const {
  if (!has_tilt_) {
    if (fell_at_) return print("meets its stop: a gimbal reaches it at %.3f s", *fell_at_);
    return print("keeps off its stops%s: %.3g deg away at the closest%s",
                 growing() ? " so far" : "", degrees(least_margin()),
                 growing() ? ", and still closing in" : "");
  }
  if (fell_at_) {
    return print("falls: tilt beyond %.1f deg (safety.fall_tilt_rad) at %.3f s", degrees(limit_),
                 *fell_at_);
  }
  if (leans()) return leaning_text() + print(": tilt at most %.3g deg", degrees(largest_tilt()));
  return print("stands%s: tilt at most %.3g deg, %.3g deg at the end%s", growing() ? " so far" : "",
               degrees(largest_tilt()), degrees(tilt_), growing() ? ", and growing" : "");
}

}  // namespace gyrotwin
