// Random numbers without memory: each is a function of its seed, stream and index, so that noise
// does not depend on who else draws, in what order, or what was skipped.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace gyrotwin {

namespace detail {

/// SplitMix64's finaliser (Steele, Lea and Flood 2014; constants by Stafford): every bit of the
/// result hangs on every bit of `x`.
constexpr std::uint64_t mixed(std::uint64_t x) noexcept {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// 2^-53 to 1.
constexpr double unit(std::uint64_t bits) noexcept {
  return 0x1p-53 * static_cast<double>((bits >> 11) + 1);
}

constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;  // odd, 2^64 over the golden ratio

constexpr std::uint64_t key(std::uint64_t seed, std::uint64_t stream,
                            std::uint64_t index) noexcept {
  return mixed(mixed(mixed(seed + kStep) + stream + kStep) + index + kStep);
}

}  // namespace detail

// Draws that differ in `seed`, `stream` or `index` are independent.

/// A draw from the uniform distribution over 0 to 1; never 0.
constexpr double uniform(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept {
  return detail::unit(detail::mixed(detail::key(seed, stream, index) + detail::kStep));
}

/// A draw from the normal distribution of mean 0 and variance 1, by Box and Muller's transform.
inline double normal(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept {
  using detail::kStep, detail::mixed, detail::unit;
  const std::uint64_t key = detail::key(seed, stream, index);
  const double radius = std::sqrt(-2.0 * std::log(unit(mixed(key + kStep))));
  return radius * std::cos(2.0 * std::numbers::pi * unit(mixed(key + 2 * kStep)));
}

}  // namespace gyrotwin
