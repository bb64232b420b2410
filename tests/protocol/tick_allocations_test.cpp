// Neither daemon allocates once it runs: requests, ticks, STATUS and log lines included.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "services/controller/service.hpp"
#include "services/integrator/service.hpp"
#include "services/runtime/rig_bus.hpp"
#include "tests/support/allocation_counter.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kTicks = 3000;

BusConfig config_of(const Rig& rig, std::int32_t source) {
  Rig unsigned_rig = rig;
  unsigned_rig.network.sign = false;
  BusConfig config = bus_config(unsigned_rig, source);
  config.key = Key{1, 2, 3};  // signing is part of the tick
  return config;
}

/// A daemon's thread: what it allocated in run().
template <class Service>
class Running {
 public:
  Running(const Rig& rig, std::int32_t source)
      : thread_([this, &rig, source] {
          Daemon daemon("test");
          daemon_ = &daemon;
          MonotonicClock clock;
          Bus bus(config_of(rig, source));
          Service service(rig, bus, clock, daemon);
          ready_ = true;
          const AllocationCounter allocations;
          service.run();
          allocated_ = allocations.count();
        }) {
    while (!ready_) std::this_thread::yield();
  }

  std::int64_t stop_and_count() {
    daemon_.load()->stop();
    thread_.join();
    return allocated_;
  }

 private:
  std::atomic<Daemon*> daemon_{nullptr};
  std::atomic<bool> ready_{false};
  std::int64_t allocated_ = -1;
  std::thread thread_;
};

class TickAllocations : public testing::TestWithParam<const char*> {};

TEST_P(TickAllocations, ZeroInBothDaemons) {
  const Rig rig = load_rig(GetParam(), {"loop.clock=lockstep"});
  Bus bus(config_of(rig, header_t::OPERATOR));
  Running<IntegratorService> integrator(rig, header_t::SIMULATION);
  Running<ControllerService> controller(rig, header_t::CONTROLLER);

  // Arm, push on the way, and go on until enough ticks have passed.
  request_t request{};
  std::int64_t tick = 0;
  bool controller_heard = false;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (tick < kTicks && std::chrono::steady_clock::now() < end) {
    while (const auto reception = bus.receive()) {
      controller_heard |= reception->channel == Channel::kControllerStatus;
      if (reception->channel == Channel::kState) {
        state_t state;
        Bus::decode(*reception, state);
        tick = state.header.tick;
        request.owner_epoch = state.header.epoch;
      }
    }
    const bool pushes = tick > kTicks / 2 && request.verb == request_t::ARM;
    if (controller_heard && (tick == 0 || pushes)) {
      request.verb = pushes ? +request_t::DISTURB : +request_t::ARM;
      request.disturbance = request_t::IMPULSE;
      request.moment_nm[0] = 1.0;
      request.duration_ns = 20'000'000;
      request.writer = 3;
      ++request.counter;
      bus.send(Channel::kRequest, request, {3, request.counter, tick, 0});
    }
    bus.wait(20'000'000);
  }
  EXPECT_GE(tick, kTicks);
  EXPECT_EQ(request.verb, request_t::DISTURB);
  EXPECT_EQ(controller.stop_and_count(), 0);
  EXPECT_EQ(integrator.stop_and_count(), 0);
}

INSTANTIATE_TEST_SUITE_P(Rigs, TickAllocations,
                         testing::Values("prototype_b", "prototype_b_sleeping", "double_brennan"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace gyrotwin
