// gyrotwin-experiment: the experiments that a rig is calibrated by, on whoever owns it.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <numbers>
#include <optional>

#include "clients/common/interrupt.hpp"
#include "clients/common/shell_word.hpp"
#include "clients/experiment/conduct.hpp"
#include "clients/experiment/recorder.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/mode.hpp"

namespace gyrotwin {

namespace {

struct Options {
  std::string file;
  ExperimentPlan plan{.kind = nullptr};
  std::optional<double> duration_s;
  double lean_deg = 6.0;
  bool ready = false;
};

void add_experiment(Command& app, const ExperimentKind& kind, Options& options) {
  Command sub = app.add_subcommand(kind.name, kind.does);
  sub.add_option("file", options.file, "A new log").required().type("FILE");
  sub.add_option("--duration", options.duration_s,
                 kind.name == "run-down"
                     ? "How long to watch, in the owner's time [s]; default: until the rotors have "
                       "lost half their speed"
                     : "How long to watch, in the owner's time [s]; default: 10")
      .check(number_within(0.1, 1e5).untold())
      .type("S");
  sub.add_flag("--ready", options.ready, "What is to be done by hand is done: do not ask");
  if (kind.name == "coast-down") {
    sub.add_option("--driven", options.plan.driven_s,
                   "How long the controller's law drives the disc before [s]")
        .check(number_within(0.1, 1e5).untold())
        .shows_default()
        .type("S");
  }
  if (kind.name != "swing") return;
  sub.add_option("--mass", options.plan.mass_kg, "The counterweight [kg]")
      .required()
      .check(number_within(1e-3, 1e6).untold())
      .type("KG");
  sub.add_option("--height", options.plan.mass_height_m,
                 "Its centre of mass above the ground pivot [m]; < 0: below")
      .required()
      .check(number_within(-1e3, -1e-3).untold())
      .type("M");
  sub.add_option("--lean", options.lean_deg, "Where it starts [deg]")
      .check(number_within(0.1, 30.0).untold())
      .shows_default()
      .type("DEG");
}

void wait_for_hands(const std::string& work, bool ready) {
  if (work.empty()) return;
  std::printf("now by hand: %s\n", work.c_str());
  std::fflush(stdout);
  if (ready) return;
  if (isatty(STDIN_FILENO) != 1) throw NotDone("say --ready when that is done");
  std::printf("press Enter when that is done, Ctrl-C to leave it\n");
  std::fflush(stdout);
  std::string line;
  if (!std::getline(std::cin, line)) throw NotDone("stopped");
}

std::vector<std::string> rig_words(const RigOptions& rig_options) {
  std::vector<std::string> words{"--rig", rig_options.name()};
  for (const std::string& key : rig_options.overrides()) {
    words.insert(words.end(), {"--set", key});
  }
  return words;
}

int run(const Command& app, const RigOptions& rig_options, Options& options) {
  const Rig rig = rig_options.load();
  const std::string name = app.given_subcommand();
  if (name.empty()) throw UsageError("which experiment, e.g. swing, is required");
  ExperimentPlan& plan = options.plan;
  plan.kind = &experiment_of(name);
  plan.watched_s = options.duration_s.value_or(watched_s(*plan.kind, rig));
  plan.tilt_rad = options.lean_deg * std::numbers::pi / 180.0;
  MonotonicClock clock;
  Asker asker(rig, clock);
  const status_t& owner = asker.owner();
  const bool simulated = owner.service == status_t::INTEGRATOR;
  const std::string why_not = misfit(plan, rig, simulated, rig_options.overrides());
  if (!why_not.empty()) throw NotDone(why_not);
  if (owner.mode != status_t::MODE_HELD) {
    throw NotDone(
        fmt::format("the owner is {}: `gyrotwin ctl reset` first", mode_name(owner.mode)));
  }
  wait_for_hands(by_hand(plan, simulated), options.ready);

  const Interrupt interrupt;
  Recorder recorder(options.file, rig_words(rig_options));
  std::printf("watches for %.3g s\n", plan.watched_s);
  std::fflush(stdout);
  conduct(plan, rig, asker, [&] {
    recorder.require_running();
    return !interrupt.wanted();
  });
  recorder.stop();
  std::vector<std::string> words = rig_words(rig_options);
  words.insert(words.end(), {"--experiment", std::string(plan.kind->name), options.file});
  std::string next = "next: gyrotwin calibrate";
  for (const std::string& word : words) next += ' ' + shell_word(word);
  std::puts(next.c_str());
  if (plan.kind->name == "swing") {
    std::printf("with a second log, of another counterweight, it can tell mass from inertia\n");
  }
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Runs an experiment on a rig, simulated or real, and records it for calibrate.",
      "gyrotwin-experiment");
  app.footer(
      "It asks the owner of the rig for everything, and needs a controller that is there to arm.\n"
      "What a simulated rig has to be started with for it, it says. Ctrl-C disarms.\n"
      "Exit code 0: done; 1: refused, fallen, stopped; 2: asked wrongly.\n"
      "Examples:\n"
      "  gyrotwin experiment coast-down coast.lcm --driven 5 --duration 15\n"
      "  gyrotwin experiment swing swing_8kg.lcm --mass 8 --height -0.4\n"
      "  gyrotwin experiment run-down rotors.lcm");
  const gyrotwin::RigOptions rig_options(app);
  gyrotwin::Options options;
  for (const gyrotwin::ExperimentKind& kind : gyrotwin::kExperiments) {
    gyrotwin::add_experiment(app, kind, options);
  }
  return app.run(argc, argv, [&] { return gyrotwin::run(app, rig_options, options); });
}
