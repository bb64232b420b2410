// Our bus, used as the daemons use it: every message encoded, signed where there is a key, checked
// and decoded.
#include "services/runtime/bus.hpp"
#include "tests/bench/loop/trip.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin::bench {
namespace {

constexpr std::int64_t kPatience = std::int64_t{1'000'000} * kPatienceMs;

BusConfig config(bool with_key) {
  BusConfig config = test_config(with_key ? std::optional(test_key()) : std::nullopt);
  // The other process has another number.
  config.group = with_key ? "239.255.71.241" : "239.255.71.240";
  config.port = with_key ? 21004 : 21003;
  return config;
}

class BusNear final : public Near {
 public:
  explicit BusNear(bool with_key) : bus_(config(with_key)) {}

  bool there_and_back() override {
    bus_.send(Channel::kState, state_, {.epoch = 1, .sequence = ++sequence_});
    while (command_.header.sequence != sequence_) {
      const auto reception = bus_.receive(kPatience);
      if (!reception) return false;  // nobody else speaks here
      if (reception->channel == Channel::kCommand) Bus::decode(*reception, command_);
    }
    return true;
  }

 private:
  Bus bus_;
  state_t state_ = distinct<state_t>();
  command_t command_{};
  std::int64_t sequence_ = 0;
};

class BusFar final : public Far {
 public:
  explicit BusFar(bool with_key) : bus_(config(with_key)) {}

  void answer() override {
    const auto reception = bus_.receive(kPatience);
    if (!reception || reception->channel != Channel::kState) return;
    Bus::decode(*reception, state_);
    bus_.send(Channel::kCommand, command_, {.epoch = 2, .sequence = state_.header.sequence});
  }

 private:
  Bus bus_;
  state_t state_{};
  command_t command_ = distinct<command_t>();
};

}  // namespace

std::unique_ptr<Near> bus_near() { return std::make_unique<BusNear>(false); }
std::unique_ptr<Far> bus_far() { return std::make_unique<BusFar>(false); }
std::unique_ptr<Near> signed_bus_near() { return std::make_unique<BusNear>(true); }
std::unique_ptr<Far> signed_bus_far() { return std::make_unique<BusFar>(true); }

}  // namespace gyrotwin::bench
