#include "clients/analyze/findings.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace gyrotwin {

namespace {

double ratio(double x, double y) {
  const bool says_something = x > 0.0 && y > 0.0;
  return says_something ? x / y : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Condition above(std::string key, std::string claim, std::string meaning, double value,
                double required, std::string unit, Role role) {
  return {std::move(key),
          std::move(claim),
          std::move(meaning),
          value,
          required,
          ">",
          std::move(unit),
          value > required,
          role,
          ratio(value, required)};
}

Condition below(std::string key, std::string claim, std::string meaning, double value,
                double required, std::string unit, Role role) {
  return {std::move(key),
          std::move(claim),
          std::move(meaning),
          value,
          required,
          "<",
          std::move(unit),
          value < required,
          role,
          ratio(required, value)};
}

Condition yes_no(std::string key, std::string claim, std::string meaning, bool holds, Role role) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {std::move(key),
          std::move(claim),
          std::move(meaning),
          holds ? 1.0 : 0.0,
          kNone,
          "",
          "",
          holds,
          role,
          kNone};
}

}  // namespace gyrotwin
