#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "services/runtime/spelling.hpp"
#include "services/runtime/toml_document.hpp"

namespace gyrotwin {

namespace {

/// Shortest text that reads back as the same number, with a point or exponent.
std::string toml_number(double x) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), x).ptr;
  std::string number(text.data(), end);
  if (number.find_first_of(".en") == std::string::npos) number += ".0";
  return number;
}

std::string toml_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

/// A value as messages show it.
std::string shown(const toml::node& node) {
  if (const auto* x = node.as_floating_point()) return toml_number(x->get());
  if (const auto* i = node.as_integer()) return std::to_string(i->get());
  if (const auto* b = node.as_boolean()) return b->get() ? "true" : "false";
  if (const auto* s = node.as_string()) return "the text " + toml_text(s->get());
  if (node.is_array()) return "a list";
  if (node.is_table()) return "a table";
  return "a date or time";
}

/// A finite number, written as an integer or not.
std::optional<double> number_in(const toml::node& node) {
  if (const auto* i = node.as_integer()) return static_cast<double>(i->get());
  const auto* x = node.as_floating_point();
  return x && std::isfinite(x->get()) ? std::optional(x->get()) : std::nullopt;
}

}  // namespace

bool Range::contains(double x) const noexcept {
  return std::isfinite(x) && (above_low ? x > low : x >= low) && x <= high;
}

std::string Range::text() const {
  const auto plain = [](double x) {
    std::string number = toml_number(x);
    if (number.ends_with(".0")) number.resize(number.size() - 2);
    return number;
  };
  const bool bounded_below = std::isfinite(low);
  const bool bounded_above = std::isfinite(high);
  if (bounded_below && bounded_above && !above_low)
    return " from " + plain(low) + " to " + plain(high);
  std::string text;
  if (bounded_below) text = (above_low ? " > " : " >= ") + plain(low);
  if (bounded_above) text += (text.empty() ? " <= " : " and <= ") + plain(high);
  return text;
}

bool TomlReader::Table::find(const char* key, std::string takes) {
  reader_.keys_.push_back({name_, key, std::move(takes), need_, {}});
  const std::string path = reader_.keys_.back().path();
  if (reader_.document_->find(path)) return true;
  if (need_ == Need::kRequired) reader_.need(path, {});
  return false;
}

bool TomlReader::Table::wrong(const char* key, const std::string& hint) {
  const std::string path = name_ + '.' + key;
  const toml::node& node = *reader_.document_->find(path);
  reader_.note(
      path, place_of(node),
      '`' + path + "` is " + shown(node) + ", expected " + reader_.keys_.back().takes + hint);
  return false;
}

bool TomlReader::Table::number(const char* key, std::optional<double>& value, Range range) {
  if (find(key, "a number" + range.text())) {
    value = number_in(*reader_.document_->find(name_ + '.' + key));
    if (!value || !range.contains(*value)) {
      value = std::numeric_limits<double>::quiet_NaN();
      return wrong(key);
    }
  }
  if (value) in_effect(toml_number(*value));
  return value.has_value();
}

bool TomlReader::Table::number(const char* key, double& value, Range range) {
  std::optional<double> held;
  if (need_ == Need::kOptional) held = value;
  const bool right = number(key, held, range);
  value = held.value_or(std::numeric_limits<double>::quiet_NaN());
  return right;
}

bool TomlReader::Table::integer(const char* key, int& value, Range range) {
  if (find(key, "an integer" + range.text())) {
    const auto* given = reader_.document_->find(name_ + '.' + key)->as_integer();
    if (!given || !range.contains(static_cast<double>(given->get()))) return wrong(key);
    value = static_cast<int>(given->get());
  } else if (need_ == Need::kRequired) {
    return false;
  }
  in_effect(std::to_string(value));
  return true;
}

bool TomlReader::Table::flag(const char* key, bool& value) {
  if (find(key, "true or false")) {
    const auto* given = reader_.document_->find(name_ + '.' + key)->as_boolean();
    if (!given) return wrong(key);
    value = given->get();
  } else if (need_ == Need::kRequired) {
    return false;
  }
  in_effect(value ? "true" : "false");
  return true;
}

bool TomlReader::Table::text(const char* key, std::string& value, const TextRule& rule) {
  if (find(key, std::string(rule.takes))) {
    const auto* given = reader_.document_->find(name_ + '.' + key)->as_string();
    if (!given || !rule.holds(given->get())) return wrong(key);
    value = given->get();
  } else if (need_ == Need::kRequired) {
    return false;
  }
  in_effect(toml_text(value));
  return true;
}

bool TomlReader::Table::numbers(const char* key, std::vector<double>& value) {
  if (find(key, "a list of numbers")) {
    const std::string path = name_ + '.' + key;
    const toml::array* given = reader_.document_->find(path)->as_array();
    if (!given) return wrong(key);
    value.clear();
    bool right = true;
    for (std::size_t i = 0; i < given->size(); ++i) {
      const toml::node& element = *given->get(i);
      value.push_back(number_in(element).value_or(0.0));
      if (number_in(element)) continue;
      right = false;
      reader_.note(path, place_of(element),
                   "element " + std::to_string(i + 1) + " of `" + path + "` is " + shown(element) +
                       ", expected a number");
    }
    if (!right) return false;
  } else if (need_ == Need::kRequired) {
    return false;
  }
  if (value.empty()) return true;
  std::string list;
  for (const double x : value) list += (list.empty() ? "[" : ", ") + toml_number(x);
  in_effect(list + ']');
  return true;
}

bool TomlReader::Table::one_of(const char* key, std::size_t& index,
                               std::span<const std::string_view> names) {
  std::string takes;
  for (const std::string_view name : names) {
    takes += (takes.empty() ? "one of \"" : ", \"") + std::string(name) + '"';
  }
  if (find(key, takes)) {
    const auto* given = reader_.document_->find(name_ + '.' + key)->as_string();
    if (!given) return wrong(key);
    index = static_cast<std::size_t>(std::find(names.begin(), names.end(), given->get()) -
                                     names.begin());
    if (index == names.size()) {
      return wrong(key, did_you_mean(std::string(nearest(given->get(), names))));
    }
  } else if (need_ == Need::kRequired) {
    return false;
  }
  in_effect(toml_text(names[index]));
  return true;
}

}  // namespace gyrotwin
