// The pictures of an analysis: what a rig does, over time, over its parameters, over its starts.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clients/analyze/analysis.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// The rig with some keys changed, each `key=value`.
/// @throws Error when the rig reader refuses it
using RigFamily = std::function<Rig(const std::vector<std::string>&)>;

/// A rig key and where to look.
struct KeyRange {
  std::string key;
  double low, high;
};

/// `KEY=LOW:HIGH`.
/// @throws Error naming the text and what is expected
KeyRange parse_range(const std::string& text);

/// `key=value`, every digit.
std::string setting(const std::string& key, double value);

/// Which keys the root locus and the stability map vary.
struct FigureKeys {
  std::optional<KeyRange> locus;
  std::optional<std::pair<KeyRange, KeyRange>> map = {};
  std::optional<std::pair<double, double>> own = {};  ///< the rig's values of the map's keys
};

/// Rotor speed for the locus; rotor speed, and disc speed or the height of the centre of mass, for
/// the map. None where these are 0, or the rig has no such keys.
FigureKeys default_keys(const Rig& rig);

/// A chart and what to say under it.
struct Figure {
  std::string svg;
  std::string caption;
};

/// Response to the reference push, root locus, stability map, phase portrait, potential: those
/// that the rig has.
/// @param family that `rig` is the plain member of
std::vector<Figure> figures_of(const Rig& rig, const Analysis& analysis, const RigFamily& family,
                               const FigureKeys& keys, int threads);

}  // namespace gyrotwin
