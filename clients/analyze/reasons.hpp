// Why a rig stands or falls, in one sentence.
#pragma once

#include <string>

#include "clients/analyze/cases.hpp"
#include "clients/analyze/conditions.hpp"

namespace gyrotwin {

/// @param seen how the rig fares, as its file has it
std::string reason_for(const Rig& rig, const Case& seen, const Theory& theory);

}  // namespace gyrotwin
