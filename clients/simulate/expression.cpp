#include "clients/simulate/expression.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

double sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x; }
double step(double x) { return x < 0.0 ? 0.0 : x >= 0.0 ? 1.0 : x; }
double square(double x) { return std::isfinite(x) ? (std::sin(x) < 0.0 ? -1.0 : 1.0) : x - x; }
// Not std::min: what is not a number must stay visible.
double lesser(double a, double b) { return a < b || a != a ? a : b; }
double greater(double a, double b) { return a > b || a != a ? a : b; }

struct Function {
  std::string_view name;
  int arguments;
  double (*unary)(double) = nullptr;
  double (*binary)(double, double) = nullptr;
};

constexpr Function kFunctions[] = {
    {"sin", 1, [](double x) { return std::sin(x); }},
    {"cos", 1, [](double x) { return std::cos(x); }},
    {"tan", 1, [](double x) { return std::tan(x); }},
    {"tanh", 1, [](double x) { return std::tanh(x); }},
    {"exp", 1, [](double x) { return std::exp(x); }},
    {"log", 1, [](double x) { return std::log(x); }},
    {"sqrt", 1, [](double x) { return std::sqrt(x); }},
    {"abs", 1, [](double x) { return std::abs(x); }},
    {"sign", 1, sign},
    {"step", 1, step},
    {"square", 1, square},
    {"min", 2, nullptr, lesser},
    {"max", 2, nullptr, greater},
    {"clamp", 3},
};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

/// Recursive descent; each function leaves the value of what it has read on the stack.
class ExpressionCompiler {
 public:
  ExpressionCompiler(std::string_view text, const std::vector<std::string>& variables)
      : text_(text), variables_(variables) {}

  std::vector<Expression::Instruction> compile() {
    sum();
    skip_blanks();
    if (at_ < text_.size()) fail("expected an operator or the end, found " + found());
    return std::move(program_);
  }

 private:
  using Instruction = Expression::Instruction;
  using Kind = Instruction::Kind;

  [[noreturn]] void fail(const std::string& what) const { fail_at(at_, what); }
  [[noreturn]] static void fail_at(std::size_t place, const std::string& what) {
    throw Error("column " + std::to_string(place + 1) + ": " + what);
  }

  std::string found() const {
    return at_ < text_.size() ? std::string{'`', text_[at_], '`'} : "the end";
  }

  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }

  bool take(std::string_view token) {
    skip_blanks();
    if (!text_.substr(at_).starts_with(token)) return false;
    at_ += token.size();
    return true;
  }

  void expect(char token, const std::string& why) {
    if (!take({&token, 1}))
      fail("expected `" + std::string(1, token) + "` " + why + ", found " + found());
  }

  /// Counts what evaluation will have on its stack.
  void push(const Instruction& instruction, int consumed) {
    waiting_ += 1 - consumed;
    if (waiting_ > static_cast<int>(Expression::kMaxDepth)) too_deep();
    program_.push_back(instruction);
  }
  void binary(Expression::Binary operation) {
    push({.kind = Kind::kBinary, .binary = operation}, 2);
  }
  [[noreturn]] void too_deep() const {
    fail("nested deeper than " + std::to_string(Expression::kMaxDepth) + "; simplify it");
  }

  void sum() {
    if (++depth_ > static_cast<int>(Expression::kMaxDepth)) too_deep();
    product();
    while (true) {
      if (take("+")) {
        product();
        binary([](double a, double b) { return a + b; });
      } else if (take("-")) {
        product();
        binary([](double a, double b) { return a - b; });
      } else {
        break;
      }
    }
    --depth_;
  }

  void product() {
    signed_power();
    while (true) {
      if (take("*")) {
        signed_power();
        binary([](double a, double b) { return a * b; });
      } else if (take("/")) {
        signed_power();
        binary([](double a, double b) { return a / b; });
      } else {
        return;
      }
    }
  }

  /// -x^2 is -(x^2), as on paper.
  void signed_power() {
    bool negative = false;
    while (true) {
      if (take("-")) {
        negative = !negative;
      } else if (!take("+")) {
        break;
      }
    }
    power();
    if (negative) push({.kind = Kind::kUnary, .unary = [](double x) { return -x; }}, 1);
  }

  /// From right to left: 2^3^2 is 2^9.
  void power() {
    primary();
    if (!take("**") && !take("^")) return;
    if (++depth_ > static_cast<int>(Expression::kMaxDepth)) too_deep();
    signed_power();
    --depth_;
    binary([](double a, double b) { return std::pow(a, b); });
  }

  void primary() {
    skip_blanks();
    if (at_ == text_.size()) fail("expected a number, a name or `(`, found the end");
    const char c = text_[at_];
    if (is_digit(c) || c == '.') return number();
    if (is_letter(c)) return name();
    if (!take("(")) fail("expected a number, a name or `(`, found " + found());
    const std::size_t opened = at_;
    sum();
    expect(')', "for the one opened in column " + std::to_string(opened));
  }

  void number() {
    double value = 0.0;
    const char* begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) {
      fail("expected a number such as 0.5 or 1e-3, within what a double can hold");
    }
    push({.kind = Kind::kConstant, .constant = value}, 0);
    at_ += static_cast<std::size_t>(end - begin);
  }

  void name() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    if (const auto it = std::find(variables_.begin(), variables_.end(), word);
        it != variables_.end()) {
      const auto index = static_cast<std::size_t>(it - variables_.begin());
      return push({.kind = Kind::kVariable, .variable = index}, 0);
    }
    if (word == "pi") return push({.kind = Kind::kConstant, .constant = std::numbers::pi}, 0);
    for (const Function& function : kFunctions) {
      if (function.name == word) return call(function);
    }
    unknown(word, begin);
  }

  void call(const Function& function) {
    const std::string name(function.name);
    const std::string takes = name + " takes " + std::to_string(function.arguments) +
                              (function.arguments == 1 ? " argument" : " arguments");
    expect('(', "after " + name);
    for (int i = 0; i < function.arguments; ++i) {
      if (i > 0) expect(',', "(" + takes + ")");
      sum();
    }
    expect(')', "(" + takes + ")");
    if (function.unary) return push({.kind = Kind::kUnary, .unary = function.unary}, 1);
    if (function.binary) return binary(function.binary);
    push({.kind = Kind::kClamp}, 3);
  }

  [[noreturn]] void unknown(std::string_view word, std::size_t begin) const {
    std::vector<std::string_view> candidates(variables_.begin(), variables_.end());
    std::string known;
    for (const std::string_view variable : candidates) known += std::string(variable) + ", ";
    candidates.push_back("pi");
    for (const Function& function : kFunctions) candidates.push_back(function.name);
    fail_at(begin, "unknown name `" + std::string(word) + "`; known: " + known + "pi, and " +
                       Expression::functions() + did_you_mean(nearest(word, candidates)));
  }

  std::string_view text_;
  const std::vector<std::string>& variables_;
  std::size_t at_ = 0;
  int depth_ = 0;    // of recursion
  int waiting_ = 0;  // values on the stack after what was read
  std::vector<Instruction> program_;
};

Expression::Expression(std::string_view text, const std::vector<std::string>& variables)
    : program_(ExpressionCompiler(text, variables).compile()) {}

double Expression::operator()(std::span<const double> values) const noexcept {
  std::array<double, kMaxDepth> stack;
  std::size_t size = 0;
  for (const Instruction& instruction : program_) {
    switch (instruction.kind) {
      case Instruction::Kind::kConstant:
        stack[size++] = instruction.constant;
        break;
      case Instruction::Kind::kVariable:
        stack[size++] = values[instruction.variable];
        break;
      case Instruction::Kind::kUnary:
        stack[size - 1] = instruction.unary(stack[size - 1]);
        break;
      case Instruction::Kind::kBinary:
        --size;
        stack[size - 1] = instruction.binary(stack[size - 1], stack[size]);
        break;
      case Instruction::Kind::kClamp:
        size -= 2;
        stack[size - 1] = lesser(greater(stack[size - 1], stack[size]), stack[size + 1]);
        break;
    }
  }
  return stack[0];
}

std::string Expression::functions() {
  std::string names;
  for (const Function& function : kFunctions) {
    if (!names.empty()) names += ' ';
    names += function.name;
    names += function.arguments == 1 ? "(x)" : function.arguments == 2 ? "(a,b)" : "(x,low,high)";
  }
  return names;
}

}  // namespace gyrotwin
