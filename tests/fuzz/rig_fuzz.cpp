// Any text as a rig file, as overrides of one, as a scenario, as overrides of that: it is read, or
// refused with an Error. What is read has the numbers that it may have, and what is in effect reads
// back as the same.
#include <cmath>
#include <string>
#include <vector>

#include "clients/common/scenario.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig_reader.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace gyrotwin {
namespace {

using fuzz::Bytes;
using fuzz::require;
using Strings = std::vector<std::string>;

// The shortest rig.
constexpr std::string_view kRig = R"([rig]
name = "r"
summary = "s"
machine = "gyroscope"
id = 1
[network]
prefix = "R"
group = "239.255.1.1"
port = 7000
interface = "lo"
ttl = 0
[loop]
clock = "realtime"
rate_hz = 1000.0
substeps = 4
[safety]
command_timeout_ticks = 10
fall_tilt_rad = 1.0
safe_stop = "zero_torque"
)";

constexpr std::string_view kScenario = R"([[event]]
kind = "gust"
at_s = 2.0
roll_nm = 0.3
duration_s = 10.0
[[event]]
kind = "sensor"
sensor = "gyro"
at_s = 5.0
bias_rad_s = 0.01
)";

Strings lines(Bytes bytes) {
  Strings all;
  while (!bytes.empty() && all.size() < 32) all.emplace_back(fuzz::text_of(fuzz::cut(bytes, '\n')));
  return all;
}

/// @return what is in effect; empty where the text was refused
std::string read(std::string_view document, const Strings& overrides) {
  try {
    TomlReader reader(document, "rig.toml", overrides);
    const Rig rig = read_rig(reader);
    reader.finish();
    require(std::isfinite(rig.loop.rate_hz) && rig.loop.rate_hz > 0.0);
    require(rig.loop.tick_ns() > 0 && rig.loop.substeps > 0);
    require(rig.safety.command_timeout_ticks >= 1 && rig.safety.command_timeout_ticks <= 10);
    require(std::isfinite(rig.safety.fall_tilt_rad) && std::isfinite(rig.safety.gain));
    require(!rig.name.empty() && !rig.network.prefix.empty());
    require(rig.network.port > 0 && rig.network.port < 65536);
    const model::Machine machine = rig.build_machine();
    require(machine.coordinates() <= model::kMaxCoordinates);
    rig.initial_state(machine);
    return reader.effective();
  } catch (const Error& error) {
    require(!std::string_view(error.what()).empty());
    return {};
  }
}

void rig_file(std::string_view document, const Strings& overrides) {
  const std::string effective = read(document, overrides);
  if (!effective.empty()) require(read(effective, {}) == effective);
}

void scenario(std::string_view document, const Strings& overrides) {
  try {
    double before = 0.0;
    for (const PlannedEvent& planned : read_scenario(document, "scenario.toml", overrides)) {
      require(planned.event.kind != nullptr && planned.at_s >= before && planned.at_s <= 1e6);
      before = planned.at_s;
      for (const auto& [quantity, value] : planned.event.values) require(std::isfinite(value));
    }
  } catch (const Error& error) {
    require(!std::string_view(error.what()).empty());
  }
}

}  // namespace
}  // namespace gyrotwin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gyrotwin;  // NOLINT(google-build-using-namespace)
  if (size == 0) return 0;
  const fuzz::Bytes rest(data + 1, size - 1);
  // A letter, so that the corpus can be read.
  switch (data[0]) {
    case 'r':
      rig_file(fuzz::text_of(rest), {});
      break;
    case 's':
      scenario(fuzz::text_of(rest), {});
      break;
    case 'o':
      rig_file(kRig, lines(rest));
      break;
    case 'v':
      scenario(kScenario, lines(rest));
      break;
    default:
      return -1;
  }
  return 0;
}
