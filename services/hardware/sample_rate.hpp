// How often a device samples, by its own stamps.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace gyrotwin {

/// The median over the last pieces of 20 ms: a pause of the device, or of the machine that emulates
/// one, spoils the piece it falls into and no other. Does not allocate.
class SampleRate {
 public:
  static constexpr std::int64_t kPiece = 20'000'000;  ///< [ns] of the device's clock, at least
  static constexpr std::size_t kFewest = 25;          ///< pieces before a rate is known

  /// @param tick number of the sample
  /// @param stamp its time by the device's clock [ns]
  void on_sample(std::int64_t tick, std::int64_t stamp) noexcept {
    if (!begun_ || tick <= tick_ || stamp <= stamp_) {
      begin(tick, stamp);
    } else if (stamp - stamp_ >= kPiece) {
      hz_[count_++ % hz_.size()] =
          1e9 * static_cast<double>(tick - tick_) / static_cast<double>(stamp - stamp_);
      begin(tick, stamp);
    }
  }

  /// Another device.
  void forget() noexcept {
    begun_ = false;
    count_ = 0;
  }

  bool known() const noexcept { return count_ >= kFewest; }
  /// Samples a second of the device's clock. @pre known()
  double hz() const noexcept {
    auto sorted = hz_;
    const auto size = static_cast<std::ptrdiff_t>(std::min(count_, sorted.size()));
    const auto middle = sorted.begin() + size / 2;
    std::nth_element(sorted.begin(), middle, sorted.begin() + size);
    return *middle;
  }

 private:
  void begin(std::int64_t tick, std::int64_t stamp) noexcept {
    begun_ = true;
    tick_ = tick;
    stamp_ = stamp;
  }

  bool begun_ = false;
  std::int64_t tick_ = 0, stamp_ = 0;  // where the present piece begins
  std::array<double, 64> hz_{};        // ring of pieces
  std::size_t count_ = 0;
};

}  // namespace gyrotwin
