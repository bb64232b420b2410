#include "services/runtime/spsc_ring.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace gyrotwin {
namespace {

TEST(SpscRing, TakesItsCapacityAndGivesItBackInOrder) {
  SpscRing<int, 4> ring;
  int item = -1;
  EXPECT_FALSE(ring.pop(item));
  EXPECT_EQ(item, -1);

  // Thrice, so that the places are used again.
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(10 * round + i));
    EXPECT_FALSE(ring.push(99));
    for (int i = 0; i < 4; ++i) {
      ASSERT_TRUE(ring.pop(item));
      EXPECT_EQ(item, 10 * round + i);
    }
    EXPECT_FALSE(ring.pop(item));
  }
}

/// Larger than a word, so that a torn item shows.
struct Item {
  std::int64_t number;
  std::int64_t negated;
  std::int64_t filler[6];
};

TEST(SpscRing, KeepsEveryItemWholeAndInOrderBetweenTwoThreads) {
  constexpr std::int64_t kItems = 1'000'000;
  SpscRing<Item, 64> ring;
  std::jthread producer([&ring] {
    for (std::int64_t i = 0; i < kItems; ++i) {
      while (!ring.push({i, ~i, {}})) std::this_thread::yield();
    }
  });

  Item item{};
  for (std::int64_t i = 0; i < kItems; ++i) {
    while (!ring.pop(item)) std::this_thread::yield();
    ASSERT_EQ(item.number, i);
    ASSERT_EQ(item.negated, ~i);
  }
  producer.join();
  EXPECT_FALSE(ring.pop(item));
}

}  // namespace
}  // namespace gyrotwin
