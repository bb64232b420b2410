// How far an acceleration is from the floor of its arithmetic.
#pragma once

#include <string>
#include <vector>

namespace gyrotwin::bench {

/// Counts the floating-point operations of the model's accelerations in the compiled code, times
/// as many independent ones, and prints both times and the counts, as figure "arithmetic".
/// @throws Error where valgrind or objdump are not there, or the processor is no x86-64
void measure_arithmetic(const std::vector<std::string>& rigs, double seconds);

}  // namespace gyrotwin::bench
