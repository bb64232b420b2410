// A plant under its law as one vector: what steady motions and modes are computed with.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "services/controller/law.hpp"
#include "services/model/machine.hpp"

namespace gyrotwin {

/// d f / d x by central differences, a column for each entry of x.
Eigen::MatrixXd slopes(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f,
                       const Eigen::VectorXd& x);

/// Coordinates without the cyclic one (the disc's angle, on which nothing depends), all rates; and
/// what the law remembers.
class Loop {
 public:
  static constexpr double kStep = 1e-6;  ///< of differences [rad], [rad/s]

  /// @param law null: the drives give nothing; both outlive this object
  Loop(const model::Machine& machine, const Law* law);

  int cyclic() const { return machine_.layout.disc; }
  int coordinates() const { return machine_.coordinates(); }
  /// The coordinates that are states.
  const std::vector<int>& positions() const { return positions_; }
  Eigen::Index plant_size() const { return std::ssize(positions_) + coordinates(); }
  Eigen::Index memory_size() const { return law_ != nullptr ? law_->states() : 0; }

  Eigen::VectorXd pack(const model::State& state) const;
  /// @param like tells the cyclic coordinate and the rotor speeds
  model::State unpack(const Eigen::VectorXd& x, const model::State& like) const;

  /// Of the law, within what the drives can give [N m].
  DriveTorques torque(const model::State& state, const LawState& z) const;
  LawState memory_rate(const model::State& state, const LawState& z) const;
  /// With the law's torque [rad/s^2].
  model::Coordinates acceleration(const model::State& state, const LawState& z) const;

 private:
  const model::Machine& machine_;
  const Law* law_;
  std::vector<int> positions_;
};

}  // namespace gyrotwin
