// Counts heap allocations, so that a test can demand none. Link gyrotwin_allocation_counter.
#pragma once

#include <cstdint>

namespace gyrotwin {

/// Counts what this thread asks of the heap (malloc, calloc, realloc, aligned allocation, operator
/// new) from its construction on. Under a sanitizer, whose own malloc must stay, by its hooks.
class AllocationCounter {
 public:
  AllocationCounter() noexcept;

  /// Allocations of this thread since construction.
  std::int64_t count() const noexcept;

 private:
  std::int64_t start_;
};

}  // namespace gyrotwin
