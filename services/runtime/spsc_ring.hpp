// A queue between two threads that never makes either wait.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <type_traits>

namespace gyrotwin {

/// First in, first out, from one producer thread to one consumer thread.
template <class T, std::size_t kCapacity>
class SpscRing {
  static_assert(std::has_single_bit(kCapacity), "the capacity must be a power of two");
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// For the producer. @return false, and nothing queued, when full.
  bool push(const T& item) noexcept {
    const std::size_t pushed = pushed_.load(std::memory_order_relaxed);
    if (pushed - popped_.load(std::memory_order_acquire) == kCapacity) return false;
    slots_[pushed % kCapacity] = item;
    pushed_.store(pushed + 1, std::memory_order_release);
    return true;
  }

  /// For the consumer. @return false, and `item` untouched, when empty.
  bool pop(T& item) noexcept {
    const std::size_t popped = popped_.load(std::memory_order_relaxed);
    if (pushed_.load(std::memory_order_acquire) == popped) return false;
    item = slots_[popped % kCapacity];
    popped_.store(popped + 1, std::memory_order_release);
    return true;
  }

 private:
  // Each count on a cache line of its own: only one thread writes it.
  static constexpr std::size_t kCacheLine = 64;
  alignas(kCacheLine) std::atomic<std::size_t> pushed_{0};
  alignas(kCacheLine) std::atomic<std::size_t> popped_{0};
  alignas(kCacheLine) std::array<T, kCapacity> slots_{};
};

}  // namespace gyrotwin
