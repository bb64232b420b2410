// A rig's machine as a function of some of its parameters.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin::calibration {

/// A key of the rig file that is sought.
struct Parameter {
  std::string key;  ///< "disc.viscous_friction_nms_per_rad"
  double start;     ///< what the rig file says
  double scale;     ///< |start|: parameters are sought in its multiples, x = value / scale
  double value(double x) const { return x * scale; }
};

/// A machine, and its neighbours for derivatives by the parameters: rates and readings are
/// differenced between `up` and `down`, at the same state.
struct Neighbourhood {
  /// Step of x on both sides. Differences of the model are then good to 1e-8 of their size.
  static constexpr double kStep = 1e-4;
  struct Pair {
    model::Machine up, down;
    double span;  ///< of x between them; half of it where one of them would be no rig
  };
  model::Machine machine;
  std::vector<Pair> pairs;  ///< one a parameter; empty where no derivatives are wanted
};

/// A rig with some keys free.
class Family {
 public:
  /// @param rig, overrides as for load_rig()
  /// @param keys numbers of the rig file that make the machine
  /// @throws Error when a key is none of them, or is 0 so that there is no scale
  Family(std::string rig, std::vector<std::string> overrides, const std::vector<std::string>& keys);

  const std::vector<Parameter>& parameters() const { return parameters_; }
  /// A rotor's speed is part of the state; otherwise it is an input, as measured.
  bool rotors_run() const { return rotors_run_; }

  /// @param x one a parameter
  /// @throws Error when there is no such rig
  Rig rig_at(std::span<const double> x) const;
  model::Machine machine_at(std::span<const double> x) const;
  Neighbourhood around(std::span<const double> x) const;

 private:
  std::string rig_;
  std::vector<std::string> overrides_;
  std::vector<Parameter> parameters_;
  bool rotors_run_ = false;
};

}  // namespace gyrotwin::calibration
