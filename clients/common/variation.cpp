#include "clients/common/variation.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <variant>
#include <vector>

#include "clients/common/mount.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/machine_reader.hpp"
#include "services/runtime/rig_reader.hpp"

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

/// Overrides the rig's mount and track where they are not empty, as with_mount() does.
/// @throws Error when the rig is wrong or no umbrella platform
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

}  // namespace

void add_variation(Command& app, Variation& variation) {
  app.add_option("--law", variation.law, "Control law instead of the rig file's, or none")
      .check(one_of(names_of(kLawWords)))
      .type("NAME");
  app.add_option("--mount", variation.mount,
                 "How the disc sits on the structure (umbrella platforms)")
      .check(one_of(names_of(kMountWords)));
  app.add_option("--track", variation.track, "What the outer axles ride on (umbrella platforms)")
      .check(one_of(names_of(kTrackWords)));
}

void apply(const Variation& variation, RigOptions& rig_options) {
  choose_mount(rig_options, variation.mount, variation.track);
  if (!variation.law.empty()) rig_options.override_key("controller.law=" + variation.law);
}

}  // namespace gyrotwin
