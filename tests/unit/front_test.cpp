#include <gtest/gtest.h>

#include <sstream>

#include "clients/gyrotwin/verbs.hpp"

namespace gyrotwin {
namespace {

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

TEST(FrontPage, ListsEveryVerbOnALineOfItsOwn) {
  const auto check = [](const Program& p) {
    EXPECT_TRUE(contains(front_page(), "\n  " + std::string(p.name) + " ")) << p.name;
    EXPECT_TRUE(contains(front_page(), std::string(p.summary) + "\n")) << p.name;
  };
  for (const Program& p : kDaemons) check(p);
  for (const Program& p : kClients) check(p);
}

TEST(FrontPage, ListsEveryProgram) {
  std::istringstream programs(GYROTWIN_PROGRAMS);
  for (std::string program; programs >> program;) {
    if (program == "gyrotwin") continue;
    const std::string verb = program.substr(std::string_view("gyrotwin-").size());
    EXPECT_TRUE(contains(front_page(), "\n  " + verb + " ")) << program;
    EXPECT_TRUE(contains(front_words(), verb)) << program;
    EXPECT_TRUE(contains(front_manual(), ".BR gyrotwin\\-" + verb + " (1)")) << program;
  }
}

TEST(UnknownVerb, SuggestsTheNearest) {
  EXPECT_TRUE(contains(unknown_verb("distrub"), "did you mean `disturb`?"));
  EXPECT_TRUE(contains(unknown_verb("cntl"), "did you mean `ctl`?"));
  EXPECT_TRUE(contains(unknown_verb("integrater"), "did you mean `integrator`?"));
  EXPECT_FALSE(contains(unknown_verb("xyzzy"), "did you mean")) << "nothing is near";
  EXPECT_TRUE(contains(unknown_verb("xyzzy"), "gyrotwin --help"));
  EXPECT_TRUE(contains(unknown_verb("--set"), "options follow it"));
}

}  // namespace
}  // namespace gyrotwin
