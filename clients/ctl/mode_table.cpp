#include "clients/ctl/mode_table.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "services/runtime/mode.hpp"

namespace gyrotwin {

std::string mode_table(TableStyle style) {
  const bool markdown = style == TableStyle::kMarkdown;
  const auto longest =
      std::ranges::max(kTransitions, {}, [](const Transition& t) { return t.when.size(); });
  const std::size_t width = longest.when.size();
  const auto row = [&](std::string_view from, std::string_view when, std::string_view to) {
    return markdown ? fmt::format("| {} | {} | {} |\n", from, when, to)
                    : fmt::format("{:<11}{:<{}}  {}\n", from, when, width, to);
  };

  std::string table = row("mode", "what happens", "leads to");
  if (markdown) table += "|---|---|---|\n";
  std::string_view above;
  for (const Transition& t : kTransitions) {
    // A text table names a mode once; a Markdown row stands for itself.
    const std::string_view from = name_of(t.from);
    table += row(!markdown && from == above ? "" : from, t.when, name_of(t.to));
    above = from;
  }
  return table;
}

}  // namespace gyrotwin
