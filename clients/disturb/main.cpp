// gyrotwin-disturb: disturbs the platform and breaks parts of it, and tells what came of it.
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>

#include "clients/common/asker.hpp"
#include "clients/common/scenario.hpp"
#include "clients/disturb/aftermath.hpp"
#include "clients/disturb/options.hpp"
#include "clients/disturb/play.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr double kShownOnTerminal = 3.0;        // [s]
constexpr std::int64_t kStill = 2'000'000'000;  // without a tick: time stands still [ns]
constexpr std::int64_t kMostNumbers = 1'000'000'000'000'000;

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

int cause(const Rig& rig, Asker& asker, const AskedEvent& event, const EventOptions& options) {
  const std::int64_t tick_ns = asker.owner().tick_period_ns;
  if (tick_ns <= 0) throw NotDone("the owner's STATUS names no tick period");
  request_t request = request_of(event, rig, tick_ns);
  request.start_tick = options.start_tick();
  const reply_t reply = ask_or_throw(asker, request, std::string(event.kind->name));
  std::printf("%s", get_text(reply.text).c_str());
  std::fflush(stdout);

  const bool shown = event.kind->name == "impulse" && isatty(STDOUT_FILENO) == 1;
  const double span_s = options.watch_s().value_or(shown ? kShownOnTerminal : 0.0);
  if (span_s > 0.0) return watch(asker, reply, tick_ns, span_s);
  std::printf("\n");
  return kDone;
}

int end(Asker& asker, std::int32_t verb, std::int64_t id) {
  request_t request{};
  request.verb = verb;
  request.id = id;
  const std::string what = verb == request_t::CLEAR ? "clear" : "cancel";
  std::printf("%s\n", get_text(ask_or_throw(asker, request, what).text).c_str());
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app("Disturbs the platform, breaks parts of it, and tells what came of it.",
                            "gyrotwin-disturb");
  app.footer(
      "Whatever is asked for is answered with its number and its ticks, or refused. It ends after\n"
      "its --duration, with cancel, with clear, or with a reset. World frame: x forward, y left, "
      "z up.\n"
      "Exit code 0: done; 1: refused, not in time, or it fell while watched; 2: asked wrongly.\n"
      "Examples:\n"
      "  gyrotwin disturb impulse          # the rig's reference push\n"
      "  gyrotwin disturb impulse --rig double_brennan --pitch 0.3 --watch 5\n"
      "  gyrotwin disturb step --push-y 2 && sleep 5 && gyrotwin disturb clear\n"
      "  gyrotwin disturb gust --roll 0.6 --pitch 0.6 --duration 20\n"
      "  gyrotwin disturb rotor 2 --watch 10\n"
      "  gyrotwin disturb play push_and_gust");
  const gyrotwin::RigOptions rig_options(app);
  const gyrotwin::EventOptions options(app);
  std::int64_t id = 0;
  gyrotwin::Command cancel = app.add_subcommand("cancel", "End one, or keep it from beginning");
  cancel.add_option("number", id, "Of the disturbance or fault, from its answer")
      .required()
      .type("N")
      .check(gyrotwin::whole_within(1, gyrotwin::kMostNumbers).untold());
  gyrotwin::Command clear = app.add_subcommand("clear", "End all, also those to come");
  std::string scenario;
  gyrotwin::Command play = app.add_subcommand(
      "play", "All events of a scenario file; their times count from now, or from arming");
  play.add_option("scenario", scenario, "Scenario file, or the name of a shipped scenario")
      .required()
      .type("NAME|FILE");

  return app.run(argc, argv, [&] {
    const gyrotwin::Rig rig = rig_options.load();
    const auto planned =
        play.given() ? gyrotwin::load_scenario(scenario) : std::vector<gyrotwin::PlannedEvent>{};
    const auto event = options.chosen();
    if (app.given_subcommand().empty()) {
      throw gyrotwin::UsageError("what to do, e.g. impulse, is required");
    }
    gyrotwin::MonotonicClock clock;
    gyrotwin::Asker asker(rig, clock);
    if (event) return gyrotwin::cause(rig, asker, *event, options);
    if (cancel.given()) return gyrotwin::end(asker, gyrotwin::request_t::CANCEL, id);
    if (clear.given()) return gyrotwin::end(asker, gyrotwin::request_t::CLEAR, 0);
    gyrotwin::play(asker, rig, planned);
    return static_cast<int>(gyrotwin::kDone);
  });
}
