// The mode table that people read, from the one that owners obey.
#pragma once

#include <string>

namespace gyrotwin {

enum class TableStyle { kText, kMarkdown };

/// Every transition of services/runtime/mode.hpp: mode, what happens, next mode.
std::string mode_table(TableStyle style);

}  // namespace gyrotwin
