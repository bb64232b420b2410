// A control law: what the drives shall do, from what is seen. One file a law beside this one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>

#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

inline constexpr int kMaxLawStates = 2;

/// A law's memory (integrals, filters); entries beyond Law::states() are 0.
using LawState = Eigen::Matrix<double, kMaxLawStates, 1>;

/// Torques per drive [N m]; unused drives 0.
using DriveTorques = std::array<double, model::kMaxDrives>;

/// A law is two pure functions, so the same object serves sampled feedback (the controller steps
/// its memory once a tick) and continuous feedback (the memory is integrated with the plant).
class Law {
 public:
  virtual ~Law() = default;
  /// How many entries of LawState it uses.
  virtual int states() const noexcept { return 0; }
  /// Memory to start with when the platform is armed in this state.
  virtual LawState start(const model::Observation&) const noexcept { return LawState::Zero(); }
  /// Torque that it wants, before any limit [N m].
  virtual DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept = 0;
  /// z' [unit of z per s], given what was wanted and what the drives can give (anti-windup) [N m].
  virtual LawState rates(const model::Observation&, const LawState&, const DriveTorques& /*wanted*/,
                         const DriveTorques& /*given*/) const noexcept {
    return LawState::Zero();
  }
  /// One line for the log: name, gains, closed-loop poles where it has computed them.
  virtual std::string describe() const = 0;
};

/// What the machine's drives can give of `wanted` [N m] in the state that is seen: within the motor
/// lines and the rig's torque limits.
DriveTorques within_limits(const model::Machine& machine, const model::Observation& seen,
                           const DriveTorques& wanted) noexcept;

/// The law that the rig's [controller] names, null for LawKind::kNone.
/// @throws Error when the law does not fit the machine or a number it needs is missing
std::unique_ptr<Law> make_law(const Rig& rig);

/// Sampled feedback: the law's memory, the drives' limits, one step a tick.
class SampledLaw {
 public:
  /// @param machine the rig's; must outlive this object
  /// @throws Error as make_law()
  SampledLaw(const Rig& rig, const model::Machine& machine);
  /// Forgets: to be called before the first tick after arming.
  void reset(const model::Observation& seen) noexcept;
  /// Torques [N m] for one tick of the rig's length, within what the drives can give. Zero, and the
  /// memory kept, when something seen is not finite; zero for LawKind::kNone.
  DriveTorques step(const model::Observation& seen) noexcept;
  const Law* law() const { return law_.get(); }

 private:
  std::unique_ptr<Law> law_;
  const model::Machine& machine_;
  double tick_s_;
  LawState z_ = LawState::Zero();
};

}  // namespace gyrotwin
