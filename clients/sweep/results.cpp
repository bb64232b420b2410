#include "clients/sweep/results.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

namespace gyrotwin {

namespace {

double number(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && after == end ? value : std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

}  // namespace

std::vector<double> Factor::levels() const {
  std::vector<double> distinct = numbers;
  std::ranges::sort(distinct);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  return distinct;
}

Factor Factor::sizes() const {
  Factor all = *this;
  all.key = "|" + key + "|";
  for (double& x : all.numbers) x = std::abs(x);
  return all;
}

Results read_results(const std::string& csv, const std::vector<Variable>& variables) {
  std::istringstream stream(csv);
  std::string line;
  std::getline(stream, line);
  Results results;
  for (const Variable& variable : variables) {
    results.factors.push_back(
        {variable.key, variable.drawn(), variable.kind != Variable::Kind::kSeed, {}, {}});
  }
  const std::size_t verdict = variables.size() + 1;
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = cells_of(line);
    for (std::size_t i = 0; i < variables.size(); ++i) {
      results.factors[i].texts.push_back(cells[i + 1]);
      results.factors[i].numbers.push_back(number(cells[i + 1]));
    }
    results.verdicts.push_back(cells[verdict]);
    results.fell_at.push_back(number(cells[verdict + 1]));
    results.largest_tilt.push_back(number(cells[verdict + 2]));
  }
  for (Factor& factor : results.factors) {
    if (!std::ranges::all_of(factor.numbers, [](double x) { return x == x; })) {
      factor.numbers.clear();
    }
  }
  return results;
}

}  // namespace gyrotwin
