// What the rig file says that a live value is compared with.
#pragma once

#include <array>
#include <string>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

struct RigFacts {
  std::string name{};
  std::string reach{};     ///< where is listened: "this host only (lo, ...)"
  double fall_tilt = 0.0;  ///< [rad]
  bool estimated = false;  ///< a simulated owner's STATE is the onboard estimate
  model::Machine machine;
  int gyros = 0, drives = 0;
  bool lower_track = false, upper_track = false, load_cell = false;
  std::array<double, model::kMaxGyros> nominal_rotor_speed{};  ///< [rad/s]
  /// Of the gimbal angles; infinite where there is none [rad].
  std::array<double, model::kMaxGyros> lower_stop{}, upper_stop{};

  /// Distance of gyro j from its closest stop [rad], < 0 in it; infinite without stops.
  double stop_margin(int j, double angle) const;
  /// What drive i could add to its torque in that direction [N m], by motor line and torque limit.
  double drive_margin(int i, const state_t& state) const;
  /// Whether a STATE is the onboard estimate: a real plant's always is.
  bool is_estimate(const state_t& state) const;
};

RigFacts facts_of(const Rig& rig);

}  // namespace gyrotwin
