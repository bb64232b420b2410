#include "services/integrator/service.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

constexpr int kPriority = 80;

/// The rig's own substeps must do for its own tolerance.
void check_stepping(const Rig& rig, Daemon& daemon) {
  const double error = stepping_error(rig, rig.build_machine());
  if (!(error <= rig.loop.step_tolerance)) {
    throw Error(
        fmt::format("{}: {} substeps a tick are off by {:.2g} rad over the check, more than "
                    "loop.step_tolerance_rad = {:g}; raise loop.substeps",
                    rig.file.string(), rig.loop.substeps, error, rig.loop.step_tolerance));
  }
  daemon.log(LogLevel::kInfo, "{} substeps a tick: off by {:.2g} rad over the check",
             rig.loop.substeps, error);
}

int run(const RigOptions& options) {
  const Rig rig = options.load();
  Daemon daemon("gyrotwin-integrator");
  check_stepping(rig, daemon);
  MonotonicClock clock;
  Bus bus(bus_config(rig, header_t::SIMULATION));
  claim(rig, bus, clock, daemon);
  IntegratorService service(rig, bus, clock, daemon);
  daemon.log(LogLevel::kInfo, "owns rig {} at {:g} Hz, heard on {}", rig.name, rig.loop.rate_hz,
             reach(rig));
  // In lockstep nothing has a deadline, and who answers at once leaves others no processor.
  if (rig.loop.clock != ClockMode::kLockstep) daemon.become_realtime(kPriority);
  service.run();
  daemon.log(LogLevel::kInfo, "stopped");
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Owns a simulated plant: publishes its STATE at the rig's rate, obeys COMMAND and answers "
      "REQUEST. Starts HELD; `gyrotwin ctl arm` lets go.",
      "gyrotwin-integrator");
  const gyrotwin::RigOptions options(app);
  return app.run(argc, argv, [&] { return gyrotwin::run(options); });
}
