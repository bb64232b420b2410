// What a bad line does to the bytes of one direction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>

namespace gyrotwin {

class LineDamage {
 public:
  explicit LineDamage(std::uint64_t seed) : random_(seed) {}

  bool silent = false;  ///< nothing arrives
  bool halves = false;  ///< frames lose their end, 0x00 included
  double flips = 0.0;   ///< share of bytes of which a bit is flipped

  /// Hands each byte that arrives to `arrive`.
  template <class Arrive>
  void pass(std::span<const std::uint8_t> bytes, Arrive&& arrive) {
    for (const std::uint8_t byte : bytes) {
      const bool cut = halves && place_ >= kept_;
      if (!silent && !cut) arrive(damaged(byte));
      if (byte != 0) {
        ++place_;
        continue;
      }
      place_ = 0;
      kept_ = std::uniform_int_distribution<std::size_t>(1, kShortestFrame)(random_);
    }
  }

 private:
  static constexpr std::size_t kShortestFrame = 160;  // bytes, about: a command's

  std::uint8_t damaged(std::uint8_t byte) {
    if (flips <= 0.0 || !std::bernoulli_distribution(flips)(random_)) return byte;
    const int bit = std::uniform_int_distribution<int>(0, 7)(random_);
    return static_cast<std::uint8_t>(byte ^ (1u << bit));
  }

  std::mt19937_64 random_;
  std::size_t place_ = 0;  // in the present frame
  std::size_t kept_ = 1;   // bytes of it that arrive under `halves`
};

}  // namespace gyrotwin
