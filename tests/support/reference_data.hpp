// Reference data made by a code that is independent of this project: tests/data/reference.
#pragma once

#include <string>
#include <vector>

#include "services/model/gimballed.hpp"
#include "services/model/umbrella.hpp"

namespace gyrotwin::reference {

/// One state with its inputs, and what follows from them.
struct Vector {
  std::string name;
  model::Machine machine;
  model::State state{};
  model::Input input{};
  std::vector<double> qdd{};  ///< [rad/s^2]
  double T2 = 0.0;            ///< kinetic energy, constant rotor spin left out [J]
  double V = 0.0;             ///< potential energy [J]
  std::vector<double> contact_lower{}, contact_upper{};  ///< per gyro; empty without that track [N]
};

/// All vectors of vectors.json. @throws std::exception when the file is not there or not
/// understood.
std::vector<Vector> vectors();

/// A time series of generalised coordinates and rates.
struct Trajectory {
  struct Sample {
    double t;  ///< [s]
    std::vector<double> q, v;
  };
  std::vector<Sample> samples;  ///< the first is the initial state
  double uncertainty;           ///< of the numbers themselves [rad] or [rad/s]
};

/// trajectories/`name`.csv. @throws std::exception when it is not there or not understood.
Trajectory trajectory(const std::string& name);

/// Parameter sets of vectors.json: mount `level` on the lower track, slot clearance 2 mm, drives
/// without a limit of their own.
model::UmbrellaParameters umbrella(const std::string& set);
model::GimballedParameters gimballed(const std::string& set);

}  // namespace gyrotwin::reference
