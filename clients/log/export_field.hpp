// The fields of a type as columns of a table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "services/schema/lcm_type.hpp"

namespace gyrotwin {

/// A number, an array of numbers or a text. Keeps nothing of the type it is from.
struct TableField {
  std::string name;                   ///< "header.tick", "tilt_rad"
  std::string unit;                   ///< "rad", "1"; empty where the type names none
  std::vector<std::string> elements;  ///< their names: "tilt_rad[0]", "tilt_rad[1]"; one for a text
  std::size_t offset;                 ///< in the payload, fingerprint included [byte]
  std::size_t size;                   ///< of an element, of all of a text [byte]
  Primitive primitive;
  bool is_text;

  /// Where an element's number stands in the payload.
  LcmNumber number(std::size_t element) const { return {offset + element * size, primitive}; }
};

/// All fields of a type in their order. Bytes that are no text, as signatures are, have no column.
std::vector<TableField> table_fields(const LcmType& type);

/// The text of such a field, characters that no terminal should see as '?'.
std::string text_in(const TableField& field, std::span<const std::uint8_t> payload);

}  // namespace gyrotwin
