#include "clients/plot/scale.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gyrotwin {

namespace {

constexpr double kAir = 0.04;  // left free beyond the data, as a share

double nice_step(double rough) {
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double share = rough / power;
  return power * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
}

}  // namespace

Scale::Scale(const Axis& axis, std::span<const double> data, double first, double last)
    : logarithmic_(axis.logarithmic), first_(first), last_(last) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double x : data) {
    if (!std::isfinite(x) || (logarithmic_ && x <= 0.0)) continue;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  if (low > high) low = high = logarithmic_ ? 1.0 : 0.0;
  const bool flat = high - low <= 1e-12 * std::max(std::abs(low), std::abs(high));
  if (logarithmic_) {
    low_ = axis.low.value_or(flat ? low / 2.0 : low);
    high_ = axis.high.value_or(flat ? high * 2.0 : high);
    return;
  }
  const double air = flat ? std::max(0.5 * std::abs(low), 0.5) : kAir * (high - low);
  low_ = axis.low.value_or(low - air);
  high_ = axis.high.value_or(high + air);
  if (high_ <= low_) high_ = low_ + 1.0;
}

double Scale::pixel(double value) const {
  const auto at = [this](double x) { return logarithmic_ ? std::log10(x) : x; };
  return first_ + (at(value) - at(low_)) / (at(high_) - at(low_)) * (last_ - first_);
}

std::vector<double> Scale::ticks(int wanted) const {
  std::vector<double> ticks;
  if (logarithmic_) {
    const int begin = static_cast<int>(std::ceil(std::log10(low_) - 1e-9));
    const int end = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
    const int step = std::max(1, (end - begin) / std::max(wanted, 1));
    for (int power = begin; power <= end; power += step) ticks.push_back(std::pow(10.0, power));
    if (ticks.size() < 2) ticks = {low_, high_};
    return ticks;
  }
  const double step = nice_step((high_ - low_) / wanted);
  const auto begin = std::llround(std::ceil(low_ / step - 1e-9));
  const auto end = std::llround(std::floor(high_ / step + 1e-9));
  for (auto i = begin; i <= end; ++i) ticks.push_back(i == 0 ? 0.0 : static_cast<double>(i) * step);
  return ticks;
}

std::string tick_label(double value, double step) {
  const double size = std::max(std::abs(value), std::abs(step));
  if (value == 0.0) return "0";
  if (size >= 1e5 || step < 1e-4) return fmt::format("{:.3g}", value);
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  return fmt::format("{:.{}f}", value, digits);
}

}  // namespace gyrotwin
