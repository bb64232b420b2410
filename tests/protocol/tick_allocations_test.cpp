// One whole tick, owner to controller and back through real sockets, allocates nothing.
#include <gtest/gtest.h>

#include "services/controller/controller.hpp"
#include "services/integrator/integrator.hpp"
#include "services/runtime/rig_bus.hpp"
#include "tests/support/allocation_counter.hpp"

namespace gyrotwin {
namespace {

BusConfig config_of(const Rig& rig, std::int32_t source) {
  Rig unsigned_rig = rig;
  unsigned_rig.network.sign = false;
  BusConfig config = bus_config(unsigned_rig, source);
  config.key = Key{1, 2, 3};  // signing is part of the tick
  return config;
}

class TickAllocations : public testing::TestWithParam<const char*> {
 protected:
  /// STATE, TRUTH and STATUS out, COMMAND back, one tick.
  void tick() {
    const Stamp stamp{owner.epoch(), owner.sequence(), owner.tick(), owner.sim_time_ns()};
    state_t state;
    truth_t truth;
    status_t status{};
    owner.fill(state);
    owner.fill(truth);
    owner.fill(status);
    fill_process(status, owner_bus.counters());
    owner_bus.send(Channel::kIntegratorStatus, status, stamp);
    owner_bus.send(Channel::kState, state, stamp);
    owner_bus.send(Channel::kTruth, truth, stamp);
    while (const auto reception = controller_bus.receive()) answer(*reception);
    while (const auto reception = owner_bus.receive()) {
      if (reception->channel != Channel::kCommand) continue;
      command_t command;
      Bus::decode(*reception, command);
      owner.on_command(command);
    }
    ASSERT_TRUE(owner.answered());
    owner.advance();
  }

  void answer(const Reception& reception) {
    if (reception.channel == Channel::kIntegratorStatus) {
      status_t status;
      Bus::decode(reception, status);
      controller.on_owner(status);
    } else if (reception.channel == Channel::kState) {
      state_t state;
      command_t command;
      Bus::decode(reception, state);
      if (!controller.answer(state, command)) return;
      controller_bus.send(Channel::kCommand, command, {2, state.header.sequence, 0, 0});
    }
  }

  Rig rig = load_rig(GetParam());
  Bus owner_bus{config_of(rig, header_t::SIMULATION)};
  Bus controller_bus{config_of(rig, header_t::CONTROLLER)};
  Integrator owner{rig, 1};
  Controller controller{rig, 2};
};

TEST_P(TickAllocations, Zero) {
  request_t arm{};
  arm.verb = request_t::ARM;
  arm.owner_epoch = 1;
  arm.writer = 3;
  arm.counter = 1;
  reply_t reply;
  owner.on_request(arm, {.controller_heard = true}, reply);
  for (int i = 0; i < 100; ++i) ASSERT_NO_FATAL_FAILURE(tick());

  const AllocationCounter allocations;
  for (int i = 0; i < 2000; ++i) tick();
  EXPECT_EQ(allocations.count(), 0);
  EXPECT_EQ(owner.tick(), 2100);
}

INSTANTIATE_TEST_SUITE_P(Rigs, TickAllocations,
                         testing::Values("prototype_b", "prototype_b_sleeping", "double_brennan"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace gyrotwin
