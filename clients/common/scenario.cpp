#include "clients/common/scenario.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>

#include "services/integrator/schedule.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

namespace fs = std::filesystem;

constexpr Range kTime{.low = 0.0, .high = 1e6};  // [s]

std::string shown(const toml::node& node) {
  std::ostringstream text;
  node.visit([&text](const auto& value) { text << value; });
  return text.str();
}

std::optional<double> number_in(const toml::node& node) {
  if (node.is_integer()) return static_cast<double>(node.as_integer()->get());
  if (node.is_floating_point()) return node.as_floating_point()->get();
  return std::nullopt;
}

/// What `eventN.key=value` says.
struct Change {
  std::size_t event;  ///< counted from 1
  std::string key, value;
};

/// Nothing where the text has another form.
std::optional<Change> change_of(std::string_view text) {
  constexpr std::string_view kEvent = "event";
  const auto dot = text.find('.'), equals = text.find('=');
  if (!text.starts_with(kEvent) || equals == text.npos || dot > equals) return std::nullopt;
  const std::string_view digits = text.substr(0, dot).substr(kEvent.size());
  Change change{0, std::string(text.substr(dot + 1, equals - dot - 1)),
                std::string(text.substr(equals + 1))};
  const char* const last = digits.data() + digits.size();
  const auto [end, fault] = std::from_chars(digits.data(), last, change.event);
  const bool right = fault == std::errc() && end == last && !change.key.empty() &&
                     !change.value.empty() && text.find('\n') == text.npos;
  return right ? std::optional(change) : std::nullopt;
}

/// Collects mistakes with their places.
class ScenarioReader {
 public:
  explicit ScenarioReader(std::string source) : source_(std::move(source)) {}

  std::vector<PlannedEvent> read(std::string_view document,
                                 const std::vector<std::string>& overrides) {
    toml::table file = parse(document);
    for (const std::string& text : overrides) apply(text, file);
    std::vector<PlannedEvent> events;
    for (const auto& [key, node] : file) {
      const toml::array* list = key == "event" ? node.as_array() : nullptr;
      if (list == nullptr || !list->is_homogeneous<toml::table>()) {
        note(key.source(), key == "event"
                               ? "`event` is to be a list of tables: write [[event]] before each"
                               : fmt::format("unknown key `{}`; a scenario has [[event]] tables "
                                             "alone{}",
                                             key.str(), near(key.str(), {"event"})));
        continue;
      }
      for (const toml::node& entry : *list) read_event(*entry.as_table(), events);
      if (list->size() > Schedule::kCapacity) {
        note(key.source(), fmt::format("{} events, and an owner takes {} at most", list->size(),
                                       Schedule::kCapacity));
      }
    }
    if (file.empty()) note({}, "no [[event]] is there");
    finish();
    std::ranges::stable_sort(events, {}, &PlannedEvent::at_s);
    return events;
  }

 private:
  struct Mistake {
    toml::source_position place;
    std::string text;
  };

  toml::table parse(std::string_view document) {
    try {
      return toml::parse(document);
    } catch (const toml::parse_error& error) {
      note(error.source(), "not TOML: " + std::string(error.description()));
    }
    finish();
    return {};
  }

  /// `eventN.key=value` on top of the file.
  void apply(const std::string& text, toml::table& file) {
    const auto change = change_of(text);
    if (!change) {
      return note({}, fmt::format("`{}` changes nothing; expected eventN.key=value", text));
    }
    const toml::array* list = file["event"].as_array();
    const auto count = list == nullptr ? 0 : list->size();
    if (change->event < 1 || change->event > count) {
      return note({}, fmt::format("`{}`: there are {} events, counted from 1", text, count));
    }
    toml::table* event = file["event"][change->event - 1].as_table();
    if (event == nullptr) return;  // told when it is read
    try {
      const toml::table value = toml::parse(fmt::format("value = {}", change->value));
      event->insert_or_assign(change->key, *value.get("value"));
    } catch (const toml::parse_error&) {
      event->insert_or_assign(change->key, change->value);
    }
  }

  static std::string near(std::string_view word, const std::vector<std::string_view>& candidates) {
    return did_you_mean(nearest(word, candidates));
  }

  void note(const toml::source_region& region, const std::string& text) {
    const toml::source_position place{std::max(region.begin.line, 1u),
                                      std::max(region.begin.column, 1u)};
    mistakes_.push_back(
        {place, fmt::format("{}:{}:{}: error: {}", source_, place.line, place.column, text)});
  }

  void finish() {
    if (mistakes_.empty()) return;
    std::ranges::stable_sort(
        mistakes_, {}, [](const Mistake& m) { return std::pair(m.place.line, m.place.column); });
    std::string text = source_ + " cannot be used:";
    for (const Mistake& mistake : mistakes_) text += '\n' + mistake.text;
    throw Error(text);
  }

  void read_event(const toml::table& table, std::vector<PlannedEvent>& events) {
    const std::size_t before = mistakes_.size();
    PlannedEvent planned;
    planned.place = fmt::format("{}:{}", source_, table.source().begin.line);
    planned.event.kind = read_kind(table);
    read_time(table, planned.at_s);
    if (planned.event.kind == nullptr) return;
    const bool targeted = read_target(table, planned.event);
    for (const auto& [key, node] : table) {
      if (key == "kind" || key == "at_s") continue;
      if (key == planned.event.kind->name && !planned.event.kind->targets.empty()) continue;
      // The unit of a sensor's numbers is not known before the sensor is.
      if (targeted) read_quantity(key, node, planned.event);
    }
    if (mistakes_.size() == before) {
      const std::string missing = shortcoming(planned.event, [&](const Quantity& quantity) {
        return '`' + key_of(quantity, planned.event.target) + '`';
      });
      if (!missing.empty()) note(table.source(), missing);
    }
    events.push_back(std::move(planned));
  }

  const EventKind* read_kind(const toml::table& table) {
    std::vector<std::string_view> names;
    for (const EventKind& kind : event_kinds()) names.push_back(kind.name);
    const toml::node* node = table.get("kind");
    if (node == nullptr) {
      note(table.source(),
           fmt::format("missing key `kind`, one of \"{}\"", fmt::join(names, "\", \"")));
      return nullptr;
    }
    const std::string word = node->value_or<std::string>("");
    const EventKind* kind = event_kind(word);
    if (kind == nullptr) {
      note(node->source(), fmt::format("`kind` is {}, expected one of \"{}\"{}", shown(*node),
                                       fmt::join(names, "\", \""), near(word, names)));
    }
    return kind;
  }

  void read_time(const toml::table& table, double& at_s) {
    const toml::node* node = table.get("at_s");
    if (node == nullptr) {
      note(table.source(), "missing key `at_s`, a number" + kTime.text() +
                               ": when it begins, since the scenario's first tick [s]");
      return;
    }
    const std::optional<double> number = number_in(*node);
    if (!number || !kTime.contains(*number)) {
      note(node->source(),
           fmt::format("`at_s` is {}, expected a number{}", shown(*node), kTime.text()));
      return;
    }
    at_s = *number;
  }

  bool read_target(const toml::table& table, AskedEvent& event) {
    const auto targets = event.kind->targets;
    if (targets.empty()) return true;
    std::vector<std::string_view> names;
    for (const Target& target : targets) names.push_back(target.name);
    const std::string takes = fmt::format("one of \"{}\"", fmt::join(names, "\", \""));
    const toml::node* node = table.get(event.kind->name);
    if (node == nullptr) {
      note(table.source(), fmt::format("missing key `{}`, {}", event.kind->name, takes));
      return false;
    }
    const std::string word = node->is_integer() ? std::to_string(node->as_integer()->get())
                                                : node->value_or<std::string>("");
    const auto found = std::ranges::find(targets, word, &Target::name);
    if (found == targets.end()) {
      note(node->source(), fmt::format("`{}` is {}, expected {}{}", event.kind->name, shown(*node),
                                       takes, near(word, names)));
      return false;
    }
    event.target = &*found;
    return true;
  }

  void read_quantity(const toml::key& key, const toml::node& node, AskedEvent& event) {
    std::vector<std::string> keys{"kind", "at_s"};
    if (event.target != nullptr) keys.emplace_back(event.kind->name);
    for (const Quantity& quantity : event.kind->quantities) {
      keys.push_back(key_of(quantity, event.target));
      if (keys.back() != key.str()) continue;
      if (const auto value = value_of(quantity, keys.back(), node)) {
        if (quantity.form != Quantity::Form::kFlag || *value != 0.0) {
          event.values.emplace_back(&quantity, *value);
        }
      }
      return;
    }
    note(key.source(),
         fmt::format("unknown key `{}`; the keys of \"{}\" are {}{}", key.str(), event.kind->name,
                     fmt::join(keys, ", "), near(key.str(), {keys.begin(), keys.end()})));
  }

  std::optional<double> value_of(const Quantity& quantity, const std::string& key,
                                 const toml::node& node) {
    const auto wrong = [&](const std::string& takes) {
      note(node.source(), fmt::format("`{}` is {}, expected {}", key, shown(node), takes));
      return std::nullopt;
    };
    if (quantity.form == Quantity::Form::kFlag) {
      const auto flag = node.value_exact<bool>();
      if (!flag) return wrong("true or false");
      return *flag ? 1.0 : 0.0;
    }
    const std::optional<double> number = number_in(node);
    const bool whole = quantity.form == Quantity::Form::kWhole;
    if (!number || !quantity.range.contains(*number) || (whole && !node.is_integer())) {
      return wrong((whole ? "an integer" : "a number") + quantity.range.text());
    }
    return number;
  }

  std::string source_;
  std::vector<Mistake> mistakes_;
};

fs::path find_scenario(const std::string& name_or_path) {
  if (name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".toml")) {
    return name_or_path;
  }
  const fs::path folder = rig_folder() / "scenarios";
  std::vector<std::string> names;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  if (std::ranges::find(names, name_or_path) != names.end()) {
    return folder / (name_or_path + ".toml");
  }
  const std::vector<std::string_view> candidates(names.begin(), names.end());
  throw Error(fmt::format(
      "no shipped scenario is called `{}`: there are {} (a file of your own is given by its path, "
      "with a / or ending in .toml){}",
      name_or_path, fmt::join(names, ", "), did_you_mean(nearest(name_or_path, candidates))));
}

}  // namespace

std::vector<PlannedEvent> read_scenario(std::string_view document, const std::string& source,
                                        const std::vector<std::string>& overrides) {
  return ScenarioReader(source).read(document, overrides);
}

ScenarioFile open_scenario(const std::string& name_or_path) {
  const fs::path file = find_scenario(name_or_path);
  std::error_code none;
  std::ifstream stream(file);
  if (!stream || !fs::is_regular_file(file, none)) {
    throw Error(file.string() + (fs::exists(file, none) ? " cannot be read" : " does not exist") +
                "; a scenario is a TOML file");
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return {file.string(), text.str()};
}

std::vector<PlannedEvent> load_scenario(const std::string& name_or_path) {
  const ScenarioFile file = open_scenario(name_or_path);
  return read_scenario(file.document, file.source);
}

request_t request_of(const PlannedEvent& planned, const Rig& rig, std::int64_t tick_ns,
                     std::int64_t first_tick) {
  request_t request = request_of(planned.event, rig, tick_ns);
  const double ticks = 1e9 * planned.at_s / static_cast<double>(tick_ns);
  // 0 would mean the next one, whenever it is asked for.
  request.start_tick = std::max<std::int64_t>(1, first_tick + std::llround(ticks));
  return request;
}

}  // namespace gyrotwin
