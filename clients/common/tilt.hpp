// Tilt of the structure, as STATE tells it.
#pragma once

#include <cmath>
#include <numbers>

#include "messages/channels.hpp"

namespace gyrotwin {

constexpr double degrees(double radians) { return radians * (180.0 / std::numbers::pi); }
constexpr double radians(double degrees) { return degrees * (std::numbers::pi / 180.0); }

/// Angle between the structure's axis and the vertical [rad]; the state must have VALID_TILT.
inline double tilt_of(const state_t& state) noexcept {
  // z_S = Rx(a) Ry(b) z = (sin b, -sin a cos b, cos a cos b).
  const double a = state.tilt_rad[0], b = state.tilt_rad[1];
  return std::atan2(std::hypot(std::sin(b), std::sin(a) * std::cos(b)), std::cos(a) * std::cos(b));
}

}  // namespace gyrotwin
