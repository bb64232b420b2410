// The main job through the front door: arm, balance, push, recover, lose the controller, come back.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <utility>

#include "services/runtime/observation_wire.hpp"
#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;

class Balance : public testing::TestWithParam<const char*> {};

TEST_P(Balance, APushTiltsItAndItReturns) {
  Lab lab(GetParam());
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.balance());

  const auto push = lab.start("disturb", {"impulse", "--watch", "0"});
  double peak = 0.0;
  const auto tilt_in = [](const Reception& reception) {
    state_t state;
    Bus::decode(reception, state);
    return std::hypot(state.tilt_rad[0], state.tilt_rad[1]);
  };
  // 2 degrees and more, then less than 1 degree again.
  EXPECT_TRUE(lab.until([&](const Reception& reception) {
    if (reception.channel != Channel::kState) return false;
    peak = std::max(peak, tilt_in(reception));
    return peak > 0.035;
  })) << "peak "
      << peak;
  EXPECT_EQ(push->wait(), 0) << push->output();
  EXPECT_TRUE(lab.until(
      [&](const Reception& reception) {
        if (reception.channel != Channel::kState) return false;
        const double tilt = tilt_in(reception);
        peak = std::max(peak, tilt);
        return tilt < 0.017;
      },
      90.0));
  EXPECT_LT(peak, 0.14);

  EXPECT_EQ(lab.run("ctl", {"disarm"}), 0) << lab.said;
  lab.owner->signal(SIGTERM);
  lab.controller->signal(SIGINT);
  EXPECT_EQ(lab.owner->wait(), 0) << lab.owner->output();
  EXPECT_EQ(lab.controller->wait(), 0) << lab.controller->output();
}

INSTANTIATE_TEST_SUITE_P(Rigs, Balance,
                         testing::Values("prototype_b", "prototype_b_sleeping", "double_brennan",
                                         "brennan_monorail"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Failure, WithoutItsControllerTheOwnerStopsSafelyAndADoubleBrennanFalls) {
  Lab lab("double_brennan");
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.balance());

  EXPECT_LE(lab.ticks_to_safe_stop(), 10);
  const status_t stopped = lab.await_status([](const status_t& s) {
    return s.mode == status_t::MODE_SAFE_STOP || s.mode == status_t::MODE_FALLEN;
  });
  EXPECT_NE(stopped.text[0], 0) << "STATUS says why";
  lab.await_mode(status_t::MODE_FALLEN, 120.0);

  lab.controller = lab.start("controller");
  EXPECT_EQ(lab.run("ctl", {"arm"}), 1) << "only after a reset";
  EXPECT_EQ(lab.run("ctl", {"reset"}), 0) << lab.said;
  ASSERT_NO_FATAL_FAILURE(lab.balance());
}

// Bit for bit: what runs on without its law is what `simulate --law none` says.
TEST(Failure, WithoutItsControllerPrototypeBGoesWhereSimulateSays) {
  Lab lab("prototype_b");
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.balance());
  ASSERT_EQ(lab.run("disturb", {"impulse", "--watch", "0.1"}), 0) << lab.said;
  lab.controller->signal(SIGKILL);

  constexpr std::int64_t kLater = 1000;
  state_t first{}, last{};
  ASSERT_TRUE(lab.until([&](const Reception& reception) {
    if (reception.channel != Channel::kState) return false;
    state_t state;
    Bus::decode(reception, state);
    if (state.mode != status_t::MODE_SAFE_STOP) return false;
    if (first.mode == 0) first = state;
    last = state;
    return last.header.tick >= first.header.tick + kLater;
  }));
  const model::Machine machine = lab.rig.build_machine();
  const model::State start = machine.recall(from_wire(first));
  std::ostringstream initial;
  initial.precision(17);
  for (const auto& [name, x] : {std::pair{"q", start.q}, std::pair{"v", start.v}}) {
    initial << name << "=[";
    for (int i = 0; i < machine.coordinates(); ++i) initial << (i ? "," : "") << x[i];
    initial << "] ";
  }
  const double duration =
      1e-9 * static_cast<double>(last.header.sim_time_ns - first.header.sim_time_ns);
  const std::string csv = (lab.folder() / "simulated.csv").string();
  ASSERT_EQ(lab.run("simulate", {"--law", "none", "--feedback", "sampled", "--stepper", "fixed",
                                 "--initial", initial.str(), "--duration", std::to_string(duration),
                                 "--sample", std::to_string(duration), "--output", csv}),
            0)
      << lab.said;
  std::ifstream file(csv);
  std::string line;
  while (std::getline(file, line) && file.peek() != EOF) {
  }
  std::istringstream row(line);
  std::string cell;
  std::getline(row, cell, ',');
  const model::State end = machine.recall(from_wire(last));
  for (int i = 0; i < machine.coordinates(); ++i) {
    std::getline(row, cell, ',');
    EXPECT_EQ(std::stod(cell), end.q[i]) << machine.layout.names[i];
  }
}

TEST(Failure, ASecondOwnerDoesNotStart) {
  Lab lab("prototype_b");
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  const auto second = lab.start("integrator");
  EXPECT_EQ(second->wait(), 1);
  EXPECT_NE(second->output().find(std::to_string(lab.owner->pid())), std::string::npos)
      << second->output();
}

TEST(Failure, ASecondControllerIsRefusedAndTheFirstGoesOn) {
  Lab lab("prototype_b");
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.balance());
  const auto second = lab.start("controller");
  const status_t status =
      lab.await_status([](const status_t& s) { return s.refused_writer > 100; });
  EXPECT_EQ(status.mode, status_t::MODE_RUNNING);
}

TEST(Failure, ArmingWithoutAControllerIsRefusedWithTheFix) {
  Lab lab("prototype_b");
  lab.owner = lab.start("integrator");
  ASSERT_EQ(lab.run("ctl", {"wait", "held", "--timeout", "20"}), 0) << lab.said;
  EXPECT_EQ(lab.run("ctl", {"arm"}), 1);
  EXPECT_NE(lab.said.find("gyrotwin-controller"), std::string::npos) << lab.said;
}

}  // namespace
}  // namespace gyrotwin
