// One point of the filter moved by the model: over a tick, and into what its sensors would say.
#pragma once

#include <Eigen/Core>

#include "services/mirror/readings.hpp"
#include "services/mirror/unknowns.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

class Prediction {
 public:
  using Point = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Deviations::kMaxColumns, 1>;

  /// @pre rig.sensors
  Prediction(const Rig& rig, const model::Machine& machine, const Unknowns& unknowns);

  /// What holds for all points of a tick.
  struct Tick {
    model::Input acting;
    model::RotorSpeeds rotor_speed{}, rotor_rate{};
  };
  /// `x` a tick later; its entries from Unknowns::dynamic on stay.
  void advance(const Tick& tick, Point& x) noexcept;
  /// What unbiased sensors would say of `x`, per channel of Readings.
  void sense(const Tick& tick, const Point& x, Channels& expected) noexcept;
  double tick_s() const noexcept { return tick_s_; }

 private:
  void set(const Tick& tick, const Point& x) noexcept;
  model::Coordinates accelerate(const model::State& state, const model::RotorSpeeds& rotor_rate,
                                model::Motion& motion) noexcept;
  void calm_down(const model::Motion& motion, const model::State& state,
                 model::Coordinates& acceleration) const noexcept;

  model::Machine machine_;  // of its own: each point has its own friction
  Unknowns unknowns_;
  double tick_s_;
  int substeps_;
  double coulomb_;          // the model's
  Eigen::Matrix3d to_imu_;  // IMU <- structure
  Eigen::Vector3d imu_position_;
  model::Input input_;                               // of the point at hand
  std::array<double, model::kMaxDrives> lightness_;  // of what the drives turn [1/(kg m^2)]
  double inertia_ = 0.0;            // added to the structure's by the point at hand [kg m^2]
  std::array<double, 2> moment_{};  // unknown, of the point at hand [N m]
};

}  // namespace gyrotwin
