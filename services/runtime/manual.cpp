#include "services/runtime/manual.hpp"

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

namespace gyrotwin {

namespace {

constexpr std::string_view kCommonEnd =
    ".SH ENVIRONMENT\n"
    ".TP\n.B GYROTWIN_RIG\nThe rig where none is named by \\fB\\-\\-rig\\fR.\n"
    ".TP\n.B GYROTWIN_RIGS\nFolder of the rig files that go by a bare name, instead of the "
    "installed "
    "ones.\n"
    ".TP\n.B GYROTWIN_KEYS\nFolder of the keys, instead of \\fI\\(ti/.config/gyrotwin\\fR.\n"
    ".SH FILES\n"
    ".TP\n.I /etc/gyrotwin/rigs\nRig files of this host; they come before shipped ones of the same "
    "name.\n"
    ".TP\n.I /usr/share/gyrotwin/rigs\nShipped rig files and scenarios, with a page on every key.\n"
    ".TP\n.I \\(ti/.config/gyrotwin/RIG.key\nThe key that signs the rig\\(aqs messages, mode "
    "0600.\n";

/// As it is, whatever troff thinks of its characters.
std::string escaped(std::string_view text) {
  std::string troff;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) troff += "\\&";
    at_start = c == '\n';
    switch (c) {
      case '\\':
        troff += "\\e";
        break;
      case '-':
        troff += "\\-";
        break;
      case '\'':
        troff += "\\(aq";
        break;
      case '`':
        troff += "\\(ga";
        break;
      case '"':
        troff += "\\(dq";
        break;
      case '^':
        troff += "\\(ha";
        break;
      case '~':
        troff += "\\(ti";
        break;
      default:
        troff += c;
    }
  }
  return troff;
}

std::string bold(std::string_view text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + escaped(text) + "\\fR"; }

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// The description's first sentence, as whatis shows it.
std::string summary(const CLI::App& app) {
  std::string text = app.get_description();
  text = text.substr(0, text.find(". "));
  if (text.ends_with('.')) text.pop_back();
  // Not that of an abbreviation.
  if (text.size() > 1 && std::isupper(static_cast<unsigned char>(text[1])) == 0) {
    text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  }
  return text;
}

/// A subcommand's --help needs no line of its own.
std::vector<const CLI::Option*> shown_options(const CLI::App& app) {
  std::vector<const CLI::Option*> shown = app.get_options();
  std::erase_if(shown, [&app](const CLI::Option* o) {
    return o->get_group().empty() || (app.get_parent() != nullptr && o == app.get_help_ptr());
  });
  return shown;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

/// Name of the value's type, and behind it, where --help tells it, what is allowed: "X", "in 0 to
/// 1".
std::pair<std::string, std::string> type_of(const CLI::Option& option) {
  const std::string text = option.get_type_name();
  const auto colon = std::min(text.find(":in "), text.find(":{"));
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

/// "-h, --help" or "--rig NAME|FILE"; of an argument its type.
std::string heading(const CLI::Option& option) {
  const auto [type, allowed] = type_of(option);
  std::string value = italic(type) + (allowed.empty() ? "" : ' ' + escaped(allowed));
  if (option.get_positional()) return value;
  std::string text;
  const auto add = [&text](const std::string& name) {
    text += (text.empty() ? "" : ", ") + bold(name);
  };
  for (const std::string& name : option.get_snames()) add("-" + name);
  for (const std::string& name : option.get_lnames()) add("--" + name);
  if (takes_value(option)) text += ' ' + value;
  return text;
}

std::string entry(const CLI::Option& option) {
  std::string text = ".TP\n" + heading(option) + '\n' + escaped(option.get_description());
  std::string preset = option.get_default_str();
  if (!preset.empty()) preset = bold(preset);
  if (!option.get_envname().empty()) preset = bold("$" + option.get_envname()) + ", else " + preset;
  if (!preset.empty()) text += "; default: " + preset;
  return text + ".\n";
}

/// Options and arguments, those of a group together; `level` is the macro of a group's heading.
std::string entries(const CLI::App& app, std::string_view level) {
  const auto options = shown_options(app);
  std::vector<std::string> groups;
  for (const CLI::Option* option : options) {
    if (std::ranges::find(groups, option->get_group()) == groups.end()) {
      groups.push_back(option->get_group());
    }
  }
  std::string text;
  for (const std::string& group : groups) {
    if (!level.empty() && group != "Options" && group != "Positionals") {
      text += fmt::format("{} {}\n", level, escaped(group));
    }
    for (const CLI::Option* option : options) {
      if (option->get_group() == group) text += entry(*option);
    }
  }
  return text;
}

std::string arguments(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : shown_options(app)) {
    if (!option->get_positional()) continue;
    const std::string name = italic(type_of(*option).first);
    text += option->get_required() ? ' ' + name : " [" + name + ']';
  }
  return text;
}

/// Every subcommand, those of subcommands after their own.
std::string commands(const CLI::App& app, const std::string& before) {
  std::string text;
  for (const CLI::App* sub : app.get_subcommands({})) {
    const std::string name = before + sub->get_name();
    text += ".SS \"" + bold(name) + arguments(*sub) + "\"\n" + escaped(sub->get_description()) +
            ".\n" + entries(*sub, "") + commands(*sub, name + ' ');
  }
  return text;
}

std::string as_it_stands(std::string_view heading, std::string_view text) {
  if (text.empty()) return {};
  return fmt::format(".SH {}\n.nf\n{}\n.fi\n", heading, escaped(text));
}

std::string footer(const CLI::App& app) {
  std::string notes = app.get_footer(), examples;
  if (const auto at = notes.find("Example"); at != std::string::npos) {
    examples = notes.substr(std::min(notes.find('\n', at) + 1, notes.size()));
    notes.resize(at);
  }
  while (notes.ends_with('\n')) notes.pop_back();
  return as_it_stands("NOTES", notes) + as_it_stands("EXAMPLES", examples);
}

/// The pages of the verbs; of a verb, the front page.
std::string see_also(const CLI::App& app) {
  std::string text = ".SH SEE ALSO\n";
  if (app.get_name() != "gyrotwin") return text + ".BR gyrotwin (1)\n";
  const auto verbs = app.get_subcommands({});
  for (const CLI::App* verb : verbs) {
    text += fmt::format(".BR {} (1){}\n", escaped("gyrotwin-" + verb->get_name()),
                        verb == verbs.back() ? "" : ",");
  }
  return text;
}

std::string word(const CLI::Option& option) {
  if (option.get_positional()) return type_of(option).first + ':';
  const std::string name = option.get_lnames().empty() ? "-" + option.get_snames().front()
                                                       : "--" + option.get_lnames().front();
  return takes_value(option) ? name + '=' + type_of(option).first : name;
}

std::string context_lines(const CLI::App& app, const std::string& path, const std::string& above) {
  std::string words, options;
  for (const CLI::App* sub : app.get_subcommands({})) words += ' ' + sub->get_name();
  for (const CLI::Option* option : shown_options(app)) {
    (option->get_positional() ? words : options) += ' ' + word(*option);
  }
  const std::string all = words + options + above;
  std::string lines = path + '\t' + all.substr(all.empty() ? 0 : 1) + '\n';
  // What the app takes its subcommands take too, where they fall through to it.
  for (const CLI::App* sub : app.get_subcommands({})) {
    const bool falls = sub->get_fallthrough();
    lines += context_lines(*sub, path + ' ' + sub->get_name(), falls ? options + above : "");
  }
  return lines;
}

}  // namespace

std::string as_typed(const CLI::App& app) {
  std::string name = app.get_name();
  if (const auto dash = name.find('-'); dash != std::string::npos) name[dash] = ' ';
  return name;
}

std::string manual(const CLI::App& app, std::string_view version) {
  const auto subcommands = commands(app, "");
  std::string text = fmt::format(".TH {} 1 \"\" \"gyrotwin {}\" \"gyrotwin\"\n",
                                 escaped(upper(app.get_name())), escaped(version));
  text += ".SH NAME\n" + escaped(app.get_name()) + " \\- " + escaped(summary(app)) + '\n';
  text += ".SH SYNOPSIS\n" + bold(as_typed(app)) + " [" + italic("OPTION") + "]..." +
          arguments(app) + (subcommands.empty() ? "" : ' ' + italic("COMMAND") + " ...") + '\n';
  text += ".SH DESCRIPTION\n" + escaped(app.get_description()) + '\n';
  text += ".SH OPTIONS\n" + entries(app, ".SS");
  if (!subcommands.empty()) text += ".SH COMMANDS\n" + subcommands;
  return text + footer(app) + std::string(kCommonEnd) + see_also(app);
}

std::string completion_words(const CLI::App& app) { return context_lines(app, app.get_name(), ""); }

}  // namespace gyrotwin
