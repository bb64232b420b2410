// gyrotwin-disturb: pushes the platform, and tells what came of it.
#include <unistd.h>

#include <cstdio>
#include <optional>
#include <string>

#include "clients/common/asker.hpp"
#include "clients/disturb/aftermath.hpp"
#include "clients/disturb/push.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr double kStrongest = 1e9;
constexpr double kLatest = 1e15;                // [tick]
constexpr double kLongest = 3600.0;             // [s]
constexpr double kShownOnTerminal = 3.0;        // [s]
constexpr std::int64_t kStill = 2'000'000'000;  // without a tick: time stands still [ns]

/// What the command line says.
struct Options {
  Push push;
  std::optional<double> duration_s, watch_s;
  std::int64_t start_tick = 0;
};

void add_push(CLI::App& sub, Options& options, const std::string& moment_unit,
              const std::string& force_unit) {
  const auto add = [&](const char* name, double& value, const std::string& what,
                       const std::string& unit) {
    sub.add_option(name, value, what + " [" + unit + "]")
        ->type_name("X")
        ->check(finite_within(-kStrongest, kStrongest).description(""));
  };
  auto& [moment, force] = options.push;
  add("--roll", moment[0], "About x, forward", moment_unit);
  add("--pitch", moment[1], "About y, left", moment_unit);
  add("--yaw", moment[2], "About z, up", moment_unit);
  add("--push-x", force[0], "Along x, at the structure's centre of mass", force_unit);
  add("--push-y", force[1], "Along y", force_unit);
  add("--push-z", force[2], "Along z", force_unit);
}

void add_when(CLI::App& sub, Options& options, const std::string& duration,
              const std::string& watch) {
  sub.add_option("--duration", options.duration_s, duration)
      ->type_name("S")
      ->check(finite_within(1e-9, kLongest).description(""));
  sub.add_option("--at-tick", options.start_tick, "First tick it acts in; default: the next one")
      ->type_name("N")
      ->check(finite_within(1.0, kLatest).description(""));
  sub.add_option("--watch", options.watch_s, watch)
      ->type_name("S")
      ->check(finite_within(0.0, kLongest).description(""));
}

/// Prints what followed. @return its exit code
int watch(Asker& asker, const reply_t& reply, std::int64_t tick_ns, double span_s) {
  Aftermath aftermath(reply, tick_ns, span_s);
  while (!aftermath.over()) {
    const bool went_on = asker.listen(kStill, [&aftermath](const Reception& reception) {
      if (reception.channel != Channel::kState) return false;
      state_t state;
      Bus::decode(reception, state);
      return aftermath.on(state);
    });
    if (!went_on) {
      std::puts("");
      std::fflush(stdout);
      throw NotDone(
          fmt::format("time stands still at tick {}: not watched to the end; `gyrotwin "
                      "ctl status` says why",
                      std::max<std::int64_t>(aftermath.tick(), 0)));
    }
  }
  std::printf(": %s\n", aftermath.text().c_str());
  return aftermath.fell() ? kNotDone : kDone;
}

int push(const Rig& rig, Asker& asker, const Options& options, bool impulse) {
  Options what = options;
  if (impulse && what.push.nothing()) what.push.moment[0] = rig.reference_impulse_nms;
  if (what.push.nothing()) throw Error("step: no load was named; give one, e.g. --roll 0.5");
  const std::int64_t tick_ns = asker.owner().tick_period_ns;
  if (tick_ns <= 0) throw NotDone("the owner's STATUS names no tick period");

  const Timing timing{
      .duration_s = what.duration_s.value_or(impulse ? rig.impulse_duration_s : 0.0),
      .start_tick = what.start_tick};
  const request_t request = impulse ? impulse_request(what.push, timing, tick_ns)
                                    : load_request(what.push, timing, tick_ns);
  const reply_t reply = ask_or_throw(asker, request, "disturb");

  if (impulse) {
    std::printf("pushed %s at tick %lld", describe(what.push, " s").c_str(),
                static_cast<long long>(reply.applied_tick));
  } else {
    std::printf("loaded %s, %s", describe(what.push, "").c_str(), get_text(reply.text).c_str());
  }
  std::fflush(stdout);
  const bool on_terminal = isatty(STDOUT_FILENO) == 1;
  const double span_s = what.watch_s.value_or(impulse && on_terminal ? kShownOnTerminal : 0.0);
  if (span_s > 0.0) return watch(asker, reply, tick_ns, span_s);
  std::printf("\n");
  return kDone;
}

int clear(Asker& asker) {
  request_t request{};
  request.verb = request_t::CLEAR;
  std::printf("%s\n", get_text(ask_or_throw(asker, request, "clear").text).c_str());
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  CLI::App app("Pushes the platform and tells what came of it.", "gyrotwin-disturb");
  app.footer(
      "Exit code 0: done; 1: refused, not in time, or it fell while watched; 2: asked wrongly.\n"
      "Examples:\n"
      "  gyrotwin disturb impulse          # the rig's reference push\n"
      "  gyrotwin disturb impulse --rig double_brennan --pitch 0.3 --watch 5\n"
      "  gyrotwin disturb step --push-y 2 && sleep 5 && gyrotwin disturb clear");
  app.require_subcommand(0, 1);
  const gyrotwin::RigOptions rig_options(app);
  gyrotwin::Options options;

  CLI::App* impulse = app.add_subcommand(
      "impulse", "A short push; without a direction the rig's reference push about x");
  gyrotwin::add_push(*impulse, options, "N m s", "N s");
  gyrotwin::add_when(*impulse, options,
                     "How long it lasts, rounded to ticks [s]; default: the rig's "
                     "impulse_duration_s",
                     "Watch the tilt for so long [s]; default: 3 on a terminal");
  CLI::App* step = app.add_subcommand("step", "A constant load from now on");
  gyrotwin::add_push(*step, options, "N m", "N");
  gyrotwin::add_when(*step, options, "How long it lasts [s]; default: until clear",
                     "Watch the tilt for so long [s]");
  CLI::App* clear = app.add_subcommand("clear", "End all disturbances, also those to come");

  return gyrotwin::run_program(argc, argv, app, [&] {
    const gyrotwin::Rig rig = rig_options.load();
    if (app.get_subcommands().empty()) throw CLI::RequiredError("impulse, step or clear");
    gyrotwin::MonotonicClock clock;
    gyrotwin::Asker asker(rig, clock);
    if (clear->parsed()) return gyrotwin::clear(asker);
    return gyrotwin::push(rig, asker, options, impulse->parsed());
  });
}
