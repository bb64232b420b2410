#include "clients/top/rig_facts.hpp"

#include <algorithm>
#include <limits>

#include "services/runtime/observation_wire.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

double RigFacts::stop_margin(int j, double angle) const {
  const auto i = static_cast<std::size_t>(j);
  return std::min(angle - lower_stop[i], upper_stop[i] - angle);
}

double RigFacts::drive_margin(int i, const state_t& state) const {
  const double rate = machine.drive_rate(i, machine.recall(from_wire(state)));
  const auto [low, high] = machine.drives[static_cast<std::size_t>(i)].range(rate);
  const double torque = state.drive_torque_nm[i];
  return torque >= 0.0 ? high - torque : torque - low;
}

bool RigFacts::is_estimate(const state_t& state) const {
  return estimated || state.header.source == header_t::HARDWARE;
}

RigFacts facts_of(const Rig& rig) {
  RigFacts facts{.machine = rig.build_machine()};
  const model::Machine& machine = facts.machine;
  facts.name = rig.name;
  facts.reach = reach(rig);
  facts.fall_tilt = rig.safety.fall_tilt_rad;
  facts.estimated = rig.loop.state == StateSource::kEstimate;
  facts.gyros = machine.rotors;
  facts.drives = static_cast<int>(machine.drives.size());
  facts.lower_track = machine.track.has_value();
  facts.upper_track = machine.track && machine.track->clearance;
  facts.load_cell = machine.load_cell.has_value();
  facts.nominal_rotor_speed = machine.nominal_rotor_speed;

  constexpr double kNone = std::numeric_limits<double>::infinity();
  facts.lower_stop.fill(-kNone);
  facts.upper_stop.fill(kNone);
  for (std::size_t j = 0; j < machine.layout.gimbals.size(); ++j) {
    const auto& [coordinate, coefficient] = machine.layout.gimbals[j];
    for (const model::Stop& stop : machine.stops) {
      if (coordinate == model::kFixed || stop.coordinate != coordinate) continue;
      const double one = coefficient * stop.lower, other = coefficient * stop.upper;
      facts.lower_stop[j] = std::min(one, other);
      facts.upper_stop[j] = std::max(one, other);
    }
  }
  return facts;
}

}  // namespace gyrotwin
