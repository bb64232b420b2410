#include "clients/sweep/variable.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "services/onboard/noise.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr int kMostValues = 1'000'000;
constexpr double kSeeds = 1e6;  // 0 to 999,999, what every `seed` key takes

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || after != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// nan and inf are numbers of TOML, but no values of a quantity.
bool not_finite(std::string text) {
  if (text.starts_with('+') || text.starts_with('-')) text.erase(0, 1);
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text == "nan" || text == "inf" || text == "infinity";
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else if (c != ' ') {
      parts.back() += c;
    }
  }
  return parts;
}

/// What is between the brackets of `name(...)`.
std::optional<std::string> inside(const std::string& text, const std::string& name) {
  if (!text.starts_with(name + '(') || !text.ends_with(')')) return std::nullopt;
  return text.substr(name.size() + 1, text.size() - name.size() - 2);
}

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  Variable read() const {
    const std::size_t equals = text_.find('=');
    if (equals == std::string::npos || equals == 0) refuse("KEY=VALUES");
    Variable variable{text_.substr(0, equals), text_.substr(equals + 1)};
    std::string values = variable.spec;
    variable.factor = values.starts_with('*');
    if (variable.factor) values.erase(0, 1);
    read_values(values, variable);
    return variable;
  }

 private:
  [[noreturn]] void refuse(const std::string& expected) const {
    throw Error(fmt::format("`{}` is nothing to vary; expected {}", text_, expected));
  }

  void read_values(const std::string& values, Variable& variable) const {
    if (const auto numbers = inside(values, "normal")) {
      return read_distribution(*numbers, Variable::Kind::kNormal, "normal(MEAN,SIGMA), SIGMA > 0",
                               variable);
    }
    if (const auto numbers = inside(values, "uniform")) {
      return read_distribution(*numbers, Variable::Kind::kUniform, "uniform(LOW,HIGH), LOW < HIGH",
                               variable);
    }
    if (const auto nothing = inside(values, "seed")) {
      if (!nothing->empty() || variable.factor) refuse("seed()");
      variable.kind = Variable::Kind::kSeed;
    } else if (const auto range = inside(values, "log")) {
      read_range(*range, true, variable);
    } else if (values.find(':') != std::string::npos) {
      read_range(values, false, variable);
    } else {
      read_list(values, variable);
    }
  }

  void read_distribution(const std::string& text, Variable::Kind kind, const char* expected,
                         Variable& variable) const {
    const std::vector<std::string> parts = split(text, ',');
    const auto first = number_in(parts[0]);
    const auto second = parts.size() == 2 ? number_in(parts[1]) : std::nullopt;
    if (!first || !second) refuse(expected);
    const bool normal = kind == Variable::Kind::kNormal;
    if (normal ? *second <= 0.0 : *second <= *first) refuse(expected);
    variable.kind = kind;
    variable.first = *first;
    variable.second = *second;
  }

  void read_range(const std::string& text, bool logarithmic, Variable& variable) const {
    const std::vector<std::string> parts = split(text, ':');
    const auto low = number_in(parts[0]);
    const auto high = parts.size() == 3 ? number_in(parts[1]) : std::nullopt;
    const auto count = parts.size() == 3 ? number_in(parts[2]) : std::nullopt;
    if (!low || !high || !count || *count != std::floor(*count) || *count < 2 ||
        *count > kMostValues || *low == *high) {
      refuse("LOW:HIGH:N with N from 2 to 1000000");
    }
    if (logarithmic && (*low <= 0.0 || *high <= 0.0)) refuse("log(LOW:HIGH:N), both above 0");
    const int n = static_cast<int>(*count);
    for (int i = 0; i < n; ++i) {
      const double share = static_cast<double>(i) / (n - 1);
      const double value =
          logarithmic ? *low * std::pow(*high / *low, share) : *low + (*high - *low) * share;
      variable.list.push_back(number_text(i == n - 1 ? *high : value));
    }
  }

  void read_list(const std::string& text, Variable& variable) const {
    for (const std::string& value : split(text, ',')) {
      if (not_finite(value)) refuse("finite numbers");
      const std::optional<double> number = number_in(value);
      if (value.empty() || (variable.factor && !number)) {
        refuse("values such as A,B,C, LOW:HIGH:N or normal(MEAN,SIGMA)");
      }
      if (value.find_first_of("()\"'\\") != std::string::npos) {
        refuse("a distribution: normal(MEAN,SIGMA), uniform(LOW,HIGH) or seed()");
      }
      variable.words = variable.words || !number;
      variable.list.push_back(number ? number_text(*number) : value);
    }
  }

  const std::string& text_;
};

}  // namespace

double Variable::draw(std::uint64_t seed, std::uint64_t stream, std::int64_t run) const {
  const auto index = static_cast<std::uint64_t>(run);
  switch (kind) {
    case Kind::kNormal:
      return first + second * normal(seed, stream, index);
    case Kind::kUniform:
      return first + (second - first) * uniform(seed, stream, index);
    case Kind::kSeed:
      return std::min(std::floor(kSeeds * uniform(seed, stream, index)), kSeeds - 1.0);
    case Kind::kList:
      break;
  }
  return 0.0;
}

Variable parse_variable(const std::string& text) { return Reader(text).read(); }

std::string number_text(double value) { return fmt::format("{}", value); }

}  // namespace gyrotwin
