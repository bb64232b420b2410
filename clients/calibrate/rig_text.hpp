// A rig file with some numbers replaced and everything else left as it is, byte for byte.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin::calibration {

/// A key's new number.
struct NewValue {
  std::string key;  ///< "disc.viscous_friction_nms_per_rad"
  std::string value;
  std::string comment;  ///< where it comes from; what stood there before follows it
};

/// @param document TOML of [table]s with plain keys
/// @return the document, in which each key has its new value and comment; a key that was not there
///         stands at the end of its table, which is added where it was not there either
/// @throws Error when the document is no TOML, or would not say afterwards what it should
std::string with_values(std::string_view document, const std::vector<NewValue>& values);

/// A number with so many digits that rounding is far below its standard deviation.
std::string number_with_sigma(double value, double sigma);

}  // namespace gyrotwin::calibration
