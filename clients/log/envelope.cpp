#include "clients/log/envelope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gyrotwin {

void Envelope::add(double x, double y) {
  if (!std::isfinite(y)) {
    if (!stretches_.empty()) stretches_.back().ends = true;
    return;
  }
  if (stretches_.empty()) begin_ = x;
  while ((x - begin_) / width_ >= static_cast<double>(most_)) widen();
  const auto index = static_cast<std::size_t>(std::max(0.0, (x - begin_) / width_));
  const Point point{x, y};
  const Stretch stretch{index, point, point, point, point};
  if (stretches_.empty() || index > stretches_.back().index) {
    stretches_.push_back(stretch);
  } else {
    join(stretches_.back(), stretch);
  }
}

bool Envelope::is_zero() const {
  return std::ranges::all_of(
      stretches_, [](const Stretch& part) { return part.low.y == 0.0 && part.high.y == 0.0; });
}

Envelope::Points Envelope::points() const {
  Points all;
  const auto put = [&all](const Point& point) {
    all.x.push_back(point.x);
    all.y.push_back(point.y);
  };
  for (const Stretch& part : stretches_) {
    const bool low_first = part.low.x <= part.high.x;
    put(part.first);
    put(low_first ? part.low : part.high);
    put(low_first ? part.high : part.low);
    put(part.last);
    if (part.ends) put({part.last.x, std::numeric_limits<double>::quiet_NaN()});
  }
  return all;
}

void Envelope::join(Stretch& to, const Stretch& behind) {
  if (behind.low.y < to.low.y) to.low = behind.low;
  if (behind.high.y > to.high.y) to.high = behind.high;
  to.last = behind.last;
  to.ends = to.ends || behind.ends;
}

void Envelope::widen() {
  width_ *= 2.0;
  std::vector<Stretch> wider;
  for (Stretch& part : stretches_) {
    part.index /= 2;
    if (wider.empty() || part.index > wider.back().index) {
      wider.push_back(part);
    } else {
      join(wider.back(), part);
    }
  }
  stretches_ = std::move(wider);
}

}  // namespace gyrotwin
