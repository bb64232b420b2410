#include "services/runtime/pacer.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

Pacer::Pacer(std::int64_t period_ns, OverrunPolicy policy, std::int64_t spin_ns)
    : period_(period_ns), wall_period_(period_ns), policy_(policy), spin_(spin_ns) {}

void Pacer::anchor(std::int64_t now_ns) noexcept { deadline_ = now_ns + wall_period_; }

void Pacer::set_speed(double factor, std::int64_t now_ns) noexcept {
  speed_ = factor;
  wall_period_ = std::max<std::int64_t>(1, std::llround(static_cast<double>(period_) / factor));
  anchor(now_ns);
}

std::int64_t Pacer::wake() const noexcept { return deadline_ - std::min(spin_, wall_period_ / 2); }

void Pacer::give_up_until(std::int64_t now_ns) noexcept {
  skipped_ += std::max<std::int64_t>(0, now_ns - deadline_) / wall_period_;
  anchor(now_ns);
}

bool Pacer::begin(std::int64_t now_ns) noexcept {
  const std::int64_t late = now_ns - deadline_;
  lateness_.add(late);
  deadline_ += wall_period_;
  if (late <= wall_period_) return true;

  // Under kStop the deadline leaps as well: a stopped plant goes on moving at its own pace.
  const std::int64_t gone_by = late / wall_period_;
  deadline_ += gone_by * wall_period_;
  skipped_ += gone_by;
  ++overruns_;
  return policy_ != OverrunPolicy::kStop;
}

}  // namespace gyrotwin
