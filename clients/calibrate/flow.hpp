// Where a state goes, and how that hangs on where it started and on the parameters: the machine's
// equations with their forward sensitivities, by SUNDIALS CVODES.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "clients/calibrate/family.hpp"
#include "services/model/machine.hpp"

namespace gyrotwin::calibration {

/// Derivatives of packed rates (see pack() in services/integrator/plant.hpp).
struct RateDerivatives {
  Eigen::MatrixXd by_state;      ///< square; by q and q' exactly, by dual numbers
  Eigen::MatrixXd by_parameter;  ///< a column a parameter, by central differences of the model
};

/// @param held_rotor_speed what a machine without a rotor_drive keeps [rad/s]
RateDerivatives rate_derivatives(const Neighbourhood& around, const Eigen::VectorXd& y,
                                 const model::Input& input,
                                 const model::RotorSpeeds& held_rotor_speed);

/// One solution y' = f(y, u, x), u piecewise constant. With derivatives also
///     S = dy / d(y0, x),   S' = f_y S + (0, f_x),   S(0) = (1, 0).
class Flow {
 public:
  /// Of the local error of a state's entry [1] and [rad, rad/s]: far below what sensors tell, also
  /// of angles that have gone far. The sensitivities go along at the same steps.
  static constexpr double kRelative = 1e-9;
  static constexpr double kAbsolute = 1e-8;

  /// @param around outlives the flow; with neighbours where derivatives are wanted
  /// @throws Error when SUNDIALS cannot be set up
  Flow(const Neighbourhood& around, const model::RotorSpeeds& held_rotor_speed,
       const Eigen::VectorXd& start, bool derivatives);
  ~Flow();
  Flow(const Flow&) = delete;
  Flow& operator=(const Flow&) = delete;

  /// Goes on by `dt` [s] under an input that will last for `lasts` [s] at least. Where the input is
  /// another one than before, the method starts anew: nothing is smooth there.
  /// @return whether it got there
  bool advance(const model::Input& input, double dt, double lasts);

  const Eigen::VectorXd& state() const;
  /// S, size of the state times (that size + parameters).
  const Eigen::MatrixXd& sensitivity() const;
  /// The state in the model's words.
  model::State unpacked() const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

/// Whether two inputs act alike.
bool alike(const model::Input& a, const model::Input& b);

}  // namespace gyrotwin::calibration
