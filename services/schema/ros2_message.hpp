// Messages as ROS 2 tools read them: the text of the type (`ros2msg`) and its bytes (`cdr`).
// Foxglove, Lichtblick, PlotJuggler and MCAP readers take these two.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "services/schema/lcm_type.hpp"

namespace gyrotwin {

/// One LCM type with its ROS 2 counterpart. Every field keeps name, order and dimensions; texts
/// become `string`, other bytes `uint8`, arrays of more than one dimension a row of their elements.
class Ros2Message {
 public:
  explicit Ros2Message(const LcmType& type);

  /// "gyrotwin/msg/State" for state_t.
  const std::string& name() const { return name_; }

  /// The definition, with those of the types in it behind it; units and meaning as comments.
  const std::string& definition() const { return definition_; }

  /// Appends a payload of the type, fingerprint included, as CDR: little endian, each number
  /// aligned to its size, encapsulation header first. Allocates where `to` has no room.
  void encode(std::span<const std::uint8_t> payload, std::vector<std::uint8_t>& to) const;

 private:
  /// Elements that follow each other in the payload, all of one primitive.
  struct Run {
    std::size_t offset;  // in the payload
    std::size_t size;    // of one [byte]
    std::size_t count;
    bool is_text;
  };

  void plan(const LcmType& type, std::size_t offset);

  std::string name_, definition_;
  std::vector<Run> runs_;
};

}  // namespace gyrotwin
