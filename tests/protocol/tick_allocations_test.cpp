// No daemon allocates once it runs: requests, ticks, STATUS and log lines included.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "services/controller/service.hpp"
#include "services/integrator/service.hpp"
#include "services/mirror/service.hpp"
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

struct Case {
  const char* rig;
  const char* state;  // of whom STATE is
};

class TickAllocations : public testing::TestWithParam<Case> {};

request_t request_of(std::int32_t verb) {
  request_t request{};
  request.verb = verb;
  return request;
}

/// What an operator asks for while it runs.
std::vector<request_t> troubles() {
  std::vector<request_t> troubles{request_of(request_t::DISTURB), request_of(request_t::DISTURB),
                                  request_of(request_t::FAULT), request_of(request_t::ROTORS),
                                  request_of(request_t::CANCEL)};
  troubles[0].kind = request_t::LOAD;
  troubles[0].moment_nm[0] = 1.0;
  troubles[0].duration_ns = 20'000'000;
  troubles[1].kind = request_t::GUST;
  troubles[1].moment_nm[0] = 0.1;
  troubles[1].correlation_s = 0.2;
  troubles[2].kind = request_t::SENSOR_DELAYED;
  troubles[2].target = sensors_t::VALID_GYRO;
  troubles[2].delay_ns = 2'000'000;
  troubles[3].kind = request_t::SPIN_UP;
  troubles[4].id = 3;
  return troubles;
}

TEST_P(TickAllocations, ZeroInEachDaemon) {
  const Rig rig = load_rig(GetParam().rig,
                           {"loop.clock=lockstep", std::string("loop.state=") + GetParam().state});
  Bus bus(config_of(rig, header_t::OPERATOR));
  Running<IntegratorService> integrator(rig, header_t::SIMULATION);
  Running<ControllerService> controller(rig, header_t::CONTROLLER);
  Running<MirrorService> mirror(rig, header_t::TWIN);

  // Arm, make trouble on the way, and go on until enough ticks have passed.
  std::int64_t tick = 0, epoch = 0, counter = 0;
  int applied = 0;
  bool troubled = false;
  const auto ask = [&](request_t request) {
    request.owner_epoch = epoch;
    request.writer = 3;
    request.counter = ++counter;
    bus.send(Channel::kRequest, request, {3, counter, tick, 0});
  };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (tick < kTicks && std::chrono::steady_clock::now() < end) {
    while (const auto reception = bus.receive()) {
      if (reception->channel == Channel::kControllerStatus && tick == 0)
        ask(request_of(request_t::ARM));
      if (reception->channel == Channel::kState) {
        state_t state;
        Bus::decode(*reception, state);
        tick = state.header.tick;
        epoch = state.header.epoch;
      }
      if (reception->channel == Channel::kReply) {
        reply_t reply;
        Bus::decode(*reception, reply);
        if (reply.verb != request_t::ARM) applied += reply.result == reply_t::APPLIED;
      }
    }
    if (tick > kTicks / 2 && !troubled) {
      for (const request_t& trouble : troubles()) ask(trouble);
      troubled = true;
    }
    bus.wait(20'000'000);
  }
  EXPECT_GE(tick, kTicks);
  EXPECT_EQ(applied, static_cast<int>(troubles().size()));
  EXPECT_EQ(mirror.stop_and_count(), 0);
  EXPECT_EQ(controller.stop_and_count(), 0);
  EXPECT_EQ(integrator.stop_and_count(), 0);
}

INSTANTIATE_TEST_SUITE_P(Rigs, TickAllocations,
                         testing::Values(Case{"prototype_b", "estimate"},
                                         Case{"prototype_b_sleeping", "truth"},
                                         Case{"double_brennan", "estimate"}),
                         [](const auto& test) { return std::string(test.param.rig); });

}  // namespace
}  // namespace gyrotwin
