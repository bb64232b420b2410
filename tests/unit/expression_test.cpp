#include "clients/simulate/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "services/runtime/error.hpp"
#include "tests/support/allocation_counter.hpp"

namespace gyrotwin {
namespace {

const std::vector<std::string> kNames{"t", "thx", "phi_dot"};
constexpr double kValues[] = {2.0, 0.25, -3.0};

double value(std::string_view text) { return Expression(text, kNames)(kValues); }

std::string refusal(std::string_view text) {
  try {
    Expression(text, kNames);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Expression, CountsAsOnPaper) {
  EXPECT_EQ(value("1 + 2*3 - 4/8"), 6.5);
  EXPECT_EQ(value("(1 + 2)*3"), 9.0);
  EXPECT_EQ(value("10 - 4 - 3"), 3.0);
  EXPECT_EQ(value("24/4/3"), 2.0);
  EXPECT_EQ(value("-2^2"), -4.0);
  EXPECT_EQ(value("(-2)^2"), 4.0);
  EXPECT_EQ(value("2^3^2"), 512.0);
  EXPECT_EQ(value("2**-1"), 0.5);
  EXPECT_EQ(value("--3"), 3.0);
  EXPECT_EQ(value("2*-3"), -6.0);
  EXPECT_EQ(value("+.5e1"), 5.0);
  EXPECT_EQ(value("1e-3"), 1e-3);
  EXPECT_EQ(value("0.1"), 0.1);
}

TEST(Expression, KnowsItsVariables) {
  EXPECT_EQ(value("2*(-5-phi_dot)"), -4.0);
  EXPECT_EQ(value("t"), 2.0);
  EXPECT_EQ(value("thx*t + phi_dot"), -2.5);
}

TEST(Expression, KnowsItsFunctions) {
  EXPECT_EQ(value("sin(t)"), std::sin(2.0));
  EXPECT_EQ(value("cos(t)"), std::cos(2.0));
  EXPECT_EQ(value("tan(t)"), std::tan(2.0));
  EXPECT_EQ(value("tanh(thx)"), std::tanh(0.25));
  EXPECT_EQ(value("exp(thx)"), std::exp(0.25));
  EXPECT_EQ(value("log(t)"), std::log(2.0));
  EXPECT_EQ(value("sqrt(thx)"), 0.5);
  EXPECT_EQ(value("abs(phi_dot)"), 3.0);
  EXPECT_EQ(value("sign(phi_dot) + 10*sign(t) + 100*sign(0)"), 9.0);
  EXPECT_EQ(value("min(t, phi_dot)"), -3.0);
  EXPECT_EQ(value("max(t, phi_dot)"), 2.0);
  EXPECT_EQ(value("clamp(phi_dot, -1, 1) + 10*clamp(thx,-1,1) + 100*clamp(t,-1,1)"), 101.5);
  EXPECT_EQ(value("pi"), std::numbers::pi);
  EXPECT_EQ(value("step(-1e-9) + 10*step(0) + 100*step(t)"), 110.0);
  EXPECT_EQ(value("square(1) + 10*square(4) + 100*square(0) + 1000*square(-1)"), -909.0);
}

TEST(Expression, WhatIsNotANumberStaysVisible) {
  for (const char* text :
       {"sqrt(phi_dot)", "log(-1)", "min(0/0, 1)", "min(1, 0/0)", "max(0/0, 1)", "max(1, 0/0)",
        "clamp(0/0, 0, 1)", "step(0/0)", "sign(0/0)", "square(1/0)"}) {
    EXPECT_TRUE(std::isnan(value(text))) << text << " = " << value(text);
  }
  EXPECT_EQ(value("1/0"), std::numeric_limits<double>::infinity());
}

TEST(Expression, RefusalsNameColumnAndFix) {
  const auto expect = [](std::string_view text, std::string_view part) {
    EXPECT_NE(refusal(text).find(part), std::string::npos) << text << ": " << refusal(text);
  };
  expect("2*(-5-phidot)",
         "column 7: unknown name `phidot`; known: t, thx, phi_dot, pi, and sin(x)");
  expect("2*(-5-phidot)", "did you mean `phi_dot`?");
  expect("1+sine(t)", "column 3: unknown name `sine`");
  expect("", "column 1: expected a number, a name or `(`, found the end");
  expect("2*", "column 3: expected a number, a name or `(`, found the end");
  expect("(1+2", "column 5: expected `)` for the one opened in column 1, found the end");
  expect("1)", "column 2: expected an operator or the end, found `)`");
  expect("2 phi_dot", "column 3: expected an operator or the end, found `p`");
  expect("sin t", "column 5: expected `(` after sin, found `t`");
  expect("sin(1,2)", "column 6: expected `)` (sin takes 1 argument), found `,`");
  expect("clamp(1,2)", "column 10: expected `,` (clamp takes 3 arguments), found `)`");
  expect("1e999", "column 1: expected a number");
  expect("inf", "unknown name `inf`");
  expect("nan", "unknown name `nan`");
  expect("1..2", "column 3: expected an operator");
  expect("a=1", "unknown name `a`");
  expect("$", "found `$`");
}

TEST(Expression, IsBoundedInDepthNotInLength) {
  std::string sum = "0";
  for (int i = 1; i <= 10000; ++i) sum += "+1";
  EXPECT_EQ(value(sum), 10000.0);
  const auto nested = [](int depth) {
    return std::string(static_cast<std::size_t>(depth), '(') + "1" +
           std::string(static_cast<std::size_t>(depth), ')');
  };
  EXPECT_EQ(value(nested(60)), 1.0);
  for (const std::string& deep : {nested(100000), std::string(100000, '('), [] {
                                    std::string powers = "1";
                                    for (int i = 0; i < 100000; ++i) powers += "^1";
                                    return powers;
                                  }()}) {
    EXPECT_NE(refusal(deep).find("nested deeper than 64"), std::string::npos);
  }
  std::string signs(100000, '-');
  EXPECT_EQ(value(signs + "1"), 1.0);
}

TEST(Expression, EvaluatesWithoutAllocation) {
  const Expression expression("clamp(2*(-5 - phi_dot), -1, 1)*square(t) + min(thx, 0)^2", kNames);
  const AllocationCounter counter;
  double sum = 0.0;
  for (int i = 0; i < 100; ++i) sum += expression(kValues);
  EXPECT_EQ(counter.count(), 0);
  EXPECT_EQ(sum, -100.0);
}

}  // namespace
}  // namespace gyrotwin
