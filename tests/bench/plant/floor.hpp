// The least time that arithmetic takes: as many operations as were counted, none waiting for
// another, as straight machine code.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

namespace gyrotwin::bench {

/// Instructions of SSE2 by their opcode, on one double or on two at once.
enum class Operation { kAdd, kSubtract, kMultiply, kDivide, kSquareRoot };
inline constexpr int kOperations = 5;

/// Of one acceleration.
struct Arithmetic {
  std::array<int, kOperations> scalar{}, packed{};  ///< instructions
  int tanh = 0;                                     ///< calls of the C library

  /// On numbers, whichever instruction does them.
  int operations(Operation operation) const {
    const auto i = static_cast<std::size_t>(operation);
    return scalar[i] + 2 * packed[i];
  }
};

/// Does it all, in shuffled order.
class Floor {
 public:
  /// @throws Error where the processor is no x86-64 or the system allows no new code
  explicit Floor(const Arithmetic& arithmetic);
  ~Floor();
  Floor(const Floor&) = delete;
  Floor& operator=(const Floor&) = delete;

  void run();

 private:
  struct Code;
  Arithmetic calls_;
  std::unique_ptr<Code> code_;
  double sum_ = 0.0;  ///< of what the library gives, so that it is asked
};

}  // namespace gyrotwin::bench
