#include <string>

#include "services/controller/service.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

// Below the owner's, who must notice when this one goes astray.
constexpr int kPriority = 79;

int run(const RigOptions& options, const std::string& on) {
  const Rig rig = options.load();
  Daemon daemon("gyrotwin-controller");
  MonotonicClock clock;
  Bus bus(bus_config(rig, header_t::CONTROLLER));
  ControllerService service(rig, bus, clock, daemon,
                            on == "twin" ? Feedback::kTwin : Feedback::kLive);
  daemon.log(LogLevel::kInfo, "{}", service.law().describe());
  daemon.log(LogLevel::kInfo, "answers {}/STATE of rig {} on {}", on == "twin" ? "TWIN" : "LIVE",
             rig.name, reach(rig));
  if (rig.loop.clock != ClockMode::kLockstep) daemon.become_realtime(kPriority);
  service.run();
  daemon.log(LogLevel::kInfo, "stopped");
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Answers every STATE of the rig's owner with the COMMAND of the law that the rig file names.",
      "gyrotwin-controller");
  const gyrotwin::RigOptions options(app);
  std::string on = "live";
  app.add_option("--on", on,
                 "Whose STATE it answers: live, the owner's, or twin, what the mirror makes of "
                 "SENSORS; when the twin falls silent, no commands are given")
      .check(gyrotwin::one_of({"live", "twin"}).untold())
      .type("live|twin")
      .shows_default();
  return app.run(argc, argv, [&] { return gyrotwin::run(options, on); });
}
