// What a sweep changes, and the values it takes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gyrotwin {

/// One key and its values: a list that is gone through, or a distribution that is drawn from.
struct Variable {
  enum class Kind : std::uint8_t { kList, kNormal, kUniform, kSeed };

  std::string key;   ///< "gyros.rotor_speed_rad_s", "start.thx", "event1.impulse_nms"
  std::string spec;  ///< as it was given
  Kind kind = Kind::kList;
  std::vector<std::string> list = {};  ///< numbers or words
  bool words = false;                  ///< one of the list is no number
  double first = 0.0, second = 0.0;    ///< mean and standard deviation, or low and high
  bool factor = false;                 ///< the values multiply what the rig has

  bool drawn() const { return kind != Kind::kList; }

  /// A draw; another one for every run, whoever draws it and when.
  double draw(std::uint64_t seed, std::uint64_t stream, std::int64_t run) const;
};

/// Reads `KEY=VALUES`, where VALUES is one of
///   A,B,C               numbers or words
///   LOW:HIGH:N          N numbers, evenly spaced; log(LOW:HIGH:N): evenly in their logarithm
///   normal(MEAN,SIGMA)  uniform(LOW,HIGH)  seed(): a whole number for a `seed` key
/// and a * before it makes them factors on what the rig has.
/// @throws Error with what was found and what is expected
Variable parse_variable(const std::string& text);

/// The shortest text that reads back as the same number.
std::string number_text(double value);

}  // namespace gyrotwin
