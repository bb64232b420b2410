// Wrenches that operators have asked for, each from one tick to another.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>

#include "services/model/machine.hpp"

namespace gyrotwin {

/// Constant wrench on the structure over [begin, end), world frame, force at the push point.
struct Disturbance {
  static constexpr std::int64_t kForever = std::numeric_limits<std::int64_t>::max();
  Eigen::Vector3d force;   ///< [N]
  Eigen::Vector3d moment;  ///< [N m]
  std::int64_t begin;      ///< first tick it acts in
  std::int64_t end;        ///< first tick it no longer acts in
};

/// A fixed number of disturbances, so that nothing allocates.
class Disturbances {
 public:
  static constexpr int kCapacity = 32;

  /// @return false when all places are taken
  bool add(const Disturbance& disturbance) noexcept {
    if (count_ == kCapacity) return false;
    active_[count_++] = disturbance;
    return true;
  }

  void clear() noexcept { count_ = 0; }
  int count() const noexcept { return count_; }

  /// Adds what acts in `tick` to the input, in the order of asking, and forgets what is over.
  void apply(std::int64_t tick, model::Input& input) noexcept {
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const Disturbance& d = active_[i];
      if (d.begin <= tick && tick < d.end) {
        input.force += d.force;
        input.moment += d.moment;
      }
      if (tick + 1 < d.end) active_[kept++] = d;
    }
    count_ = kept;
  }

 private:
  std::array<Disturbance, kCapacity> active_;
  int count_ = 0;
};

}  // namespace gyrotwin
