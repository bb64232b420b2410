// gyrotwin-key: the secret that a rig's messages are signed with.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "clients/key/check.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/key.hpp"

namespace gyrotwin {

namespace {

int make_new(const Rig& rig) {
  const std::filesystem::path path = key_path(rig.name);
  create_key(path);
  std::printf("new key %s in %s\n", fingerprint(load_key(path)).c_str(), path.c_str());
  if (rig.network.sign) {
    std::printf(
        "To reach the rig from another host or user, give them this file, mode 0600;\n"
        "`gyrotwin key check` there says whether they have the same.\n");
  } else {
    std::printf("Rig %s does not use it: network.sign = false in %s\n", rig.name.c_str(),
                rig.file.c_str());
  }
  return kDone;
}

int show_id(const Rig& rig) {
  const std::filesystem::path path = key_path(rig.name);
  std::printf("key %s in %s\n", fingerprint(load_key(path)).c_str(), path.c_str());
  return kDone;
}

int check(const Rig& rig, double seconds) {
  std::vector<Finding> findings = examine_key(rig);
  const auto good = [&] { return std::ranges::all_of(findings, &Finding::good); };
  const bool sound = good();
  if (sound) findings.push_back(judge(listen(rig, seconds)));
  for (const Finding& finding : findings) {
    std::printf("%s  %s\n", finding.good ? "good " : "WRONG", finding.text.c_str());
  }
  if (sound) {
    std::printf("key %s\n", fingerprint(load_key(key_path(rig.name))).c_str());
  } else {
    std::printf("The bus was not listened to.\n");
  }
  return good() ? kDone : kNotDone;
}

int print_path(const Rig& rig) {
  std::printf("%s\n", key_path(rig.name).c_str());
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "The key of a rig: with it every message is signed and checked, so that only who has it can "
      "steer or mislead the platform. Content is not hidden.",
      "gyrotwin-key");
  app.footer(
      "Keys are in $GYROTWIN_KEYS, or else $XDG_CONFIG_HOME/gyrotwin, or ~/.config/gyrotwin.\n"
      "Example:\n"
      "  gyrotwin key new --rig prototype_b\n"
      "  gyrotwin key check --rig prototype_b");
  const gyrotwin::RigOptions rig_options(app);
  gyrotwin::Command make =
      app.add_subcommand("new", "Make the rig's key; one that is there is kept");
  gyrotwin::Command show =
      app.add_subcommand("show-id", "Print a fingerprint of the key, to compare hosts");
  gyrotwin::Command check = app.add_subcommand(
      "check", "Whether the key is fit for use here, and whether others on the bus have the same");
  double seconds = 1.0;
  check.add_option("--for", seconds, "How long to listen to the bus, wall time [s]")
      .type("S")
      .shows_default()
      .check(gyrotwin::number_within(0.1, 3600.0).untold());
  gyrotwin::Command path = app.add_subcommand("path", "Print where the key is");
  return app.run(argc, argv, [&] {
    const gyrotwin::Rig rig = rig_options.load();
    if (make.given()) return gyrotwin::make_new(rig);
    if (show.given()) return gyrotwin::show_id(rig);
    if (check.given()) return gyrotwin::check(rig, seconds);
    if (path.given()) return gyrotwin::print_path(rig);
    throw gyrotwin::UsageError("new, show-id, check or path is required");
  });
}
