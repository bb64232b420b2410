#include "clients/ctl/observe.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <utility>

#include "services/runtime/rig_bus.hpp"
#include "tests/support/fake_owner.hpp"

namespace gyrotwin {
namespace {

/// One more second each time it is looked at; the owner starts when it is 10 s.
class CountingClock final : public Clock {
 public:
  explicit CountingClock(BusConfig owner) : owner_config_(std::move(owner)) {}
  std::int64_t now_ns() const noexcept override {
    if (++looks_ == 10) owner_.emplace(owner_config_);
    return looks_ * kSecond;
  }
  void sleep_until(std::int64_t /*deadline_ns*/) noexcept override {}
  std::int64_t looks() const { return looks_; }

 private:
  BusConfig owner_config_;
  mutable std::int64_t looks_ = 0;
  mutable std::optional<FakeOwner> owner_;
};

template <class Wait>
void expect_one_limit(const Wait& wait) {
  const Rig rig = fake_rig();
  Rig other = rig;
  other.id = rig.id + 1;
  FakeOwner wakes(bus_config(other, header_t::SIMULATION));  // whoever waits on the bus
  CountingClock clock(bus_config(rig, header_t::SIMULATION));
  Asker asker(rig, clock);
  EXPECT_THROW(wait(asker, 20 * kSecond), NotDone);
  EXPECT_GE(clock.looks(), 20);
  EXPECT_LE(clock.looks(), 24) << "waited once more after the owner was heard";
}

TEST(Waiting, ForAModeHasOneLimit) {
  expect_one_limit([](Asker& a, std::int64_t limit) { wait_for_mode(a, Mode::kFallen, limit); });
}

TEST(Waiting, UntilReadyHasOneLimit) {
  expect_one_limit([](Asker& a, std::int64_t limit) { wait_until_ready(a, limit); });
}

TEST(Waiting, ForBalanceHasOneLimit) {
  expect_one_limit([](Asker& a, std::int64_t limit) { wait_for_balance(a, {0.1, 1}, limit); });
}

}  // namespace
}  // namespace gyrotwin
