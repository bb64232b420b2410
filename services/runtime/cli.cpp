#include "services/runtime/cli.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string_view>
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

/// Subcommands that may follow what was given, from the innermost outwards, or the options there.
std::vector<std::string> possible(const CLI::App& app, bool options) {
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) at = at->get_subcommands().back();
  std::vector<std::string> names;
  for (; at != nullptr; at = at->get_parent()) {
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
  std::string list, meant;
  for (const std::string& word : app.remaining(true)) {
    list += (list.empty() ? "`" : ", `") + word + '`';
    if (meant.empty()) meant = meant_by(app, word);
  }
  const bool extra = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
  return (extra ? "not expected: " + list : error.what()) + did_you_mean(meant);
}

}  // namespace

RigOptions::RigOptions(CLI::App& app) {
  app.fallthrough();  // subcommands inherit it
  app.add_option("--rig", rig_, "Rig file, or the name of a shipped rig")
      ->envname("GYROTWIN_RIG")
      ->type_name("NAME|FILE")
      ->capture_default_str()
      ->group("Rig");
  app.add_option("--set", overrides_,
                 "Override a key of the rig file, e.g. loop.rate_hz=500; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->group("Rig");
  app.add_flag("--check-config", check_, "Only check the rig file")->group("Rig");
  app.add_flag("--print-config", print_, "Only print the rig with its defaults and overrides")
      ->group("Rig");
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

CLI::Validator finite_within(double low, double high) {
  const auto plain = [](double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return std::string(text);
  };
  const std::string range = plain(low) + " to " + plain(high);
  return CLI::Validator(
      [=](std::string& text) {
        double x = 0.0;
        const bool right =
            CLI::detail::lexical_cast(text, x) && std::isfinite(x) && x >= low && x <= high;
        return right ? std::string() : '`' + text + "` is no number from " + range;
      },
      "in " + range);
}

CLI::Validator one_of(std::vector<std::string> words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return CLI::Validator(
      [words = std::move(words), list](std::string& text) -> std::string {
        if (std::find(words.begin(), words.end(), text) != words.end()) return {};
        const std::vector<std::string_view> names(words.begin(), words.end());
        return '`' + text + "` is not one of " + list + did_you_mean(nearest(text, names));
      },
      '{' + list + '}');
}

int run_program(int argc, char** argv, CLI::App& app, const std::function<int()>& body) {
  app.set_version_flag("--version", app.get_name() + " " GYROTWIN_VERSION);
  // Not for users: from these the build makes man pages and completion.
  if (argc == 2 && std::string_view(argv[1]) == "--print-manual") {
    std::fputs(manual(app, GYROTWIN_VERSION).c_str(), stdout);
    return kDone;
  }
  if (argc == 2 && std::string_view(argv[1]) == "--print-words") {
    std::fputs(completion_words(app).c_str(), stdout);
    return kDone;
  }
  try {
    app.parse(argc, argv);
    return body();
  } catch (const CLI::Success& answered) {
    return app.exit(answered);  // prints help or version
  } catch (const CLI::ParseError& error) {
    complain(app,
             explained(app, error) + "\n`" + app.get_name() + " --help` shows what can be given");
    return kUsage;
  } catch (const NotReady& error) {
    complain(app, error.what());
    return kNotReady;
  } catch (const Error& error) {
    complain(app, error.what());
    return kUsage;
  } catch (const std::exception& error) {
    complain(app, error.what());
    return kNotDone;
  }
}

}  // namespace gyrotwin
