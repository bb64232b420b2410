#include "clients/analyze/loads.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gyrotwin {

Scenario::Event event_at(const Rig& rig, const AskedEvent& asked, double begin, std::string place) {
  request_t request = request_of(asked, rig, rig.loop.tick_ns());
  request.start_tick = std::max(std::llround(begin / rig.loop.tick_s()), 1LL);
  return {request, std::move(place)};
}

Scenario push_scenario(const Rig& rig, const model::Machine& machine, double push_at,
                       double duration) {
  Scenario scenario = live_scenario(rig, machine, duration);
  if (rig.reference_impulse_nms == 0.0) return scenario;
  AskedEvent push;
  push.kind = event_kind("impulse");
  scenario.events = {event_at(rig, push, push_at, "reference push")};
  return scenario;
}

}  // namespace gyrotwin
