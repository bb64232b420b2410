// The twin's uncertainty is what its errors really are: normalised errors and innovations over many
// runs against their chi-square bounds. The rigs do what the filter reckons with: their unknown
// moment walks.
#include <gtest/gtest.h>

#include "services/onboard/noise.hpp"
#include "tests/support/twin_bench.hpp"

namespace gyrotwin {
namespace {

using support::TwinBench;

struct Case {
  const char* rig;
  int runs;
  double seconds;
  double moment_walk;  ///< mirror.moment_walk_share
  double model_noise;  ///< mirror.model_noise_share; the simulated rigs have none
  double least, most;  ///< of the mean NEES per number
};

/// U, as the filter has it [N m/rad].
double toppling(const Rig& rig) {
  return std::visit(
      [](const auto& p) {
        if constexpr (requires { model::reduce(p).U; }) return model::reduce(p).U;
        return 0.0;
      },
      rig.machine);
}

class Consistency : public testing::TestWithParam<Case> {};

TEST_P(Consistency, ErrorsAreAsLargeAsTheyAreSaidToBe) {
  const Case& c = GetParam();
  double nees = 0.0, moment = 0.0;
  std::array<double, kHealthSensors> nis{}, channels{};
  int numbers = 0, moments = 0;
  for (int run = 1; run <= c.runs; ++run) {
    TwinBench bench(c.rig, {},
                    {"sensors.seed=" + std::to_string(run),
                     "mirror.model_noise_share=" + std::to_string(c.model_noise),
                     "mirror.moment_walk_share=" + std::to_string(c.moment_walk)});
    const double step = c.moment_walk * toppling(bench.rig) * std::sqrt(bench.rig.loop.tick_s());
    Eigen::Vector3d walk = Eigen::Vector3d::Zero();
    bench.disturb = [&](TwinBench& b, model::Input& input) {
      for (int i = 0; i < b.machine.layout.tilts(); ++i) {
        walk[i] += step * normal(static_cast<std::uint64_t>(run), 900u + static_cast<unsigned>(i),
                                 static_cast<std::uint64_t>(b.tick));
      }
      input.moment += walk;
    };
    const auto end = std::llround(c.seconds * bench.rig.loop.rate_hz);
    for (std::int64_t k = 0; k < end; ++k) {
      ASSERT_TRUE(bench.step());
      if (2 * k < end) continue;
      for (int s = 0; s < kHealthSensors; ++s) {
        nis[s] += bench.follower.innovations()[s].nis;
        channels[s] += bench.follower.innovations()[s].channels;
      }
    }
    ASSERT_EQ(bench.follower.losses(), 0) << run;
    // Errors of one run hang together, those of different runs do not: one look a run.
    nees += bench.nees();
    numbers += bench.follower.dimension();
    const Estimate& e = bench.follower.estimate();
    for (int i = 0; i < bench.machine.layout.tilts(); ++i) {
      const double off = (e.external_moment[i] - walk[i]) / e.external_moment_sigma[i];
      moment += off * off;
      ++moments;
    }
  }
  RecordProperty("nees_percent", static_cast<int>(100.0 * nees / numbers));
  std::printf("%s: NEES %.3f, moment %.3f, NIS", c.rig, nees / numbers, moment / moments);
  EXPECT_GT(nees / numbers, c.least);
  EXPECT_LT(nees / numbers, c.most);
  EXPECT_LT(moment / moments, 1.0 + 4.0 * std::sqrt(2.0 / moments));
  for (int s = 0; s < kHealthSensors; ++s) {
    if (channels[s] == 0.0) continue;
    std::printf(" %.3f", nis[s] / channels[s]);
    // Innovations of a consistent filter are independent: 5 sigma, and 5 % for the encoders'
    // rounding and for what the rotors' filter adds of itself.
    const double bound = 5.0 * std::sqrt(2.0 / channels[s]) + 0.05;
    EXPECT_NEAR(nis[s] / channels[s], 1.0, bound) << "sensor " << s;
  }
  std::printf("\n");
}

// Bounds: 4 sigma of chi-square per number, sqrt(2 / (runs dimension)). Where least is 0 the filter
// is more careful than it need be, see services/mirror/README.md.
INSTANTIATE_TEST_SUITE_P(Of, Consistency,
                         testing::Values(Case{"double_brennan", 20, 2.0, 0.02, 0.0, 0.55, 1.45},
                                         Case{"brennan_monorail", 30, 2.0, 0.02, 0.0, 0.48, 1.52},
                                         Case{"gyrocar", 30, 2.0, 0.02, 0.0, 0.48, 1.52},
                                         Case{"prototype_b", 8, 1.0, 0.05, 0.0, 0.0, 1.7},
                                         Case{"prototype_b_sleeping", 6, 1.0, 0.005, 3e-4, 0.0,
                                              1.67}),
                         [](const auto& c) { return std::string(c.param.rig); });

}  // namespace
}  // namespace gyrotwin
