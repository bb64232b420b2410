// The physics beside other people's engines, as JSON lines. README.md
#include <algorithm>
#include <cstdio>

#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "tests/bench/plant/acceleration.hpp"
#include "tests/bench/plant/arithmetic.hpp"
#include "tests/bench/plant/callgrind.hpp"
#include "tests/bench/plant/tick.hpp"

int main(int argc, char** argv) {
  using namespace gyrotwin;
  gyrotwin::CommandLine app("The plant's accelerations and ticks beside MuJoCo, DART and Simbody.",
                            "plant_bench");
  double seconds = 1.0;
  app.add_option("--seconds", seconds, "of each case").check(number_within(0.01, 1000.0));
  std::vector<std::string> only{"acceleration", "tick", "arithmetic"};
  app.add_option("--only", only, "figures").separated_by(',').check(one_of(only));
  std::vector<std::string> rigs = bench::contest_rigs();
  app.add_option("--rigs", rigs, "of those that are measured")
      .separated_by(',')
      .check(one_of(bench::contest_rigs()));
  bool instructions = false, under_callgrind = false, alone = false;
  app.add_flag("--instructions", instructions,
               "count the instructions of accelerations instead, by valgrind");
  app.add_flag("--under-callgrind", under_callgrind, "what --instructions runs").group("");
  app.add_flag("--alone-under-callgrind", alone, "the same without peers").group("");

  const auto among = [](const std::vector<std::string>& chosen, const std::string& name) {
    return std::find(chosen.begin(), chosen.end(), name) != chosen.end();
  };
  return app.run(argc, argv, [&] {
    if (under_callgrind || alone) {
      bench::pass_under_callgrind(rigs, !alone);
      return kDone;
    }
    if (instructions) {
      bench::count_instructions(rigs);
      return kDone;
    }
    if (among(only, "acceleration")) {
      for (const std::string& rig : rigs) {
        bench::Contest contest = bench::contest(rig);
        bench::time_accelerations(contest, seconds);
      }
    }
    if (among(only, "tick")) {
      for (const std::string& rig : bench::tick_rigs()) {
        if (among(rigs, rig)) bench::measure_ticks(rig, seconds);
      }
    }
    if (among(only, "arithmetic")) {
      try {
        bench::measure_arithmetic(rigs, seconds);
      } catch (const Error& error) {
        std::fprintf(stderr, "the arithmetic is left out: %s\n", error.what());
      }
    }
    return kDone;
  });
}
