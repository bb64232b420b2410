#include "services/runtime/toml_reader.hpp"

#include <algorithm>
#include <tuple>

#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"
#include "services/runtime/toml_document.hpp"

namespace gyrotwin {

namespace {

/// What a shell user means by the text after `key=`.
std::optional<toml::table> value_table(const std::string& text) {
  try {
    toml::table parsed = toml::parse("value = " + text);
    if (parsed.size() == 1) return parsed;
  } catch (const toml::parse_error&) {
    constexpr std::string_view kWord =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.:/-";
    if (!text.empty() && text.find_first_not_of(kWord) == std::string::npos) {
      return toml::table{{"value", text}};
    }
  }
  return std::nullopt;
}

/// `.5` and `5.` are numbers to people; TOML wants a digit on both sides of the point.
std::string with_digits_around_points(const std::string& text) {
  const auto digit = [&text](std::size_t i) {
    return i < text.size() && text[i] >= '0' && text[i] <= '9';
  };
  const auto ends_word = [&text](std::size_t i) {
    return i >= text.size() || std::string_view(" ,]\teE").find(text[i]) != std::string_view::npos;
  };
  const auto begins_word = [&text](std::size_t i) {
    return i == 0 || std::string_view(" ,[\t+-").find(text[i - 1]) != std::string_view::npos;
  };
  std::string full;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool point = text[i] == '.';
    if (point && begins_word(i) && digit(i + 1)) full += '0';
    full += text[i];
    if (point && i > 0 && digit(i - 1) && ends_word(i + 1)) full += '0';
  }
  return full;
}

// The line of what is wrong with an override: told last.
constexpr unsigned kOfOverride = std::numeric_limits<unsigned>::max();

}  // namespace

TomlReader::TomlReader(std::string_view text, std::string source,
                       const std::vector<std::string>& overrides)
    : source_(std::move(source)), document_(std::make_unique<Document>()) {
  try {
    document_->file = toml::parse(text);
  } catch (const toml::parse_error& error) {
    const auto [line, column] = error.source().begin;
    throw Error(source_ + " cannot be used:\n" + source_ + ':' + std::to_string(line) + ':' +
                std::to_string(column) + ": error: not TOML: " + std::string(error.description()));
  }
  for (const std::string& override_text : overrides) apply(override_text);
}

TomlReader::~TomlReader() = default;

void TomlReader::apply(const std::string& override_text) {
  const std::size_t equals = override_text.find('=');
  const std::string path = override_text.substr(0, equals);
  document_->overrides[path] = {};
  if (equals == std::string::npos) {
    return note(path, {}, "no value; write `--set table.key=value`");
  }
  const std::string text = override_text.substr(equals + 1);
  const bool quoted = text.find_first_of("\"'") != std::string::npos;
  if (std::optional<toml::table> value =
          value_table(quoted ? text : with_digits_around_points(text))) {
    document_->overrides[path] = std::move(*value);
    return;
  }
  note(path, {},
       "`" + text +
           "` is no TOML value; write a number, true, a word, \"a text\" or [a, list], and "
           "quote it against the shell");
}

bool TomlReader::has_table(const std::string& name) const {
  const auto& overrides = document_->overrides;
  return document_->file.contains(name) ||
         std::any_of(overrides.begin(), overrides.end(),
                     [&](const auto& given) { return given.first.starts_with(name + '.'); });
}

TomlReader::Table TomlReader::table(std::string name, Need need) {
  tables_.push_back(name);
  const toml::node* node = document_->file.get(name);
  if (node && !node->is_table()) {
    note(name, place_of(*node), "`" + name + "` is to be a table: [" + name + "], then its keys");
  }
  return {*this, std::move(name), need};
}

void TomlReader::note(const std::string& path, Place place, const std::string& text) {
  const bool overridden = document_->overrides.contains(path);
  const std::string where =
      overridden ? "--set " + path
                 : source_ + ':' + std::to_string(place.line) + ':' + std::to_string(place.column);
  if (overridden) place.line = kOfOverride;
  mistakes_.push_back({place, where + ": error: " + text});
}

void TomlReader::mistake(std::initializer_list<std::string> paths, const std::string& text) {
  const auto overridden = std::find_if(paths.begin(), paths.end(), [&](const std::string& path) {
    return document_->overrides.contains(path);
  });
  const std::string& path = overridden == paths.end() ? *paths.begin() : *overridden;
  const toml::node* node = document_->find(path);
  if (!node) node = document_->file.get(path.substr(0, path.find('.')));
  note(path, node ? place_of(*node) : Place{}, text);
}

void TomlReader::need(const std::string& path, std::string why) {
  // An override without a sound value has been told.
  if (document_->find(path) || document_->overrides.contains(path)) return;
  missing_[path] = std::move(why);
}

void TomlReader::finish() {
  report_unknown();
  report_missing();
  if (mistakes_.empty()) return;

  std::stable_sort(mistakes_.begin(), mistakes_.end(), [](const Mistake& a, const Mistake& b) {
    return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
  });
  const bool overridden = mistakes_.back().place.line == kOfOverride;
  std::string text = source_ + (overridden ? ", as --set changes it," : "") + " cannot be used:";
  for (const Mistake& mistake : mistakes_) text += '\n' + mistake.text;
  throw Error(text);
}

const TomlReader::Key* TomlReader::nearest_key(const std::string& path) const {
  const std::string name = path.substr(path.find('.') + 1);
  const Key* best = nullptr;
  std::size_t best_distance = name.size() + 1;
  for (const Key& key : keys_) {
    // The right name in the wrong table is nearly right.
    const std::size_t distance = key.name == name ? 1 : edit_distance(path, key.path());
    if (distance < best_distance && is_near(distance, name, key.name)) {
      best = &key;
      best_distance = distance;
    }
  }
  return best;
}

void TomlReader::report_unknown() {
  const auto check_key = [&](const std::string& path, Place place) {
    if (std::any_of(keys_.begin(), keys_.end(), [&](auto& key) { return key.path() == path; })) {
      return;
    }
    const Key* meant = nearest_key(path);
    if (meant) missing_.erase(meant->path());  // one slip, one message
    note(path, place, "unknown key `" + path + '`' + did_you_mean(meant ? meant->path() : ""));
  };
  for (const auto& [path, value] : document_->overrides) {
    if (!value.empty()) check_key(path, {});
  }
  for (const auto& [name, node] : document_->file) {
    if (std::find(tables_.begin(), tables_.end(), name.str()) == tables_.end()) {
      report_unknown_table(std::string(name.str()), place_of(name));
    } else if (const toml::table* table = node.as_table()) {
      for (const auto& [key, value] : *table) {
        check_key(std::string(name.str()) + '.' + std::string(key.str()), place_of(key));
      }
    }
  }
}

void TomlReader::report_unknown_table(const std::string& name, Place place) {
  const std::vector<std::string_view> names(tables_.begin(), tables_.end());
  const std::string meant(nearest(name, names));
  std::string all;
  for (const std::string& table : tables_) all += " [" + table + ']';
  note(name, place,
       "unknown table [" + name + ']' +
           (meant.empty() ? "; the tables of this rig are" + all : did_you_mean(meant)));
  // One slip, one message: the table is not missing, it is misspelt.
  if (!document_->file.contains(meant)) {
    std::erase_if(missing_, [&](auto& key) { return key.first.starts_with(meant + '.'); });
  }
}

void TomlReader::report_missing() {
  for (const std::string& name : tables_) {
    const toml::node* table = document_->file.get(name);
    if (table && !table->is_table()) continue;  // table() has told
    std::string all;
    for (const Key& key : keys_) {
      const auto missing = missing_.find(key.path());
      if (key.table != name || missing == missing_.end()) continue;
      all += ' ' + key.name;
      const std::string why = missing->second.empty() ? "" : ": " + missing->second;
      if (table)
        note(name, place_of(*table), "missing key `" + key.path() + "`, " + key.takes + why);
    }
    if (!table && !all.empty()) {
      note(name, {}, "missing table [" + name + "] with the keys" + all);
    }
  }
}

std::string TomlReader::effective() const {
  std::string text;
  for (const std::string& name : tables_) {
    std::string keys;
    for (const Key& key : keys_) {
      if (key.table == name && !key.value.empty()) keys += key.name + " = " + key.value + '\n';
    }
    if (!keys.empty()) text += (text.empty() ? "[" : "\n[") + name + "]\n" + keys;
  }
  return text;
}

}  // namespace gyrotwin
