#include "services/controller/service.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

// Below the owner's, who must notice when this one goes astray.
constexpr int kPriority = 79;

int run(const RigOptions& options) {
  const Rig rig = options.load();
  Daemon daemon("gyrotwin-controller");
  MonotonicClock clock;
  Bus bus(bus_config(rig, header_t::CONTROLLER));
  ControllerService service(rig, bus, clock, daemon);
  daemon.log(LogLevel::kInfo, "{}", service.law().describe());
  daemon.log(LogLevel::kInfo, "answers rig {} on {}", rig.name, reach(rig));
  daemon.become_realtime(kPriority);
  service.run();
  daemon.log(LogLevel::kInfo, "stopped");
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  CLI::App app(
      "Answers every STATE of the rig's owner with the COMMAND of the law that the rig file names.",
      "gyrotwin-controller");
  const gyrotwin::RigOptions options(app);
  return gyrotwin::run_program(argc, argv, app, [&] { return gyrotwin::run(options); });
}
