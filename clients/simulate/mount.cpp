#include "clients/simulate/mount.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>
#include <variant>

#include "services/model/umbrella.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::array<std::pair<const char*, model::Mount>, 3> kMounts{
    {{"level", model::Mount::kLevel},
     {"universal_joint", model::Mount::kUniversalJoint},
     {"rigid", model::Mount::kRigid}}};

/// `[a, b]` with every bit.
std::string toml_list(const model::Coordinates& values, int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i) {
    std::array<char, 32> number;
    const auto result = std::to_chars(number.data(), number.data() + number.size(), values[i],
                                      std::chars_format::scientific);
    text += (i > 0 ? ", " : "") + std::string(number.data(), result.ptr);
  }
  return text + "]";
}

}  // namespace

std::vector<std::string> mount_names() {
  std::vector<std::string> names;
  for (const auto& [name, mount] : kMounts) names.emplace_back(name);
  return names;
}

void choose_mount(RigOptions& rig_options, const std::string& mount, const std::string& track) {
  if (mount.empty() && track.empty()) return;
  const Rig rig = load_rig(rig_options.name(), rig_options.overrides());
  const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine);
  if (!umbrella) {
    throw Error("rig " + rig.name +
                " has gimballed gyros; only an umbrella platform has a mount and a track");
  }
  if (!track.empty()) rig_options.override_key("umbrella.track=" + track);
  const auto chosen = std::find_if(kMounts.begin(), kMounts.end(),
                                   [&](const auto& word) { return word.first == mount; });
  if (chosen == kMounts.end()) return;

  const model::Machine before = model::build(*umbrella);
  model::UmbrellaParameters remounted = *umbrella;
  remounted.mount = chosen->second;
  const model::Machine after = model::build(remounted);
  const model::State start =
      after.recall(before.observe(before.state(rig.initial_q, rig.initial_v)));
  const int n = after.coordinates();
  rig_options.override_key("umbrella.mount=" + mount);
  rig_options.override_key("initial.q=" + toml_list(start.q, n));
  rig_options.override_key("initial.v=" + toml_list(start.v, n));
}

}  // namespace gyrotwin
