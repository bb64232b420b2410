#include "tests/bench/plant/floor.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "services/runtime/error.hpp"

namespace gyrotwin::bench {

namespace {

// xmm0 to xmm13 take turns as what is worked on; two more hold the other operand: a small term and
// a factor close to 1, so that no value leaves the range in which operations take their usual time.
constexpr int kRegisters = 14, kTerm = 14, kFactor = 15;
constexpr double kTermValue = 1e-9, kFactorValue = 1.0 + 1e-12;

constexpr std::array<std::uint8_t, kOperations> kOpcode{0x58, 0x5c, 0x59, 0x5e, 0x51};

struct Instruction {
  Operation operation;
  bool packed;
};

/// `operation` xmm[on], xmm[with]
void emit(std::vector<std::uint8_t>& code, Instruction instruction, int on, int with) {
  code.push_back(instruction.packed ? 0x66 : 0xf2);
  code.push_back(static_cast<std::uint8_t>(0x40 | (on >= 8 ? 4 : 0) | (with >= 8 ? 1 : 0)));
  code.push_back(0x0f);
  code.push_back(kOpcode[static_cast<std::size_t>(instruction.operation)]);
  code.push_back(static_cast<std::uint8_t>(0xc0 | ((on & 7) << 3) | (with & 7)));
}

/// movups xmm[on], [rdi + 16 on]
void emit_load(std::vector<std::uint8_t>& code, int on) {
  if (on >= 8) code.push_back(0x44);
  code.insert(code.end(), {0x0f, 0x10, static_cast<std::uint8_t>(0x87 | ((on & 7) << 3))});
  const std::int32_t offset = 16 * on;
  for (int byte = 0; byte < 4; ++byte) {
    code.push_back(static_cast<std::uint8_t>(offset >> (8 * byte)));
  }
}

std::vector<Instruction> shuffled(const Arithmetic& arithmetic) {
  std::vector<Instruction> all;
  for (int i = 0; i < kOperations; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const auto operation = static_cast<Operation>(i);
    all.insert(all.end(), static_cast<std::size_t>(arithmetic.scalar[index]), {operation, false});
    all.insert(all.end(), static_cast<std::size_t>(arithmetic.packed[index]), {operation, true});
  }
  std::shuffle(all.begin(), all.end(), std::mt19937(1));
  return all;
}

std::vector<std::uint8_t> code_of(const Arithmetic& arithmetic) {
  std::vector<std::uint8_t> code;
  for (int i = 0; i < 16; ++i) emit_load(code, i);
  int on = 0;
  for (const Instruction instruction : shuffled(arithmetic)) {
    const bool term =
        instruction.operation == Operation::kAdd || instruction.operation == Operation::kSubtract;
    emit(code, instruction, on, term ? kTerm : kFactor);
    on = (on + 1) % kRegisters;
  }
  code.push_back(0xc3);  // ret
  return code;
}

}  // namespace

struct Floor::Code {
  using Function = void (*)(const double*);

  explicit Code(const std::vector<std::uint8_t>& bytes) : size(bytes.size()) {
    memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw Error("no memory for code");
    std::memcpy(memory, bytes.data(), size);
    if (::mprotect(memory, size, PROT_READ | PROT_EXEC) != 0) {
      ::munmap(memory, size);
      throw Error("this system allows no new code");
    }
    registers.fill(0.7);
    registers[2 * kTerm] = registers[2 * kTerm + 1] = kTermValue;
    registers[2 * kFactor] = registers[2 * kFactor + 1] = kFactorValue;
  }
  ~Code() { ::munmap(memory, size); }
  Code(const Code&) = delete;
  Code& operator=(const Code&) = delete;

  void run() const {
    Function function = nullptr;
    std::memcpy(&function, &memory, sizeof function);
    function(registers.data());
  }

  std::size_t size;
  void* memory = nullptr;
  std::array<double, 32> registers{};
};

Floor::Floor(const Arithmetic& arithmetic) : calls_(arithmetic) {
#if !defined(__x86_64__)
  throw Error("the floor of arithmetic is known for x86-64 alone");
#endif
  code_ = std::make_unique<Code>(code_of(arithmetic));
}

Floor::~Floor() = default;

void Floor::run() {
  code_->run();
  double angle = 0.01;  // as machines have them, each another
  for (int i = 0; i < calls_.tanh; ++i) sum_ += std::tanh(angle += 0.013);
}

}  // namespace gyrotwin::bench
