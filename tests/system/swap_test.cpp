// Whoever owns the plant, simulated or on a line, nobody else notices: the same test, controller
// and rig file, on the estimate that both owners make of the same sensors.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;
using support::OwnerKind;

constexpr double kDegree = M_PI / 180.0;

/// Ticks long enough for a busy machine: ten of them are 40 ms.
const std::vector<std::string> kSlowTicks{"loop.state=estimate", "loop.rate_hz=250",
                                          "loop.substeps=16"};

class Swap : public testing::TestWithParam<OwnerKind> {};

double tilt_in(const Reception& reception) {
  state_t state;
  Bus::decode(reception, state);
  return std::hypot(state.tilt_rad[0], state.tilt_rad[1]);
}

/// Waits for a STATE whose tilt satisfies `holds`. @return the largest tilt on the way [rad]
template <class Holds>
double await_tilt(Lab& lab, Holds holds, double limit_s) {
  double peak = 0.0;
  EXPECT_TRUE(lab.until(
      [&](const Reception& reception) {
        if (reception.channel != Channel::kState) return false;
        const double tilt = tilt_in(reception);
        peak = std::max(peak, tilt);
        return holds(tilt);
      },
      limit_s))
      << "peak " << peak / kDegree << " deg";
  return peak;
}

TEST_P(Swap, BalancesIsPushedRecoversAndStops) {
  Lab lab("prototype_b", kSlowTicks);
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons(GetParam()));
  ASSERT_NO_FATAL_FAILURE(lab.balance_in_real_time());

  const auto push = lab.start("disturb", {"impulse", "--watch", "0"});
  const double peak = await_tilt(
      lab, [](double tilt) { return tilt > 2.0 * kDegree; }, 30.0);
  EXPECT_EQ(push->wait(), 0) << push->output();
  EXPECT_LT(peak, 8.0 * kDegree);
  await_tilt(
      lab, [](double tilt) { return tilt < 1.0 * kDegree; }, 60.0);

  EXPECT_EQ(lab.run("ctl", {"disarm"}), 0) << lab.said;
  lab.await_mode(status_t::MODE_SAFE_STOP);
  EXPECT_EQ(lab.run("ctl", {"reset"}), 0) << lab.said;
  lab.await_mode(status_t::MODE_HELD);
}

TEST_P(Swap, WithoutItsControllerItStopsSafely) {
  Lab lab("double_brennan", kSlowTicks);
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons(GetParam()));
  ASSERT_NO_FATAL_FAILURE(lab.balance_in_real_time());
  EXPECT_LE(lab.ticks_to_safe_stop(), 10);
}

INSTANTIATE_TEST_SUITE_P(Owners, Swap,
                         testing::Values(OwnerKind::kIntegrator, OwnerKind::kHardware),
                         [](const auto& test) {
                           return test.param == OwnerKind::kIntegrator ? "Integrator" : "Hardware";
                         });

}  // namespace
}  // namespace gyrotwin
