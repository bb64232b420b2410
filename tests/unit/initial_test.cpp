#include "clients/common/initial.hpp"

#include <gtest/gtest.h>

#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

using Values = std::vector<double>;

const std::vector<std::string> kUmbrella{"thx", "thy", "phi", "tg"};
const std::vector<std::string> kPair{"th", "q"};  // a coordinate that is called as the list is

Initial parsed(std::string_view text) {
  return parse_initial(text, kUmbrella, {{1, 2, 3, 4}, {5, 6, 7, 8}});
}

std::string refusal(std::string_view text, const std::vector<std::string>& names = kUmbrella) {
  const Values zeros(names.size(), 0.0);
  try {
    parse_initial(text, names, {zeros, zeros});
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

TEST(Initial, TakesListsInTheMachinesOrder) {
  const Initial both = parsed("q=0.02,0.01,0.1,0.06,v=0,-1e-3,-5.0,+2");
  EXPECT_EQ(both.q, (Values{0.02, 0.01, 0.1, 0.06}));
  EXPECT_EQ(both.v, (Values{0, -1e-3, -5, 2}));
  const Initial bracketed = parsed("v=[0, 0, -5, 0]");
  EXPECT_EQ(bracketed.q, (Values{1, 2, 3, 4})) << "what is not named stays";
  EXPECT_EQ(bracketed.v, (Values{0, 0, -5, 0}));
}

TEST(Initial, TakesNames) {
  const Initial one = parsed("thy=0.05,phi_dot=-5");
  EXPECT_EQ(one.q, (Values{1, 0.05, 3, 4}));
  EXPECT_EQ(one.v, (Values{5, 6, -5, 8}));
  const Initial mixed = parsed("thx=0.5,q=0,0,0,0");
  EXPECT_EQ(mixed.q, (Values{0.5, 0, 0, 0})) << "a name wins over a list";
}

TEST(Initial, QIsTheListAlsoWhereACoordinateIsCalledQ) {
  const Initial pair = parse_initial("q=0.035,0.01,q_dot=2", kPair, {{0, 0}, {0, 0}});
  EXPECT_EQ(pair.q, (Values{0.035, 0.01}));
  EXPECT_EQ(pair.v, (Values{0, 2}));
  EXPECT_TRUE(contains(refusal("q=0.035", kPair), "expected 2, for th, q"));
}

TEST(Initial, RefusalsSayWhatTheMachineTakes) {
  EXPECT_EQ(refusal("thx=0"), "accepted");
  EXPECT_TRUE(contains(refusal("q=1,2,3"), "q= has 3 numbers; expected 4, for thx, thy, phi, tg"));
  EXPECT_TRUE(contains(refusal("q=1,2,3,4,5"), "has 5 numbers"));
  EXPECT_TRUE(contains(refusal("v="), "v= has 0 numbers"));
  EXPECT_TRUE(contains(refusal("thz=1"), "no `thz`"));
  EXPECT_TRUE(contains(refusal("thz=1"), "did you mean `thx`?"));
  EXPECT_TRUE(contains(refusal("0.1,0.2"), "Write q= or v="));
  EXPECT_TRUE(contains(refusal("thx=1,2"), "what is `2`?"));
  EXPECT_TRUE(contains(refusal("q=1,2,3,4,q=1,2,3,4"), "given twice"));
}

TEST(Initial, TakesFiniteNumbersOnly) {
  for (const char* text : {"thx=nan", "thx=inf", "thx=-inf", "thx=1e999", "thx=", "thx=1x", "thx=+",
                           "thx=0.1=2", "q=1,nan,0,0", "thx=1.2.3"}) {
    EXPECT_TRUE(contains(refusal(text), "is no finite number")) << text << ": " << refusal(text);
  }
}

}  // namespace
}  // namespace gyrotwin
