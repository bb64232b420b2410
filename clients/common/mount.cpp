#include "clients/common/mount.hpp"

#include <cstddef>
#include <variant>

namespace gyrotwin {

Rig with_mount(Rig rig, model::Mount mount) {
  auto& umbrella = std::get<model::UmbrellaParameters>(rig.machine);
  const model::Machine before = model::build(umbrella);
  umbrella.mount = mount;
  const model::Machine after = model::build(umbrella);
  const model::State start =
      after.recall(before.observe(before.state(rig.initial_q, rig.initial_v)));
  const auto n = static_cast<std::size_t>(after.coordinates());
  rig.initial_q.assign(start.q.data(), start.q.data() + n);
  rig.initial_v.assign(start.v.data(), start.v.data() + n);
  return rig;
}

bool held_level(const Rig& rig) {
  const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine);
  return umbrella != nullptr && umbrella->mount == model::Mount::kLevel;
}

}  // namespace gyrotwin
