// gyrotwin-ctl: asks the owner of a rig, and shows how it is.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "clients/common/initial.hpp"
#include "clients/common/tilt.hpp"
#include "clients/ctl/mode_table.hpp"
#include "clients/ctl/observe.hpp"
#include "clients/ctl/verbs.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

constexpr double kDay = 86400.0;  // [s]
constexpr std::int64_t kMostTicks = 1'000'000'000'000'000;

/// What the command line says.
struct Options {
  std::int64_t ticks = 1;
  double speed = 1.0;
  std::string initial;
  std::string rotors;
  bool json = false;
  bool markdown = false;
  std::string awaited;
  double timeout_s = 10.0;
  double tilt_deg = 1.0;
  double for_s = 1.0;
};

std::int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

void add_verbs(Command& app, Options& options) {
  for (const Verb& verb : kVerbs) {
    Command sub = app.add_subcommand(verb.name, verb.summary);
    if (verb.verb == request_t::STEP) {
      sub.add_option("ticks", options.ticks, "How many")
          .required()
          .type("N")
          .check(whole_within(1, kMostTicks).untold());
    } else if (verb.verb == request_t::SPEED) {
      sub.add_option("factor", options.speed, "Simulated over wall time")
          .required()
          .type("X")
          .check(number_within(kSlowestSpeed, kFastestSpeed));
    } else if (verb.verb == request_t::ROTORS) {
      sub.add_option("direction", options.rotors, "spin-up or spin-down")
          .required()
          .type("DIRECTION")
          .check(one_of({"spin-up", "spin-down"}).untold());
    } else if (verb.verb == request_t::RESET) {
      sub.add_option("--initial", options.initial,
                     "Initial state instead of the rig file's, rad and rad/s: "
                     "q=0.05,0,0,0,v=0,0,-5,0 or thx=0.05,phi_dot=-5")
          .type("STATE");
    }
  }
}

void add_observers(Command& app, Options& options) {
  Command status = app.add_subcommand("status", "How owner and controller are");
  status.add_flag("--json", options.json, "For programs");

  Command modes = app.add_subcommand("modes", "The modes of an owner and what leads where");
  modes.add_flag("--markdown", options.markdown, "As a Markdown table");

  Command wait = app.add_subcommand("wait", "Wait for a mode, or until the platform balances");
  wait.add_option("mode", options.awaited,
                  "held, running, paused, safe_stop, fallen, fault; ready: HELD, and can be "
                  "armed; balanced: RUNNING and upright for a while")
      .required()
      .type("MODE");
  wait.add_option("--timeout", options.timeout_s, "Wall time to wait at the longest [s]")
      .type("S")
      .shows_default()
      .check(number_within(0.0, kDay).untold());
  wait.add_option("--tilt-deg", options.tilt_deg, "balanced: largest tilt [deg]")
      .type("X")
      .shows_default()
      .check(number_within(0.0, 180.0).untold());
  wait.add_option("--for", options.for_s, "balanced: this long, in the owner's time [s]")
      .type("S")
      .shows_default()
      .check(number_within(0.0, kDay).untold());
}

request_t request_of(const Verb& verb, const Options& options, const Rig& rig) {
  request_t request{};
  request.verb = verb.verb;
  if (verb.verb == request_t::STEP) request.step_ticks = options.ticks;
  if (verb.verb == request_t::SPEED) request.speed_factor = options.speed;
  if (verb.verb == request_t::ROTORS) {
    request.kind = options.rotors == "spin-up" ? +request_t::SPIN_UP : +request_t::SPIN_DOWN;
  }
  if (verb.verb == request_t::RESET && !options.initial.empty()) {
    const std::vector<std::string> names = rig.build_machine().layout.names;
    const Initial initial = parse_initial(options.initial, names, {rig.initial_q, rig.initial_v});
    request.initial_given = 1;
    std::copy(initial.q.begin(), initial.q.end(), request.initial_q);
    std::copy(initial.v.begin(), initial.v.end(), request.initial_v);
  }
  return request;
}

Mode mode_of(std::string word) {
  std::ranges::transform(word, word.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::vector<std::string_view> names;
  for (std::int32_t m = status_t::MODE_HELD; m <= status_t::MODE_FAULT; ++m) {
    names.push_back(mode_name(m));
    if (word == names.back()) return static_cast<Mode>(m);
  }
  names.insert(names.end(), {"READY", "BALANCED"});
  throw Error("wait: `" + word + "` is no mode of an owner; `gyrotwin ctl wait --help` lists them" +
              did_you_mean(nearest(word, names)));
}

void wait(Asker& asker, const Options& options) {
  const std::int64_t limit_ns = nanoseconds(options.timeout_s);
  if (options.awaited == "ready") {
    wait_until_ready(asker, limit_ns);
    std::printf("ready to arm\n");
    return;
  }
  if (options.awaited != "balanced") {
    const Mode mode = mode_of(options.awaited);
    wait_for_mode(asker, mode, limit_ns);
    std::printf("%s\n", std::string(name_of(mode)).c_str());
    return;
  }
  wait_for_balance(asker, {radians(options.tilt_deg), nanoseconds(options.for_s)}, limit_ns);
  std::printf("balanced: within %g deg for %g s\n", options.tilt_deg, options.for_s);
}

int run(const Command& app, const RigOptions& rig_options, const Options& options) {
  const std::string name = app.given_subcommand();
  if (name == "modes") {
    const TableStyle style = options.markdown ? TableStyle::kMarkdown : TableStyle::kText;
    std::fputs(mode_table(style).c_str(), stdout);
    return kDone;
  }
  const Rig rig = rig_options.load();
  if (name.empty()) throw UsageError("what to do, e.g. status, is required");
  if (options.awaited == "balanced" && rig.build_machine().layout.tilts() == 0) {
    throw Error("wait balanced: rig " + rig.name +
                " cannot tilt, so there is no balance to wait for; `wait running` can be had");
  }
  MonotonicClock clock;
  Asker asker(rig, clock);
  if (name == "status") {
    const Sighting seen = sight(rig, asker);
    std::fputs((options.json ? report_json(seen) : report(seen)).c_str(), stdout);
    return seen.owner ? kDone : kNotDone;
  }
  if (name == "wait") {
    wait(asker, options);
    return kDone;
  }
  const Verb& verb = *std::ranges::find(kVerbs, name, &Verb::name);
  const reply_t reply = ask_or_throw(asker, request_of(verb, options, rig), name);
  std::printf("%s\n", applied_line(verb, reply).c_str());
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Asks the owner of a rig (integrator or hardware) for something, or shows how it is.",
      "gyrotwin-ctl");
  app.footer(
      "Exit code 0: done; 1: refused, or not in time; 2: asked wrongly.\n"
      "Examples:\n"
      "  gyrotwin ctl arm && gyrotwin ctl wait balanced\n"
      "  gyrotwin ctl --rig double_brennan reset --initial thx=0.05\n"
      "  gyrotwin ctl status --json");
  const gyrotwin::RigOptions rig_options(app);
  gyrotwin::Options options;
  gyrotwin::add_verbs(app, options);
  gyrotwin::add_observers(app, options);
  return app.run(argc, argv, [&] { return run(app, rig_options, options); });
}
