// Distributions of durations, kept on the tick thread.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace gyrotwin {

/// Counts of nanoseconds in log-linear buckets: exact below 32 ns, then 32 buckets for each power
/// of two. Covers all of int64; never allocates.
class Histogram {
 public:
  /// Largest relative error of a percentile.
  static constexpr double kRelativeError = 1.0 / 32;

  /// A negative value counts as 0.
  void add(std::int64_t ns) noexcept {
    const std::int64_t value = std::max<std::int64_t>(ns, 0);
    ++buckets_[index_of(static_cast<std::uint64_t>(value))];
    ++count_;
    max_ = std::max(max_, value);
  }

  /// Smallest value that at least `percent` % of the values do not exceed, rounded up to the end of
  /// its bucket but never beyond max(); 0 when empty. @pre 0 <= percent <= 100
  std::int64_t percentile(double percent) const noexcept {
    const auto rank = std::clamp<std::int64_t>(
        std::llround(std::ceil(1e-2 * percent * static_cast<double>(count_))), 1, count_ + 1);
    std::int64_t seen = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      seen += buckets_[i];
      if (seen >= rank) return std::min(last_of(i), max_);
    }
    return max_;
  }

  std::int64_t max() const noexcept { return max_; }      ///< [ns], exact; 0 when empty
  std::int64_t count() const noexcept { return count_; }  ///< values added since clear()

  void clear() noexcept { *this = {}; }

 private:
  static constexpr int kBits = 5;  ///< of a value that its bucket tells, below the leading one
  static constexpr std::size_t kLinear = std::size_t{1} << kBits;
  static constexpr std::size_t kBuckets = kLinear * (63 - kBits + 1);

  /// Values below kLinear are their own index; from there each power of two takes kLinear buckets.
  static std::size_t index_of(std::uint64_t value) noexcept {
    if (value < kLinear) return value;
    const int shift = std::bit_width(value) - 1 - kBits;
    return kLinear * static_cast<std::size_t>(shift) + (value >> shift);
  }

  /// Largest value of bucket `index`.
  static std::int64_t last_of(std::size_t index) noexcept {
    if (index < kLinear) return static_cast<std::int64_t>(index);
    const std::size_t shift = index / kLinear - 1;
    const std::uint64_t mantissa = index - kLinear * shift;
    return static_cast<std::int64_t>(((mantissa + 1) << shift) - 1);
  }

  std::array<std::int64_t, kBuckets> buckets_{};
  std::int64_t count_ = 0;
  std::int64_t max_ = 0;
};

/// A histogram that is filled while the percentiles of the last full window are read. The owner of
/// the loop rolls it once a second of wall time.
class WindowedHistogram {
 public:
  /// Into the current window; a negative value counts as 0.
  void add(std::int64_t ns) noexcept { current_.add(ns); }

  /// The current window becomes the last full one, an empty one begins.
  void roll() noexcept {
    p50_ = current_.percentile(50);
    p99_ = current_.percentile(99);
    max_ = current_.max();
    current_.clear();
  }

  std::int64_t p50() const noexcept { return p50_; }  ///< [ns] of the last full window
  std::int64_t p99() const noexcept { return p99_; }  ///< [ns] of the last full window
  std::int64_t max() const noexcept { return max_; }  ///< [ns] of the last full window

 private:
  Histogram current_;
  std::int64_t p50_ = 0, p99_ = 0, max_ = 0;
};

}  // namespace gyrotwin
