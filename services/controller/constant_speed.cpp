#include "services/controller/constant_speed.hpp"

#include <cstdio>

namespace gyrotwin {

ConstantSpeed::ConstantSpeed(const Rig& rig)
    : disc_speed_(rig.controller.disc_speed.value()), loop_(rig.controller) {}

DriveTorques ConstantSpeed::torque(const model::Observation& seen,
                                   const LawState& z) const noexcept {
  return {loop_.torque(error(seen), z[0])};
}

LawState ConstantSpeed::rates(const model::Observation& seen, const LawState& z,
                              const DriveTorques& wanted,
                              const DriveTorques& given) const noexcept {
  return {loop_.rate(error(seen), z[0], wanted[0], given[0]), 0.0};
}

std::string ConstantSpeed::describe() const {
  char text[64];
  std::snprintf(text, sizeof text, "constant_speed: disc at %.4g rad/s, ", -disc_speed_);
  return text + loop_.describe();
}

}  // namespace gyrotwin
