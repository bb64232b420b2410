#include "tests/bench/plant/arithmetic.hpp"

#include <chrono>
#include <cmath>
#include <map>
#include <sstream>

#include "services/runtime/error.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/plant/acceleration.hpp"
#include "tests/bench/plant/callgrind.hpp"
#include "tests/bench/plant/floor.hpp"

namespace gyrotwin::bench {

namespace {

/// How often each counts, in one acceleration.
using Counts = std::map<std::string, double>;

/// Which instruction stands where in a disassembly: its mnemonic; of a call, "call" and what of.
std::map<std::uint64_t, std::string> disassembled(const std::string& program) {
  std::map<std::uint64_t, std::string> instructions;
  std::istringstream lines(output_of({"objdump", "--disassemble", "--no-show-raw-insn", program}));
  for (std::string line; std::getline(lines, line);) {
    const auto colon = line.find(":\t");
    if (line.empty() || line[0] != ' ' || colon == std::string::npos) continue;
    std::istringstream words(line.substr(colon + 2));
    std::string mnemonic, address, callee;
    words >> mnemonic;
    if (mnemonic == "call") {
      words >> address >> callee;
      mnemonic += " " + callee;
    }
    instructions[std::stoull(line.substr(0, colon), nullptr, 16)] = mnemonic;
  }
  return instructions;
}

Counts counts_of(const Pass& pass, const std::map<std::uint64_t, std::string>& instructions) {
  Counts counts;
  for (const auto& [address, executed] : pass.executed) {
    const auto found = instructions.find(address);
    if (found != instructions.end()) counts[found->second] += executed;
  }
  return counts;
}

int rounded(const Counts& counts, const std::string& instruction) {
  const auto found = counts.find(instruction);
  return found == counts.end() ? 0 : static_cast<int>(std::lround(found->second));
}

Arithmetic arithmetic_of(const Counts& counts) {
  constexpr std::array<const char*, kOperations> kMnemonic{"add", "sub", "mul", "div", "sqrt"};
  Arithmetic arithmetic;
  for (std::size_t i = 0; i < kOperations; ++i) {
    const std::string mnemonic = kMnemonic[i];
    if (counts.contains("v" + mnemonic + "sd")) {
      throw Error("arithmetic is counted in code for SSE2; this is for a newer processor");
    }
    arithmetic.scalar[i] = rounded(counts, mnemonic + "sd");
    arithmetic.packed[i] = rounded(counts, mnemonic + "pd");
  }
  arithmetic.tanh = rounded(counts, "call <tanh@plt>");
  return arithmetic;
}

void print_counts(const std::string& rig, const Arithmetic& a) {
  const auto print = [&rig](const char* quantity, int value) {
    Figure{"arithmetic", rig, "gyrotwin"}.print(quantity, "1", value);
  };
  print("additions", a.operations(Operation::kAdd) + a.operations(Operation::kSubtract));
  print("multiplications", a.operations(Operation::kMultiply));
  print("divisions", a.operations(Operation::kDivide));
  print("square_roots", a.operations(Operation::kSquareRoot));
  print("tanhs", a.tanh);
}

}  // namespace

void measure_arithmetic(const std::vector<std::string>& rigs, double seconds) {
  const auto instructions = disassembled(own_path());
  for (const Pass& pass : passes_under_callgrind(rigs, false)) {
    if (pass.subject != "gyrotwin") continue;
    const Arithmetic arithmetic = arithmetic_of(counts_of(pass, instructions));
    print_counts(pass.rig, arithmetic);

    const Contest own = contest(pass.rig, false);
    Floor floor(arithmetic);
    const Turn floors = [&floor](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) floor.run();
    };
    const std::vector<double> medians =
        medians_in_turns({turn_of(*own.subjects[0]), floors}, own.samples.size(), seconds);
    Figure{"arithmetic", pass.rig, "gyrotwin"}.print("p50", "ns", medians[0]);
    Figure{"arithmetic", pass.rig, "floor"}.print("p50", "ns", medians[1]);
  }
}

}  // namespace gyrotwin::bench
