// Open loop: the drives follow a wave in time, whatever the platform does.
#pragma once

#include "services/controller/law.hpp"

namespace gyrotwin {

/// tau = a sin(2 pi f t + p), or a sign(sin(2 pi f t + p)) as from a relay, the same for each
/// drive; t from arming is the law's memory. An amplitude that no drive can give means: all it can.
class OpenLoop final : public Law {
 public:
  /// @pre the rig has the law's numbers
  explicit OpenLoop(const Rig& rig);

  int states() const noexcept override { return 1; }
  DriveTorques torque(const model::Observation& seen, const LawState& t) const noexcept override;
  LawState rates(const model::Observation&, const LawState&, const DriveTorques&,
                 const DriveTorques&) const noexcept override {
    return {1.0, 0.0};
  }
  std::string describe() const override;

 private:
  Wave wave_;
  double amplitude_;  // a [N m]
  double frequency_;  // f [Hz]
  double phase_;      // p [rad]
  std::size_t drives_;
};

}  // namespace gyrotwin
