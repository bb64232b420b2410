// Formulas that users write on the command line, such as `2*(-5 - phi_dot)`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin {

/// A formula compiled once into a flat program, then evaluated without allocation or exception.
class Expression {
 public:
  /// + - * / ^ (or **), parentheses, numbers, pi, the variables and the functions of functions().
  /// @throws Error `column N: ...` (from 1) with what was found, what was expected and the fix
  Expression(std::string_view text, const std::vector<std::string>& variables);

  /// @param values of the variables, in the order given at construction
  double operator()(std::span<const double> values) const noexcept;

  /// What can be called, one line for a user.
  static std::string functions();

  static constexpr std::size_t kMaxDepth = 64;  ///< of nesting, and of values waiting

 private:
  friend class ExpressionCompiler;
  using Unary = double (*)(double);
  using Binary = double (*)(double, double);

  struct Instruction {
    enum class Kind : std::uint8_t { kConstant, kVariable, kUnary, kBinary, kClamp };
    Kind kind;
    double constant = 0.0;
    std::size_t variable = 0;
    Unary unary = nullptr;
    Binary binary = nullptr;
  };

  std::vector<Instruction> program_;  // in reverse Polish order
};

}  // namespace gyrotwin
