// gyrotwin-simulate: a rig offline, faster than real time.
#include <optional>
#include <string>
#include <vector>

#include "clients/common/initial.hpp"
#include "clients/common/interrupt.hpp"
#include "clients/common/scenario.hpp"
#include "clients/common/tilt.hpp"
#include "clients/common/variation.hpp"
#include "clients/simulate/expression.hpp"
#include "clients/simulate/inputs.hpp"
#include "clients/simulate/output.hpp"
#include "clients/simulate/simulation.hpp"
#include "clients/simulate/stepper_word.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr double kShortest = 1e-6;  // [s]
constexpr double kLongest = 1e6;    // [s]

/// What the command line says; empty: not given.
struct Options {
  std::vector<std::string> initial, torque, external, events;
  std::string scenario, motor = "on", feedback, stepper, output = "-";
  Variation variation;
  double duration = 10.0;
  std::optional<double> sample;
  bool extra = false;
};

/// A repeatable option, one argument each.
Option add_list(Command& app, const char* name, std::vector<std::string>& values,
                const char* help) {
  return app.add_option(name, values, help).repeatable().group("Inputs");
}

void add_inputs(Command& app, Options& options) {
  add_list(app, "--initial", options.initial,
           "Initial state instead of the rig file's, rad and rad/s: q=0.05,0,0,0,v=0,0,-5,0 or "
           "thx=0.05,phi_dot=-5; what is not said stays")
      .type("STATE");
  add_list(app, "--torque", options.torque,
           "Drive torques [N m] instead of a law: a formula in t and the CSV columns, one for each "
           "drive or COORDINATE=FORMULA, or a CSV file (t_s, then one column a drive)")
      .type("FORMULA|FILE");
  add_list(app, "--external", options.external,
           "What acts on the structure, world frame: a CSV file with t_s and any of fx_n fy_n fz_n "
           "(at the push point) mx_nm my_nm mz_nm, or formulas such as mx=2*sin(t)")
      .type("FILE|NAME=FORMULA");
  app.add_option("--scenario", options.scenario,
                 "Disturbances and faults at their times, as `gyrotwin disturb play` has them: a "
                 "scenario file, or the name of a shipped one; needs sampled feedback")
      .type("NAME|FILE")
      .group("Inputs");
  add_list(app, "--event", options.events,
           "Another number for the scenario's N-th event: event1.impulse_nms=5, with the keys that "
           "its file has")
      .type("eventN.KEY=VALUE");
}

void add_plant(Command& app, Options& options) {
  const auto word = [&app](const char* name, std::string& value, const std::string& help,
                           const std::vector<std::string>& words, const char* group) {
    return app.add_option(name, value, help).check(one_of(words)).group(group);
  };
  word("--motor", options.motor,
       "off: drives that give any torque at any speed, without motor line and torque limit",
       {"on", "off"}, "Plant")
      .shows_default();
  add_variation(app, options.variation);
  app.get_option("--law").group("Inputs");
  for (const char* name : {"--mount", "--track"}) app.get_option(name).group("Plant");
  word(
      "--feedback", options.feedback,
      "sampled: torques once a tick, held over it, with fixed steps the same bits as a live system "
      "in lockstep; continuous: at every instant. Default: sampled with a law, a scenario or an "
      "estimate",
      {"sampled", "continuous"}, "Time");
  word("--stepper", options.stepper,
       std::string(kStepperHelp) +
           ". Default: fixed with sampled feedback, adaptive with continuous",
       stepper_words(), "Time");
}

void add_output(Command& app, Options& options) {
  app.add_option("--duration", options.duration,
                 "How long [s], whole ticks where time goes in ticks; there is a row at its end")
      .check(number_within(kShortest, kLongest))
      .shows_default()
      .type("S")
      .group("Time");
  app.add_option("--sample", options.sample,
                 "Time between rows [s], whole ticks where time goes in ticks; default 0.01")
      .check(number_within(kShortest, kLongest))
      .type("S")
      .group("Time");
  app.add_option("--output", options.output, "Where the CSV goes; -: standard output")
      .shows_default()
      .type("FILE")
      .group("Output");
  app.add_flag("--extra", options.extra,
               "More columns: drive torques, rotor speeds, tilt, contact and load cell forces, "
               "holding moment, energies; what STATE says where it is an estimate")
      .group("Output");
}

Rig load_rig(RigOptions& rig_options, const Options& options) {
  apply(options.variation, rig_options);
  return rig_options.load();
}

model::State start_of(const Rig& rig, const model::Machine& machine, const Options& options) {
  Initial initial{rig.initial_q, rig.initial_v};
  for (const std::string& text : options.initial) {
    initial = parse_initial(text, machine.layout.names, std::move(initial));
  }
  model::State start = rig.initial_state(machine);
  const model::State said = machine.state(initial.q, initial.v);
  start.q = said.q;
  start.v = said.v;
  return start;
}

/// What `disturb play` asks a live owner that is HELD.
std::vector<Scenario::Event> events_of(const Rig& rig, const Options& options) {
  std::vector<Scenario::Event> events;
  if (options.scenario.empty()) {
    if (!options.events.empty()) throw Error("--event changes a scenario's; give --scenario too");
    return events;
  }
  const ScenarioFile file = open_scenario(options.scenario);
  for (const PlannedEvent& planned : read_scenario(file.document, file.source, options.events)) {
    events.push_back({request_of(planned, rig, rig.loop.tick_ns(), 0), planned.place});
  }
  return events;
}

Scenario scenario_of(const Rig& rig, const model::Machine& machine, const Options& options) {
  Scenario scenario;
  scenario.start = start_of(rig, machine, options);
  scenario.duration = options.duration;
  scenario.sample = options.sample;
  if (!options.torque.empty()) {
    if (!options.variation.law.empty() && rig.controller.law != LawKind::kNone) {
      throw Error("--torque replaces the law; leave out --law or --torque");
    }
    scenario.torque = torque_input(options.torque, machine);
  }
  scenario.external = external_input(options.external, machine);
  scenario.events = events_of(rig, options);
  const bool law = !scenario.torque && rig.controller.law != LawKind::kNone;
  const bool ticks = law || !scenario.events.empty() || rig.loop.state == StateSource::kEstimate;
  scenario.sampled = options.feedback.empty() ? ticks : options.feedback == "sampled";
  const char* usual = scenario.sampled ? "fixed" : "adaptive";
  scenario.stepping.kind = stepper_of(options.stepper.empty() ? usual : options.stepper);
  scenario.stepping.substeps = rig.loop.substeps;
  return scenario;
}

/// Writes the samples and keeps the user company. Opens the file with the first sample, when all
/// that can be wrong with the question has been seen.
class Recorder : public Spectator {
 public:
  Recorder(const Options& options, const model::Machine& machine)
      : options_(options), machine_(machine) {}

  void sample(const Sample& sample) override {
    if (!file_) {
      using Extra = CsvFile::Extra;
      const Extra extra = sample.estimate != nullptr ? Extra::kWithEstimate : Extra::kTruth;
      file_.emplace(options_.output, machine_, options_.extra ? extra : Extra::kNone);
      progress_.emplace(options_.duration, !file_->on_terminal());
    }
    file_->write(sample);
  }
  bool go_on(const Outcome& until_now) override {
    progress_->show(until_now.t);
    return file_->sound() && !interrupt_.wanted();
  }
  bool sound() const { return file_->sound(); }

 private:
  const Options& options_;
  const model::Machine& machine_;
  Interrupt interrupt_;
  std::optional<CsvFile> file_;
  std::optional<Progress> progress_;
};

void tell_verdict(const Rig& rig, const Outcome& outcome) {
  if (outcome.safe_stop_at) {
    std::fprintf(stderr,
                 "safe stop at %.3f s: no valid command for %d ticks; from then on the drives do "
                 "safety.safe_stop\n",
                 *outcome.safe_stop_at, rig.safety.command_timeout_ticks);
  }
  std::fprintf(stderr, "%s\n", outcome.verdict.text().c_str());
}

int conclude(const Rig& rig, const Outcome& outcome, bool written) {
  using End = Outcome::End;
  const auto complain = [&](const std::string& what) {
    std::fprintf(stderr,
                 "gyrotwin-simulate: error: %s at t = %.6g s; rows until then are written\n",
                 what.c_str(), outcome.t);
    return kNotDone;
  };
  if (outcome.verdict.fell_at() || outcome.end == End::kDuration) tell_verdict(rig, outcome);
  if (!written) return complain("the output takes no more (disk full?)");
  switch (outcome.end) {
    case End::kDuration:
      return kDone;
    case End::kStopped:
      return complain("stopped by a signal");
    case End::kInputNotFinite:
      return complain(
          "a torque or external load was no finite number; check --torque and "
          "--external,");
    case End::kNotFinite:
      break;
  }
  if (outcome.verdict.has_tilt() && outcome.verdict.fell_at()) {
    std::fprintf(
        stderr,
        "gyrotwin-simulate: the equations end at 90 deg of tilt; the last row is of t = %.6g "
        "s and %.1f deg\n",
        outcome.t, degrees(outcome.verdict.tilt()));
    return kDone;
  }
  char tilt[32];
  std::snprintf(tilt, sizeof tilt, "%.1f", degrees(outcome.verdict.tilt()));
  return complain(
      "no finite motion, or one too fast to follow (a formula that chatters? soften "
      "sign(x) to tanh(x/0.01), or use --feedback sampled), after a tilt of " +
      std::string(tilt) + " deg,");
}

int run(RigOptions& rig_options, const Options& options) {
  const Rig rig = load_rig(rig_options, options);
  const bool ideal = options.motor == "off";
  const model::Machine machine =
      ideal ? with_ideal_drives(rig.build_machine()) : rig.build_machine();
  const Scenario scenario = scenario_of(rig, machine, options);
  Outcome outcome;
  bool written = true;
  {
    Recorder recorder(options, machine);
    outcome = simulate(rig, machine, scenario, recorder);
    written = recorder.sound();
  }
  return conclude(rig, outcome, written);
}

std::string footer() {
  return "Formulas: + - * / ^ ( ) pi, t [s], the CSV columns (phi_dot, thx, ...), and\n  " +
         Expression::functions() +
         "\n  step(x): 0 below 0, else 1; square(x): +1 and -1, period 2 pi. A formula may jump, a "
         "table\n  is followed exactly: zero before its first row, its last row stays.\n"
         "The last line on stderr says whether it stands, leans on its gimbal stops, or falls; a\n"
         "machine without a tilt, whether it meets its stops. A live owner stops the drives\n"
         "of a fallen platform; here everything goes on, an umbrella platform at most to 90 deg\n"
         "of tilt, where its equations end.\n"
         "Exit code 0: simulated, to the end or a fall; 1: not so far; 2: asked wrongly.\n"
         "Examples:\n"
         "  gyrotwin simulate --output run.csv          # the rig as it would run live\n"
         "  gyrotwin simulate --law none --initial thx=0.05 --duration 2\n"
         "  gyrotwin simulate --rig prototype_b_sleeping --torque '2*(-5 - phi_dot)'\n"
         "  gyrotwin simulate --rig double_brennan --torque 'qA=0.1*square(2*pi*t)'\n"
         "  gyrotwin simulate --external 'mx=20*step(t-0.5)*step(0.6-t)'\n"
         "  gyrotwin simulate --scenario push_and_gust --duration 20 --output run.csv\n"
         "  gyrotwin simulate --mount universal_joint --set loop.rate_hz=500 --extra";
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Simulates a rig offline, faster than real time, and writes its motion as CSV: t_s, the "
      "coordinates [rad], their rates [rad/s].",
      "gyrotwin-simulate");
  app.footer(gyrotwin::footer());
  gyrotwin::RigOptions rig_options(app);
  gyrotwin::Options options;
  gyrotwin::add_inputs(app, options);
  gyrotwin::add_plant(app, options);
  gyrotwin::add_output(app, options);
  return app.run(argc, argv, [&] { return gyrotwin::run(rig_options, options); });
}
