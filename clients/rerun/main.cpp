// gyrotwin-rerun: a record once more through mirror or controller.
#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <string>
#include <vector>

#include "clients/rerun/rerun.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

struct Options {
  std::string file, output;
  std::vector<std::string> overrides;
  std::string on = "live";
};

/// A log of what is made, which says of itself what it is.
class Output {
 public:
  Output(const std::string& path, const Log& log, const Rig& rig) : prefix_(rig.network.prefix) {
    if (path.empty()) return;
    writer_.emplace(path);
    const Identity identity;
    const About about{.program = "gyrotwin-rerun " GYROTWIN_VERSION,
                      .host = identity.host,
                      .rig = rig.name,
                      .prefix = prefix_,
                      .rig_id = rig.id,
                      .key = "",
                      .channels = channels_of(prefix_)};
    events_ = opening_events(about, lcm_sources(), log.catalog().rig_file(), 0);
  }

  void take(Channel channel, std::span<const std::uint8_t> payload, std::int64_t us) {
    if (!writer_) return;
    const std::string name = prefix_ + "/" + std::string(spec(channel).suffix);
    append_event(events_, {.time_us = us, .channel = name, .data = payload});
    if (events_.size() > (1u << 20)) flush();
  }
  void flush() {
    if (!writer_) return;
    writer_->append(events_);
    events_.clear();
  }

 private:
  std::string prefix_;
  std::optional<LogWriter> writer_;
  LogBytes events_;
};

void add_common(Command& sub, Options& options) {
  sub.add_option("file", options.file, "A log of `gyrotwin log record`").required().type("LOG");
  sub.add_option("--output", options.output, "A new log of what is made, unsigned").type("OUT");
  sub.add_option("--set", options.overrides,
                 "Override a key of the rig file that the log carries; repeatable")
      .type("KEY=VALUE")
      .repeatable();
}

std::string outcome(const Account& account) {
  if (account.compared == 0) return "none compared with a recorded one";
  return fmt::format(
      "{} compared with recorded ones: {}", account.compared,
      account.different == 0 ? "identical" : fmt::format("{} differ", account.different));
}

int run(const Options& options, bool mirror) {
  Log log(options.file);
  const Rig rig = rig_of(log, options.file, options.overrides);
  Output output(options.output, log, rig);
  const Take take = [&output](Channel channel, std::span<const std::uint8_t> payload,
                              std::int64_t us) { output.take(channel, payload, us); };
  const RerunOn on = options.on == "twin" ? RerunOn::kTwin : RerunOn::kLive;
  const Account account =
      mirror ? rerun_mirror(log, rig, take) : rerun_controller(log, rig, on, take);
  output.flush();

  if (log.damage().any()) {
    std::fprintf(stderr, "%s is damaged: %s\n", options.file.c_str(), log.damage_text().c_str());
  }
  fmt::print("{}: {} messages heard, {} made; {}\n", rig.name, account.heard, account.made,
             outcome(account));
  if (account.unknown > 0 && account.compared > 0) {
    fmt::print("not compared: {} messages; {}\n", account.unknown, account.why_unknown);
  }
  const std::string trouble = in_vain(account);
  if (!trouble.empty()) throw NotDone(options.file + ": " + trouble);
  if (account.different == 0) return kDone;
  std::printf("first: %s\n", account.first_difference.c_str());
  return kNotDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Feeds a record to mirror or controller once more, offline: the same log gives the same "
      "bytes. What they make is compared with what was recorded of them.",
      "gyrotwin-rerun");
  app.footer(
      "Compared is what hangs on the record alone: of a run that it has from the start, until an "
      "answer is missing.\n"
      "Exit code 0: nothing differs; 1: something does, or nothing could be compared; 2: asked "
      "wrongly.\n"
      "Examples:\n"
      "  gyrotwin rerun mirror run.lcm --output twin.lcm\n"
      "  gyrotwin rerun controller run.lcm");
  gyrotwin::Options options;

  gyrotwin::Command mirror = app.add_subcommand("mirror", "SENSORS and COMMAND to the mirror");
  gyrotwin::add_common(mirror, options);
  gyrotwin::Command controller = app.add_subcommand("controller", "STATE to the controller");
  gyrotwin::add_common(controller, options);
  controller.add_option("--on", options.on, "Whose STATE the recorded controller answered")
      .check(gyrotwin::one_of({"live", "twin"}).untold())
      .type("live|twin")
      .shows_default();

  return app.run(argc, argv, [&] {
    if (mirror.given()) return gyrotwin::run(options, true);
    if (controller.given()) return gyrotwin::run(options, false);
    throw gyrotwin::UsageError("mirror or controller is required");
  });
}
