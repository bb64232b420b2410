#include "clients/sweep/plan.hpp"

#include <spdlog/fmt/fmt.h>

#include "services/runtime/error.hpp"

namespace gyrotwin {

std::int64_t Plan::runs() const {
  constexpr std::int64_t kMost = 1'000'000'000;
  std::int64_t count = repetitions;
  for (const Variable& variable : variables) {
    if (!variable.drawn()) count *= std::ssize(variable.list);
    if (count > kMost) {
      throw Error(fmt::format("that makes more than {} runs; take fewer values", kMost));
    }
  }
  return count;
}

Point Plan::point(std::int64_t run) const {
  Point point(variables.size());
  std::int64_t cell = run / repetitions;
  for (std::size_t i = variables.size(); i-- > 0;) {
    const Variable& variable = variables[i];
    if (variable.drawn()) {
      point[i] = number_text(variable.draw(seed, i, run));
    } else {
      const std::int64_t size = std::ssize(variable.list);
      point[i] = variable.list[static_cast<std::size_t>(cell % size)];
      cell /= size;
    }
  }
  return point;
}

}  // namespace gyrotwin
