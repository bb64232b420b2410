// The text of LCM types, taken apart.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin {

/// One member of a struct as it stands in the text.
struct LcmMember {
  std::string type;  ///< without package
  std::string name;
  std::vector<std::size_t> dimensions;  ///< numbers
  bool is_text;                         ///< the comment behind it on its line says ASCII
};

/// One struct as it stands in the text.
struct LcmStruct {
  std::string name;
  std::vector<LcmMember> members;
  bool one_size = true;  ///< false: it has a string or an array of variable length
};

/// The structs of an .lcm text.
/// @throws Error naming the line and what was expected there
std::vector<LcmStruct> parse_lcm(std::string_view source);

}  // namespace gyrotwin
