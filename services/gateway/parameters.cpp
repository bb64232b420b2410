#include "services/gateway/parameters.hpp"

#include <toml++/toml.h>

namespace gyrotwin {

namespace {

using foxglove::Json;

Json json_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* flag = node.as_boolean()) return flag->get();
  if (const auto* array = node.as_array()) {
    Json list = Json::array();
    for (const toml::node& entry : *array) list.push_back(json_of(entry));
    return list;
  }
  return node.value_or(0.0);
}

void flatten(const toml::table& table, const std::string& prefix, Json& to) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* inner = node.as_table()) {
      flatten(*inner, name + '.', to);
    } else {
      to[name] = json_of(node);
    }
  }
}

}  // namespace

Parameters::Parameters(std::string_view rig_text) : values_(Json::object()) {
  flatten(toml::parse(rig_text), "", values_);
  set_recording({{"on", false}});
}

Json Parameters::pick(const Json& names) const {
  if (names.empty()) return values_;
  Json picked = Json::object();
  for (const auto& name : names) {
    const auto* text = name.get_ptr<const std::string*>();
    if (text != nullptr && values_.contains(*text)) picked[*text] = values_[*text];
  }
  return picked;
}

}  // namespace gyrotwin
