// liblcm's own tools and a liblcm program, unmodified, on an unsigned rig's bus: they record it and
// they balance it.
#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>

#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;

std::string url(const Rig& rig) {
  return "udpm://" + rig.network.group + ":" + std::to_string(rig.network.port) + "?ttl=0";
}

/// A controller written against messages/README.md with liblcm alone: u = -K x on each axis.
class LiblcmController {
 public:
  explicit LiblcmController(const Rig& rig)
      : prefix_(rig.network.prefix + "/"), rig_id_(rig.id), lcm_(url(rig)) {
    lcm_.subscribe(prefix_ + "LIVE/STATE", &LiblcmController::on_state, this)->setQueueCapacity(1);
  }

  void handle() { lcm_.handleTimeout(5); }
  std::int64_t owner_epoch() const { return owner_epoch_; }

  void arm() {
    request_t request{};
    request.header.rig_id = rig_id_;
    request.header.source = header_t::OPERATOR;
    request.header.epoch = 4711;
    request.header.sequence = ++requests_;
    request.verb = request_t::ARM;
    request.owner_epoch = owner_epoch_;
    request.writer = 4711;
    request.counter = requests_;
    lcm_.publish(prefix_ + "REQUEST", &request);
  }

 private:
  void on_state(const lcm::ReceiveBuffer*, const std::string&, const state_t* state) {
    constexpr double kGain[4] = {72.24, 1.726, -20.0, 0.2062};
    owner_epoch_ = state->header.epoch;
    command_t command{};
    command.header = state->header;
    command.header.source = header_t::CONTROLLER;
    command.header.sequence = ++counter_;
    command.header.epoch = 4712;
    command.mode = command_t::TORQUE_NM;
    command.valid_ticks = 10;
    const auto axis = [&](double tilt, double rate, double q, double q_rate) {
      return kGain[0] * tilt + kGain[1] * rate + kGain[2] * q + kGain[3] * q_rate;
    };
    command.value[0] = -axis(state->tilt_rad[0], state->tilt_rate_rad_s[0],
                             state->gimbal_angle_rad[0], state->gimbal_rate_rad_s[0]);
    command.value[1] = axis(state->tilt_rad[1], state->tilt_rate_rad_s[1],
                            -state->gimbal_angle_rad[2], -state->gimbal_rate_rad_s[2]);
    command.for_tick = state->header.tick;
    command.owner_epoch = owner_epoch_;
    command.writer = 4712;
    command.counter = counter_;
    lcm_.publish(prefix_ + "LIVE/COMMAND", &command);
  }

  std::string prefix_;
  std::int32_t rig_id_;
  lcm::LCM lcm_;
  std::int64_t owner_epoch_ = -1, counter_ = 0, requests_ = 0;
};

TEST(Peers, ALiblcmProgramBalancesTheRigWhileLcmLoggerRecords) {
  // Lockstep waits for the program however long this machine keeps it from running.
  Lab lab("double_brennan", {"network.sign=false", "loop.clock=lockstep"});
  lab.owner = lab.start("integrator");
  ASSERT_EQ(lab.run("ctl", {"wait", "held", "--timeout", "30"}), 0) << lab.said;
  const std::filesystem::path log = lab.folder() / "record.lcm";
  support::Process logger({"/usr/bin/lcm-logger", "--lcm-url=" + url(lab.rig), log.string()},
                          lab.folder() / "logger.txt");

  LiblcmController controller(lab.rig);
  std::int64_t tick = 0;
  std::int32_t mode = status_t::MODE_HELD;
  double tilt = 1.0;
  int asked = 0;
  // Ten simulated seconds; the request is repeated like any request that may get lost.
  for (int i = 0; i < 60'000 && tick < 5000; ++i) {
    controller.handle();
    if (mode == status_t::MODE_HELD && controller.owner_epoch() >= 0 && ++asked % 40 == 0) {
      controller.arm();
    }
    while (const auto reception = lab.bus->receive()) {
      if (reception->channel != Channel::kState) continue;
      state_t state;
      Bus::decode(*reception, state);
      tick = state.header.tick;
      mode = state.mode;
      tilt = std::hypot(state.tilt_rad[0], state.tilt_rad[1]);
    }
  }
  EXPECT_EQ(mode, status_t::MODE_RUNNING);
  EXPECT_GE(tick, 5000);
  EXPECT_LT(tilt, 0.01);

  logger.signal(SIGINT);
  logger.wait();
  lcm::LogFile file(log.string(), "r");
  ASSERT_TRUE(file.good());
  int states = 0, commands = 0;
  while (const lcm::LogEvent* event = file.readNextEvent()) {
    state_t state;
    command_t command;
    if (event->channel == "DOUBLE_BRENNAN/LIVE/STATE") {
      ASSERT_EQ(event->datalen, static_cast<int>(kWireSize<state_t>));
      states += state.decode(event->data, 0, event->datalen) > 0;
    } else if (event->channel == "DOUBLE_BRENNAN/LIVE/COMMAND") {
      commands += command.decode(event->data, 0, event->datalen) > 0;
    }
  }
  // lcm-logger loses what its buffer still held when it ended, and this loop is a fast one.
  EXPECT_GT(states, 2000);
  EXPECT_GT(commands, 2000);
}

}  // namespace
}  // namespace gyrotwin
