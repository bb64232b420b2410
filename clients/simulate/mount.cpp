#include "clients/simulate/mount.hpp"

#include <algorithm>
#include <charconv>
#include <variant>

#include "services/model/umbrella.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/machine_reader.hpp"

namespace gyrotwin {

namespace {

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

void choose_mount(RigOptions& rig_options, const std::string& mount, const std::string& track) {
  if (mount.empty() && track.empty()) return;
  const Rig rig = load_rig(rig_options.name(), rig_options.overrides());
  const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine);
  if (!umbrella) {
    throw Error("rig " + rig.name +
                " has gimballed gyros; only an umbrella platform has a mount and a track");
  }
  if (!track.empty()) rig_options.override_key("umbrella.track=" + track);
  const auto chosen = std::find_if(kMountWords.begin(), kMountWords.end(),
                                   [&](const auto& word) { return word.name == mount; });
  if (chosen == kMountWords.end()) return;

  const model::Machine before = model::build(*umbrella);
  model::UmbrellaParameters remounted = *umbrella;
  remounted.mount = chosen->value;
  const model::Machine after = model::build(remounted);
  const model::State start =
      after.recall(before.observe(before.state(rig.initial_q, rig.initial_v)));
  const int n = after.coordinates();
  rig_options.override_key("umbrella.mount=" + mount);
  rig_options.override_key("initial.q=" + toml_list(start.q, n));
  rig_options.override_key("initial.v=" + toml_list(start.v, n));
}

}  // namespace gyrotwin
