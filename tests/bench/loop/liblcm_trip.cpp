// liblcm with the same generated types, unsigned.
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>
#include <string>

#include "tests/bench/loop/trip.hpp"
#include "tests/support/distinct.hpp"

namespace gyrotwin::bench {
namespace {

constexpr auto kUrl = "udpm://239.255.71.242:21005?ttl=0";

void check(lcm::LCM& lcm) {
  if (!lcm.good()) throw std::runtime_error("liblcm: no multicast route?");
}

class LcmNear final : public Near {
 public:
  LcmNear() : lcm_(kUrl) {
    check(lcm_);
    lcm_.subscribe("LOOP/COMMAND", &LcmNear::take, this);
  }

  bool there_and_back() override {
    state_.header.sequence = ++sequence_;
    lcm_.publish("LOOP/STATE", &state_);
    while (answered_ != sequence_) {
      if (lcm_.handleTimeout(kPatienceMs) <= 0) return false;
    }
    return true;
  }

 private:
  void take(const lcm::ReceiveBuffer*, const std::string&, const command_t* command) {
    answered_ = command->header.sequence;
  }

  lcm::LCM lcm_;
  state_t state_ = distinct<state_t>();
  std::int64_t sequence_ = 0, answered_ = 0;
};

class LcmFar final : public Far {
 public:
  LcmFar() : lcm_(kUrl) {
    check(lcm_);
    lcm_.subscribe("LOOP/STATE", &LcmFar::take, this);
  }

  void answer() override { lcm_.handleTimeout(kPatienceMs); }

 private:
  void take(const lcm::ReceiveBuffer*, const std::string&, const state_t* state) {
    command_.header.sequence = state->header.sequence;
    lcm_.publish("LOOP/COMMAND", &command_);
  }

  lcm::LCM lcm_;
  command_t command_ = distinct<command_t>();
};

}  // namespace

std::unique_ptr<Near> liblcm_near() { return std::make_unique<LcmNear>(); }
std::unique_ptr<Far> liblcm_far() { return std::make_unique<LcmFar>(); }

}  // namespace gyrotwin::bench
