// The twin of a rig in its safe stop: drives that brake, or let go, are no drives that are weak.
#include <gtest/gtest.h>

#include "tests/support/mirrored_loop.hpp"

namespace gyrotwin {
namespace {

using support::MirroredLoop;

struct Stop {
  const char* name;
  const char* rig;
  double push;  ///< of the reference impulse as the controller goes
};

class SafeStopHealth : public testing::TestWithParam<Stop> {};

TEST_P(SafeStopHealth, BlamesNobody) {
  const Stop& stop = GetParam();
  MirroredLoop loop(stop.rig, {"loop.state=estimate"});
  loop.hear();
  ASSERT_EQ(loop.ask(request_t::ARM).result, +reply_t::APPLIED);
  loop.run_seconds(1.6);
  ASSERT_EQ(loop.health.verdict, +health_t::AGREES);
  if (stop.push > 0.0) {
    request_t push{};
    push.verb = request_t::DISTURB;
    push.kind = request_t::LOAD;
    push.moment_nm[0] = stop.push * loop.rig.reference_impulse_nms / loop.rig.impulse_duration_s;
    push.duration_ns = std::llround(1e9 * loop.rig.impulse_duration_s);
    ASSERT_EQ(loop.ask(push).result, +reply_t::APPLIED);
  }
  loop.controller_alive = false;
  bool stopped = false;
  for (auto n = std::llround(3.0 * loop.rig.loop.rate_hz); n > 0; --n) {
    loop.tick();
    if (loop.integrator.mode() == Mode::kFallen) break;
    stopped |= loop.integrator.mode() == Mode::kSafeStop;
    ASSERT_EQ(loop.health.verdict, +health_t::AGREES)
        << get_text(loop.health.text) << ", tilt " << loop.tilt();
  }
  EXPECT_TRUE(stopped);
}

INSTANTIATE_TEST_SUITE_P(Of, SafeStopHealth,
                         testing::Values(Stop{"double_brennan", "double_brennan", 0.0},
                                         Stop{"double_brennan_pushed", "double_brennan", 0.6},
                                         Stop{"prototype_b", "prototype_b", 0.0},
                                         Stop{"brennan_monorail", "brennan_monorail", 0.6}),
                         [](const auto& stop) { return std::string(stop.param.name); });

}  // namespace
}  // namespace gyrotwin
