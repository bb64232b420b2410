// Loops and calls whose numbers are constants at compile time.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "services/model/shape.hpp"

namespace gyrotwin::model {

/// Calls f with each index of a list, as a constant.
template <IndexList list, class F>
void each(const F& f) {
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    (f(std::integral_constant<int, list.item[k]>()), ...);
  }
  (std::make_index_sequence<static_cast<std::size_t>(list.size)>());
}

/// Calls f with 0 ... n - 1, as constants.
template <int n, class F>
void count_to(const F& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) { (f(std::integral_constant<int, k>()), ...); }
  (std::make_integer_sequence<int, n>());
}

}  // namespace gyrotwin::model
