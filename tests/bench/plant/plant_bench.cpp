// The physics beside other people's engines, as JSON lines. README.md
#include <algorithm>

#include "services/runtime/cli.hpp"
#include "tests/bench/plant/acceleration.hpp"
#include "tests/bench/plant/tick.hpp"

int main(int argc, char** argv) {
  using namespace gyrotwin;
  CLI::App app("The plant's accelerations and ticks beside MuJoCo, DART and Simbody.",
               "plant_bench");
  double seconds = 1.0;
  app.add_option("--seconds", seconds, "of each case")->check(finite_within(0.01, 1000.0));
  std::vector<std::string> only;
  app.add_option("--only", only, "figures")
      ->delimiter(',')
      ->check(one_of({"acceleration", "tick"}));
  std::vector<std::string> rigs;
  app.add_option("--rigs", rigs, "of those that are measured")->delimiter(',');

  const auto among = [](const std::vector<std::string>& chosen, const std::string& name) {
    return chosen.empty() || std::find(chosen.begin(), chosen.end(), name) != chosen.end();
  };
  return run_program(argc, argv, app, [&] {
    if (among(only, "acceleration")) {
      for (const std::string& rig : bench::contest_rigs()) {
        if (!among(rigs, rig)) continue;
        bench::Contest contest = bench::contest(rig);
        bench::time_accelerations(contest, seconds);
      }
    }
    if (among(only, "tick")) {
      for (const std::string& rig : bench::tick_rigs()) {
        if (among(rigs, rig)) bench::measure_ticks(rig, seconds);
      }
    }
    return kDone;
  });
}
