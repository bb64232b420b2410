#include "clients/common/initial.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

std::vector<std::string_view> split(std::string_view text) {
  constexpr std::string_view kSeparators = ",;[] \t\n";
  std::vector<std::string_view> words;
  for (;;) {
    const auto begin = text.find_first_not_of(kSeparators);
    if (begin == std::string_view::npos) return words;
    text.remove_prefix(begin);
    words.push_back(text.substr(0, text.find_first_of(kSeparators)));
    text.remove_prefix(words.back().size());
  }
}

double number(std::string_view word) {
  double value = 0.0;
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) {
    throw Error(fmt::format("initial state: `{}` is no finite number", word));
  }
  return value;
}

/// The place that `NAME` or `NAME_dot` means.
double& named(std::string_view name, const std::vector<std::string>& names, Initial& state) {
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (name == names[i]) return state.q[i];
    if (name.ends_with("_dot") && name.substr(0, name.size() - 4) == names[i]) return state.v[i];
    known.push_back(names[i]);
  }
  throw Error(fmt::format(
      "initial state: this machine has no `{}`; expected q= or v= and {} numbers, or one of {}= "
      "and the rates {}_dot={}",
      name, names.size(), fmt::join(names, "=, "), fmt::join(names, "_dot=, "),
      did_you_mean(nearest(name, known))));
}

void replace(char which, const std::optional<std::vector<double>>& list,
             const std::vector<std::string>& names, std::vector<double>& values) {
  if (!list) return;
  if (list->size() != names.size()) {
    throw Error(fmt::format("initial state: {}= has {} numbers; expected {}, for {}", which,
                            list->size(), names.size(), fmt::join(names, ", ")));
  }
  values = *list;
}

}  // namespace

Initial parse_initial(std::string_view text, const std::vector<std::string>& names, Initial base) {
  std::optional<std::vector<double>> q, v;
  std::vector<std::pair<std::string_view, double>> single;
  std::optional<std::vector<double>>* list = nullptr;  // that a bare number continues

  for (const std::string_view word : split(text)) {
    const auto equals = word.find('=');
    if (equals == std::string_view::npos) {
      if (list == nullptr) {
        throw Error(fmt::format("initial state: what is `{}`? Write q= or v= before a list", word));
      }
      (*list)->push_back(number(word));
      continue;
    }
    const std::string_view name = word.substr(0, equals), value = word.substr(equals + 1);
    list = name == "q" ? &q : name == "v" ? &v : nullptr;
    if (list == nullptr) {
      single.emplace_back(name, number(value));
      continue;
    }
    if (*list) throw Error(fmt::format("initial state: {}= is given twice", name));
    list->emplace();
    if (!value.empty()) (*list)->push_back(number(value));
  }

  replace('q', q, names, base.q);
  replace('v', v, names, base.v);
  for (const auto& [name, value] : single) named(name, names, base) = value;
  return base;
}

}  // namespace gyrotwin
