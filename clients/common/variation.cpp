#include "clients/common/variation.hpp"

#include <vector>

#include "clients/common/mount.hpp"
#include "services/runtime/machine_reader.hpp"
#include "services/runtime/rig_reader.hpp"

namespace gyrotwin {

namespace {

template <class Words>
std::vector<std::string> names_of(const Words& words) {
  std::vector<std::string> names;
  for (const auto& word : words) names.emplace_back(word.name);
  return names;
}

}  // namespace

void add_variation(CLI::App& app, Variation& variation) {
  app.add_option("--law", variation.law, "Control law instead of the rig file's, or none")
      ->check(one_of(names_of(kLawWords)))
      ->type_name("NAME");
  app.add_option("--mount", variation.mount,
                 "How the disc sits on the structure (umbrella platforms)")
      ->check(one_of(names_of(kMountWords)));
  app.add_option("--track", variation.track, "What the outer axles ride on (umbrella platforms)")
      ->check(one_of(names_of(kTrackWords)));
}

void apply(const Variation& variation, RigOptions& rig_options) {
  choose_mount(rig_options, variation.mount, variation.track);
  if (!variation.law.empty()) rig_options.override_key("controller.law=" + variation.law);
}

}  // namespace gyrotwin
