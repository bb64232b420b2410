// State and command of the platform between the model's words and the wire's.
#pragma once

#include <cstdint>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"

namespace gyrotwin {

/// VALID_* bits of what a machine of this layout can show.
std::int32_t valid_groups(const model::Machine& machine) noexcept;
/// Of these, the ones that laws look at; an estimate may lack the others.
std::int32_t groups_for_laws(const model::Machine& machine) noexcept;

/// Writes the groups that the machine has, zeros into the others.
void to_wire(const model::Observation& seen, std::int32_t valid, state_t& state) noexcept;
model::Observation from_wire(const state_t& state) noexcept;

/// Gives an input the drives that a command asks for.
void from_wire(const command_t& command, model::Input& input) noexcept;

}  // namespace gyrotwin
