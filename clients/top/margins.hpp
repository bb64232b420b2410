// How far the platform is from its limits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "clients/top/picture.hpp"
#include "clients/top/rig_facts.hpp"

namespace gyrotwin {

struct Margin {
  enum class Room : std::uint8_t { kFine, kClose, kGone };
  double left;  ///< < 0 beyond the limit
  Room room;
};

/// Those that live messages tell; empty: not known now, as in FAULT, or the rig has no such limit.
struct Margins {
  std::optional<Margin> tilt;                                    ///< to the fall limit [rad]
  std::array<std::optional<Margin>, model::kMaxGyros> gimbal{};  ///< to the closest stop [rad]
  std::array<std::optional<Margin>, model::kMaxDrives>
      drive{};  ///< in the direction it pushes [N m]
};

Margins margins_of(const Picture& picture, const RigFacts& facts);

/// The one with the least room, and of these the one with the least left.
template <std::size_t N>
std::optional<Margin> worst(const std::array<std::optional<Margin>, N>& margins) {
  const auto rank = [](const Margin& m) { return std::pair(-static_cast<int>(m.room), m.left); };
  std::optional<Margin> found;
  for (const auto& margin : margins) {
    if (margin && (!found || rank(*margin) < rank(*found))) found = margin;
  }
  return found;
}

}  // namespace gyrotwin
