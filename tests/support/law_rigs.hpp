// Rigs with a law each, for tests: machines of tests/data/reference, numbers of
// services/controller/README.md. Link gyrotwin_reference_data.
#pragma once

#include <string>

#include "services/runtime/rig.hpp"
#include "tests/support/reference_data.hpp"

namespace gyrotwin::reference {

inline Rig rig_of(const std::string& set, LawKind law) {
  Rig rig;
  rig.file = "example.toml";
  rig.machine = umbrella(set);
  std::get<model::UmbrellaParameters>(rig.machine).drive.torque_limit = 12.0;
  rig.controller.law = law;
  return rig;
}

inline Rig constant_speed() {
  Rig rig = rig_of("prototype_b", LawKind::kConstantSpeed);
  rig.controller.disc_speed = 5.0;
  rig.controller.kp = 3.0;
  rig.controller.ki = 6.0;
  rig.controller.integral_limit = 3.0;
  return rig;
}

inline Rig momentum_manager() {
  Rig rig = rig_of("prototype_b", LawKind::kMomentumManager);
  rig.controller.disc_speed = 5.0;
  rig.controller.momentum_rate = 5.0;
  return rig;
}

inline Rig reduced_lqr(const std::string& set, double disc_speed, double tilt_max,
                       double speed_max) {
  Rig rig = rig_of(set, LawKind::kReducedLqr);
  rig.controller.disc_speed = disc_speed;
  rig.controller.tilt_max = tilt_max;
  rig.controller.speed_max = speed_max;
  rig.controller.torque_max = 2.0;
  return rig;
}

inline Rig precession_lqr(const std::string& set, double tilt_max, double gimbal_max,
                          double torque_max) {
  Rig rig;
  rig.file = "example.toml";
  rig.machine = gimballed(set);
  rig.controller.law = LawKind::kPrecessionLqr;
  rig.controller.tilt_max = tilt_max;
  rig.controller.gimbal_max = gimbal_max;
  rig.controller.torque_max = torque_max;
  return rig;
}

/// The rig's machine, driven blindly.
inline Rig open_loop(Rig rig, Wave wave, double amplitude, double frequency) {
  rig.controller.law = LawKind::kOpenLoop;
  rig.controller.wave = wave;
  rig.controller.amplitude = amplitude;
  rig.controller.frequency = frequency;
  return rig;
}

inline Rig tilt_to_speed() {
  Rig rig = constant_speed();
  rig.controller.law = LawKind::kTiltToSpeed;
  rig.controller.disc_speed = 1.0;
  rig.controller.tilt_speed_gain = 40.0;
  rig.controller.rate_speed_gain = 4.0;
  rig.controller.speed_limit = 20.0;
  return rig;
}

inline Rig precession(const std::string& set, double tilt_gain, double gimbal_damping,
                      double gimbal_gain) {
  Rig rig;
  rig.file = "example.toml";
  rig.machine = gimballed(set);
  rig.controller.law = LawKind::kPrecession;
  rig.controller.tilt_gain = tilt_gain;
  rig.controller.gimbal_damping = gimbal_damping;
  rig.controller.gimbal_gain = gimbal_gain;
  return rig;
}

inline Rig shelf(const std::string& set, double torque, double tilt, double gimbal_damping,
                 double gimbal_gain) {
  Rig rig = precession(set, 0.0, gimbal_damping, gimbal_gain);
  rig.controller.law = LawKind::kShelf;
  rig.controller.shelf_torque = torque;
  rig.controller.shelf_tilt = tilt;
  return rig;
}

inline Rig brennan() { return precession_lqr("brennan_monorail", 0.03, 0.12, 8000.0); }
inline Rig double_brennan() { return precession_lqr("double_brennan", 0.03, 0.10, 2.0); }
inline Rig gyrocar() { return precession_lqr("gyrocar", 0.03, 0.10, 600.0); }

}  // namespace gyrotwin::reference
