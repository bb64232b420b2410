// What every program's command line has in common, on CLI11.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "services/runtime/exit_code.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// The options about the rig: --rig, --set, --check-config, --print-config.
class RigOptions {
 public:
  /// Adds them to `app`, which must live as long and gets its subcommands afterwards: the options
  /// may then stand behind a subcommand too.
  explicit RigOptions(CLI::App& app);
  RigOptions(const RigOptions&) = delete;
  RigOptions& operator=(const RigOptions&) = delete;

  /// One more `key=value`, for options that are short for a key; as if given last.
  void override_key(std::string key_and_value);

  /// The rig that was asked for. When --check-config or --print-config was given, prints the answer
  /// instead and ends the program through run_program(); so call it first.
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

/// A number within [low, high]; refuses nan and inf, which CLI::Range accepts.
CLI::Validator finite_within(double low, double high);

/// One of these words; says what else was likely meant.
CLI::Validator one_of(std::vector<std::string> words);

/// Adds --version, parses the command line and runs `body`, which returns an exit code. A wrong
/// command line and Error end with kUsage, NotReady with kNotReady, any other exception with
/// kNotDone, each with one message `NAME: error: ...` on stderr; NAME is the app's, e.g.
/// gyrotwin-ctl. A misspelt subcommand or option is told with the one that was likely meant.
int run_program(int argc, char** argv, CLI::App& app, const std::function<int()>& body);

}  // namespace gyrotwin
