// A measured value as deploy/bench takes it: one JSON line.
#pragma once

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

namespace gyrotwin::bench {

inline void print_figure(const std::string& figure, const std::string& of_case,
                         const std::string& subject, const std::string& quantity,
                         const std::string& unit, double value) {
  const nlohmann::ordered_json line{{"figure", figure},     {"case", of_case}, {"subject", subject},
                                    {"quantity", quantity}, {"unit", unit},    {"value", value}};
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

}  // namespace gyrotwin::bench
