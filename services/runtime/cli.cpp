#include "services/runtime/cli.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "services/runtime/error.hpp"
#include "services/runtime/journal.hpp"
#include "services/runtime/manual.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

void complain(const CLI::App& app, const std::string& what) {
  const std::string head = stderr_is_journal() ? "<3>" : app.get_name() + ": error: ";
  std::fprintf(stderr, "%s%s\n", head.c_str(), what.c_str());
}

/// The subcommand that was given, its subcommand that was given, or the program.
const CLI::App& innermost(const CLI::App& app) {
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) at = at->get_subcommands().back();
  return *at;
}

/// Where more is told: "`gyrotwin disturb impulse --help` shows what can be given".
std::string hint(const CLI::App& app) {
  std::string words;
  for (const CLI::App* at = &innermost(app); at != &app; at = at->get_parent()) {
    words = ' ' + at->get_name() + words;
  }
  return "\n`" + as_typed(app) + words + " --help` shows what can be given";
}

/// Subcommands that may follow what was given, from the innermost outwards, or the options there.
std::vector<std::string> possible(const CLI::App& app, bool options) {
  std::vector<std::string> names;
  for (const CLI::App* at = &innermost(app); at != nullptr; at = at->get_parent()) {
    if (!options) {
      for (const CLI::App* sub : at->get_subcommands({})) names.push_back(sub->get_name());
      continue;
    }
    for (const CLI::Option* option : at->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

/// What a word that found no place was likely meant to be; empty where none is near.
std::string meant_by(const CLI::App& app, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const std::vector<std::string> names = possible(app, name.starts_with('-'));
  return std::string(nearest(name, std::vector<std::string_view>(names.begin(), names.end())));
}

/// What is wrong, and what the first misspelt word was likely meant to be. CLI11 has words that
/// found no place in reverse order.
std::string explained(const CLI::App& app, const CLI::ParseError& error) {
  const bool extra = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
  std::string list, advice;
  for (const std::string& word : app.remaining(true)) {
    list += (list.empty() ? "`" : ", `") + word + '`';
    if (!advice.empty()) continue;
    const std::string meant = meant_by(app, word);
    if (meant != word) {
      advice = did_you_mean(meant);
    } else if (extra) {
      advice = word.starts_with('-') ? "; it comes before the command" : "; one command at a time";
    }
  }
  return (extra ? "not expected: " + list : error.what()) + advice;
}

}  // namespace

Check number(std::function<bool(double)> allows, const std::string& what) {
  return {[allows = std::move(allows), what](const std::string& text) {
            double x = 0.0;
            const bool right = CLI::detail::lexical_cast(text, x) && std::isfinite(x) && allows(x);
            return right ? std::string() : '`' + text + "` is no " + what;
          },
          ""};
}

Check number_within(double low, double high) {
  const auto plain = [](double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return std::string(text);
  };
  const std::string range = plain(low) + " to " + plain(high);
  Check check = number([=](double x) { return x >= low && x <= high; }, "number from " + range);
  check.allowed = "in " + range;
  return check;
}

Check whole_within(std::int64_t low, std::int64_t high) {
  const std::string range = std::to_string(low) + " to " + std::to_string(high);
  return {[=](const std::string& text) {
            std::int64_t x = 0;
            const auto fault = std::from_chars(text.data(), text.data() + text.size(), x).ec;
            const bool right =
                fault == std::errc() && text == std::to_string(x) && x >= low && x <= high;
            return right ? std::string() : '`' + text + "` is no whole number from " + range;
          },
          "in " + range};
}

Check one_of(std::vector<std::string> words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return {[words = std::move(words), list](const std::string& text) -> std::string {
            if (std::find(words.begin(), words.end(), text) != words.end()) return {};
            const std::vector<std::string_view> names(words.begin(), words.end());
            return '`' + text + "` is not one of " + list + did_you_mean(nearest(text, names));
          },
          '{' + list + '}'};
}

Option& Option::type(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::check(Check check) {
  option_->check(
      CLI::Validator([fault = std::move(check.fault)](std::string& text) { return fault(text); },
                     std::move(check.allowed)));
  return *this;
}

Option& Option::required(bool is) {
  option_->required(is);
  return *this;
}

Option& Option::repeatable() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::values(int count) {
  option_->expected(count);
  return *this;
}

Option& Option::separated_by(char comma) {
  option_->delimiter(comma);
  return *this;
}

Option& Option::shows_default() {
  option_->capture_default_str();
  return *this;
}

Option& Option::environment(const std::string& name) {
  option_->envname(name);
  return *this;
}

Option& Option::group(const std::string& name) {
  option_->group(name);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

bool Option::given() const { return option_->count() > 0; }

template <OptionValue T>
Option Command::add_option(const std::string& names, T& value, const std::string& help) {
  Option option(app_->add_option(names, value, help));
  // As a shell has it for a variable that nobody has set.
  if constexpr (std::same_as<T, std::string> || std::same_as<T, std::filesystem::path>) {
    option.check({[](const std::string& text) -> std::string {
                    return text.empty() ? "is empty, and needs a text" : "";
                  },
                  ""});
  }
  return option;
}
template Option Command::add_option(const std::string&, std::string&, const std::string&);
template Option Command::add_option(const std::string&, std::filesystem::path&, const std::string&);
template Option Command::add_option(const std::string&, int&, const std::string&);
template Option Command::add_option(const std::string&, std::int64_t&, const std::string&);
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option Command::add_option(const std::string&, double&, const std::string&);
template Option Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<std::string>&,
                                    const std::string&);

Option Command::add_number(const std::string& names, std::function<void(double)> take,
                           const std::string& help) {
  return Option(app_->add_option_function<double>(names, std::move(take), help));
}

Option Command::add_flag(const std::string& names, bool& value, const std::string& help) {
  return Option(app_->add_flag(names, value, help));
}

Option Command::add_flag(const std::string& names, std::function<void()> take,
                         const std::string& help) {
  return Option(app_->add_flag_callback(names, std::move(take), help));
}

Command Command::add_subcommand(std::string_view name, std::string_view help) {
  app_->require_subcommand(0, 1);
  return Command(app_->add_subcommand(std::string(name), std::string(help)));
}

void Command::alias(const std::string& name) { app_->alias(name); }

Option Command::get_option(const std::string& name) { return Option(app_->get_option(name)); }

bool Command::given() const { return app_->parsed(); }

std::string Command::given_subcommand() const {
  const auto given = app_->get_subcommands();
  return given.empty() ? "" : given.front()->get_name();
}

CommandLine::CommandLine(const std::string& description, const std::string& program)
    : Command(nullptr), owned_(std::make_unique<CLI::App>(description, program)) {
  app_ = owned_.get();
  app_->set_version_flag("--version", program + " " GYROTWIN_VERSION);
}

CommandLine::~CommandLine() = default;

void CommandLine::footer(const std::string& text) { app_->footer(text); }

std::string CommandLine::manual() const { return gyrotwin::manual(*app_, GYROTWIN_VERSION); }

std::string CommandLine::completion_words() const { return gyrotwin::completion_words(*app_); }

int CommandLine::run(int argc, char** argv, const std::function<int()>& body) {
  // Not for users: from these the build makes man pages and completion.
  if (argc == 2 && std::string_view(argv[1]) == "--print-manual") {
    std::fputs(manual().c_str(), stdout);
    return kDone;
  }
  if (argc == 2 && std::string_view(argv[1]) == "--print-words") {
    std::fputs(completion_words().c_str(), stdout);
    return kDone;
  }
  try {
    app_->parse(argc, argv);
    return body();
  } catch (const CLI::Success& answered) {
    return app_->exit(answered);  // prints help or version
  } catch (const CLI::ParseError& error) {
    complain(*app_, explained(*app_, error) + hint(*app_));
    return kUsage;
  } catch (const UsageError& error) {
    complain(*app_, error.what() + hint(*app_));
    return kUsage;
  } catch (const NotReady& error) {
    complain(*app_, error.what());
    return kNotReady;
  } catch (const Error& error) {
    complain(*app_, error.what());
    return kUsage;
  } catch (const std::exception& error) {
    complain(*app_, error.what());
    return kNotDone;
  }
}

RigOptions::RigOptions(Command command) {
  command.app_->fallthrough();  // subcommands inherit it
  command.add_option("--rig", rig_, "Rig file, or the name of a shipped rig")
      .environment("GYROTWIN_RIG")
      .type("NAME|FILE")
      .shows_default()
      .group("Rig");
  command
      .add_option("--set", overrides_,
                  "Override a key of the rig file, e.g. loop.rate_hz=500; repeatable")
      .type("KEY=VALUE")
      .repeatable()
      .group("Rig");
  command.add_flag("--check-config", check_, "Only check the rig file").group("Rig");
  command.add_flag("--print-config", print_, "Only print the rig with its defaults and overrides")
      .group("Rig");
}

void RigOptions::override_key(std::string key_and_value) {
  overrides_.push_back(std::move(key_and_value));
}

Rig RigOptions::load() const {
  Rig rig = load_rig(rig_, overrides_);
  if (print_) std::fputs(print_rig(rig_, overrides_).c_str(), stdout);
  if (check_) std::printf("%s: ok\n", rig.file.c_str());
  // As CLI11 does it for --help and --version.
  if (print_ || check_) throw CLI::Success();
  return rig;
}

}  // namespace gyrotwin
