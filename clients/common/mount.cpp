#include "clients/common/mount.hpp"

#include <algorithm>
#include <charconv>
#include <variant>

#include "services/runtime/error.hpp"
#include "services/runtime/machine_reader.hpp"

namespace gyrotwin {

namespace {

/// `[a, b]` with every bit.
std::string toml_list(const std::vector<double>& values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::array<char, 32> number;
    const auto result = std::to_chars(number.data(), number.data() + number.size(), values[i],
                                      std::chars_format::scientific);
    text += (i > 0 ? ", " : "") + std::string(number.data(), result.ptr);
  }
  return text + "]";
}

}  // namespace

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

void choose_mount(RigOptions& rig_options, const std::string& mount, const std::string& track) {
  if (mount.empty() && track.empty()) return;
  const Rig rig = load_rig(rig_options.name(), rig_options.overrides());
  if (!std::holds_alternative<model::UmbrellaParameters>(rig.machine)) {
    throw Error("rig " + rig.name +
                " has gimballed gyros; only an umbrella platform has a mount and a track");
  }
  if (!track.empty()) rig_options.override_key("umbrella.track=" + track);
  const auto chosen = std::find_if(kMountWords.begin(), kMountWords.end(),
                                   [&](const auto& word) { return word.name == mount; });
  if (chosen == kMountWords.end()) return;
  const Rig remounted = with_mount(rig, chosen->value);
  rig_options.override_key("umbrella.mount=" + mount);
  rig_options.override_key("initial.q=" + toml_list(remounted.initial_q));
  rig_options.override_key("initial.v=" + toml_list(remounted.initial_v));
}

}  // namespace gyrotwin
