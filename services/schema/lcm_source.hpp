// The text of LCM types, taken apart.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin {

/// A named number of a struct.
struct LcmConstant {
  std::string type, name;
  std::string value;  ///< as it stands in the text
};

/// One member of a struct as it stands in the text.
struct LcmMember {
  std::string type;  ///< without package
  std::string name;
  std::vector<std::size_t> dimensions;  ///< numbers
  std::string comment;                  ///< behind it on its line, or empty
  bool is_text;                         ///< that says ASCII
};

/// One struct as it stands in the text.
struct LcmStruct {
  std::string name;
  std::vector<LcmMember> members;
  std::vector<LcmConstant> constants{};
  bool one_size = true;  ///< false: it has a string or an array of variable length
};

/// The structs of an .lcm text.
/// @throws Error naming the line and what was expected there
std::vector<LcmStruct> parse_lcm(std::string_view source);

}  // namespace gyrotwin
