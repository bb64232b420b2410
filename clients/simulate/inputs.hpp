// The inputs that --torque and --external describe: formulas or a table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/simulate/simulation.hpp"
#include "services/model/machine.hpp"

namespace gyrotwin {

/// Torques of the drives. One formula a drive in the order of the drives, or `COORDINATE=FORMULA`
/// for some of them, or one CSV file. Formulas may use t and what variables_of() names.
/// @param arguments of --torque, not empty
/// @throws Error naming the place and the fix
InputFunction<DriveTorques> torque_input(const std::vector<std::string>& arguments,
                                         const model::Machine& machine);

/// Force and moment on the structure: `fx=FORMULA` and so on, or one CSV file.
/// @param arguments of --external; none: nothing acts
/// @throws Error naming the place and the fix
InputFunction<Wrench> external_input(const std::vector<std::string>& arguments,
                                     const model::Machine& machine);

/// Coordinates and their rates as they are named in CSV columns: thx, ..., thx_dot, ...
std::vector<std::string> state_columns(const model::Machine& machine);

}  // namespace gyrotwin
