// The physics beside other people's engines, as JSON lines. README.md
#include "services/runtime/cli.hpp"
#include "tests/bench/plant/acceleration.hpp"

int main(int argc, char** argv) {
  using namespace gyrotwin;
  CLI::App app("The plant's accelerations and ticks beside MuJoCo, DART and Simbody.",
               "plant_bench");
  double seconds = 1.0;
  app.add_option("--seconds", seconds, "of each case")->check(finite_within(0.01, 1000.0));
  std::vector<std::string> rigs = bench::contest_rigs();
  app.add_option("--rigs", rigs, "which, of those that are measured")->delimiter(',');
  return run_program(argc, argv, app, [&] {
    for (const std::string& rig : rigs) {
      bench::Contest contest = bench::contest(rig);
      bench::time_accelerations(contest, seconds);
    }
    return kDone;
  });
}
