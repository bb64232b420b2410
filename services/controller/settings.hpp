// Reading a rig's [controller] numbers: a law asks for what it needs.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "services/runtime/error.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// The number under `[controller] key`.
/// @throws Error naming the law and the key when the rig does not say it
inline double required(const Rig& rig, const std::optional<double>& value, std::string_view key) {
  if (value) return *value;
  throw Error(rig.file.string() + ": law " + std::string(name_of(rig.controller.law)) +
              " needs the number `[controller] " + std::string(key) +
              "`, which is missing; add it to the rig file or give `--set controller." +
              std::string(key) + "=...`");
}

}  // namespace gyrotwin
