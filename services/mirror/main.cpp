#include "services/mirror/service.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

// Below owner and controller: neither may wait for it.
constexpr int kPriority = 78;

int run(const RigOptions& options) {
  const Rig rig = options.load();
  Daemon daemon("gyrotwin-mirror");
  MonotonicClock clock;
  Bus bus(bus_config(rig, header_t::TWIN));
  MirrorService service(rig, bus, clock, daemon);
  daemon.log(LogLevel::kInfo, "follows rig {} on {}", rig.name, reach(rig));
  if (rig.loop.clock != ClockMode::kLockstep) daemon.become_realtime(kPriority);
  service.run();
  daemon.log(LogLevel::kInfo, "stopped");
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Follows a live rig with a model of it: says where it is, whether it does what the model "
      "does and who is to blame if not, and whether it is about to fall.",
      "gyrotwin-mirror");
  const gyrotwin::RigOptions options(app);
  return app.run(argc, argv, [&] { return gyrotwin::run(options); });
}
