#include "services/hardware/service.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr int kPriority = 80;

int run(RigOptions& options, const std::string& device, const std::string& baud) {
  if (!device.empty()) options.override_key("hardware.device=\"" + device + "\"");
  if (!baud.empty()) options.override_key("hardware.baud=" + baud);
  const Rig rig = options.load();
  if (rig.hardware.device.empty()) {
    throw Error(rig.file.string() +
                ": no line to a device; give the file [hardware] device, or --device PATH");
  }
  Daemon daemon("gyrotwin-hardware");
  MonotonicClock clock;
  Line line(rig.hardware.device, rig.hardware.baud);
  Bus bus(bus_config(rig, header_t::HARDWARE));
  claim(rig, bus, clock, daemon);
  HardwareService service(rig, line, bus, clock, daemon);
  daemon.log(LogLevel::kInfo, "owns rig {} on {}, heard on {}", rig.name, line.path(), reach(rig));
  daemon.become_realtime(kPriority);
  service.run();
  daemon.log(LogLevel::kInfo, "stopped");
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Owns a real plant: its device's SENSORS become STATE, COMMAND goes down the line, REQUEST "
      "is answered. Starts HELD, drives off; `gyrotwin ctl arm` lets go.",
      "gyrotwin-hardware");
  gyrotwin::RigOptions options(app);
  std::string device, baud;
  app.add_option("--device", device, "Terminal of the device; short for --set hardware.device=")
      .type("PATH");
  app.add_option("--baud", baud, "Rate of a UART; short for --set hardware.baud=").type("N");
  return app.run(argc, argv, [&] { return gyrotwin::run(options, device, baud); });
}
