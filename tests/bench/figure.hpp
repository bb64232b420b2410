// What a measuring program says: one value a line, as JSON, on stdout (tests/bench/README.md).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin::bench {

struct Figure {
  std::string figure;    ///< a-z_
  std::string instance;  ///< the key `case`
  std::string subject;   ///< whose value it is

  void print(std::string_view quantity, std::string_view unit, double value) const {
    std::printf(
        "{\"figure\": \"%s\", \"case\": \"%s\", \"subject\": \"%s\", \"quantity\": \"%.*s\", "
        "\"unit\": \"%.*s\", \"value\": %.6g}\n",
        figure.c_str(), instance.c_str(), subject.c_str(), static_cast<int>(quantity.size()),
        quantity.data(), static_cast<int>(unit.size()), unit.data(), value);
    std::fflush(stdout);
  }

  /// p50, p99 and max of durations in nanoseconds, in microseconds. Sorts them; not empty.
  void print_distribution(std::vector<std::int64_t>& durations_ns) const {
    std::sort(durations_ns.begin(), durations_ns.end());
    const auto at = [&](double share) {
      const double rank = std::ceil(share * static_cast<double>(durations_ns.size()));
      return 1e-3 * static_cast<double>(durations_ns[static_cast<std::size_t>(rank) - 1]);
    };
    print("p50", "us", at(0.50));
    print("p99", "us", at(0.99));
    print("max", "us", at(1.0));
  }
};

}  // namespace gyrotwin::bench
