// What TomlReader reads from; beside it only because two of its files need toml++.
#pragma once

#include <toml++/toml.h>

#include <map>
#include <string>

#include "services/runtime/toml_reader.hpp"

namespace gyrotwin {

struct TomlReader::Document {
  toml::table file;
  std::map<std::string, toml::table> overrides;  // path -> { value = ... }

  /// The value in effect; null when there is none.
  const toml::node* find(const std::string& path) const {
    const auto found = overrides.find(path);
    if (found != overrides.end()) return found->second.get("value");
    const std::size_t dot = path.find('.');
    const toml::node* table = file.get(path.substr(0, dot));
    return table && table->is_table() ? table->as_table()->get(path.substr(dot + 1)) : nullptr;
  }
};

/// Where a node or a key of the file stands.
template <class Source>
TomlReader::Place place_of(const Source& node_or_key) {
  const auto [line, column] = node_or_key.source().begin;
  return {line, column};
}

}  // namespace gyrotwin
