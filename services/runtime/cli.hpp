// What every program's command line has in common, on CLI11: that is read in cli.cpp and manual.cpp
// alone, for each source that reads it takes ten seconds longer to compile.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"
#include "services/runtime/rig.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace gyrotwin {

/// Whether a word of the command line may be a value.
struct Check {
  std::function<std::string(const std::string&)> fault;  ///< what is wrong with it; empty: nothing
  std::string allowed;                                   ///< as --help says it, behind the type

  /// The same, where the option's own help says enough.
  Check untold() const { return {fault, ""}; }
};

/// A number of which `allows` holds, and otherwise "`x` is no `what`"; never nan or inf.
Check number(std::function<bool(double)> allows, const std::string& what);
Check number_within(double low, double high);
/// Digits, and a sign where `low` is negative; without leading zeros, which others take for octal.
Check whole_within(std::int64_t low, std::int64_t high);

/// One of these words; says what else was likely meant.
Check one_of(std::vector<std::string> words);

/// What the things of a table are called.
template <class Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& thing : table) names.emplace_back(thing.name);
  return names;
}

/// An option, a flag or an argument, as CommandLine keeps it.
class Option {
 public:
  Option& type(const std::string& name);  ///< what its value is called
  Option& check(Check check);
  Option& required(bool is = true);
  Option& repeatable();                          ///< takes one value each time it is given
  Option& values(int count);                     ///< takes so many
  Option& separated_by(char comma);              ///< or takes several at once
  Option& shows_default();                       ///< --help says what the variable holds now
  Option& environment(const std::string& name);  ///< a variable that says it where nobody else does
  Option& group(const std::string& name);        ///< its heading in --help; empty: not shown
  Option& excludes(const Option& other);
  bool given() const;

 private:
  friend class Command;
  explicit Option(CLI::Option* option) : option_(option) {}

  CLI::Option* option_;
};

/// What an option can be read into.
template <class T>
concept OptionValue = std::same_as<T, std::string> || std::same_as<T, std::filesystem::path> ||
    std::same_as<T, std::vector<std::string>> || std::same_as<T, int> ||
    std::same_as<T, std::int64_t> || std::same_as<T, std::uint64_t> || std::same_as<T, double> ||
    std::same_as<T, std::optional<double>>;

/// A program or one of its subcommands, as CommandLine keeps it.
class Command {
 public:
  /// `names` without dashes is an argument. `value` keeps what it holds unless the option is given;
  /// what it and `take` refer to is written to in CommandLine::run(). An empty text is refused.
  template <OptionValue T>
  Option add_option(const std::string& names, T& value, const std::string& help);
  /// An option with a number.
  Option add_number(const std::string& names, std::function<void(double)> take,
                    const std::string& help);
  Option add_flag(const std::string& names, bool& value, const std::string& help);
  Option add_flag(const std::string& names, std::function<void()> take, const std::string& help);

  /// At most one of a command's subcommands can be given.
  Command add_subcommand(std::string_view name, std::string_view help);
  void alias(const std::string& name);

  Option get_option(const std::string& name);  ///< one that was added
  bool given() const;                          ///< of a subcommand
  std::string given_subcommand() const;        ///< its name, or empty

 protected:
  explicit Command(CLI::App* app) : app_(app) {}

  CLI::App* app_;

 private:
  friend class RigOptions;
};

/// A program's command line, with --help and --version.
class CommandLine : public Command {
 public:
  /// @param program e.g. gyrotwin-ctl
  CommandLine(const std::string& description, const std::string& program);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  void footer(const std::string& text);

  /// Parses and runs `body`, which returns an exit code. A wrong command line and Error end with
  /// kUsage, NotReady with kNotReady, any other exception with kNotDone, each with one message
  /// `PROGRAM: error: ...` on stderr. A misspelt subcommand or option is told with the one that was
  /// likely meant.
  int run(int argc, char** argv, const std::function<int()>& body);

  std::string manual() const;            ///< man page, see manual.hpp
  std::string completion_words() const;  ///< see manual.hpp

 private:
  std::unique_ptr<CLI::App> owned_;
};

/// The options about the rig: --rig, --set, --check-config, --print-config.
class RigOptions {
 public:
  /// Adds them to `command`, which gets its subcommands afterwards: the options may then stand
  /// behind a subcommand too. CommandLine::run() writes to this object.
  explicit RigOptions(Command command);
  RigOptions(const RigOptions&) = delete;
  RigOptions& operator=(const RigOptions&) = delete;

  /// One more `key=value`, for options that are short for a key; as if given last.
  void override_key(std::string key_and_value);

  /// The rig that was asked for. When --check-config or --print-config was given, prints the answer
  /// instead and ends the program through CommandLine::run(); so call it first.
  /// @throws Error when the rig is wrong
  Rig load() const;

  const std::string& name() const { return rig_; }
  const std::vector<std::string>& overrides() const { return overrides_; }

 private:
  std::string rig_ = "prototype_b";
  std::vector<std::string> overrides_;
  bool check_ = false;
  bool print_ = false;
};

}  // namespace gyrotwin
