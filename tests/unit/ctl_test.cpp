#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "clients/common/tilt.hpp"
#include "clients/ctl/balance.hpp"
#include "clients/ctl/mode_table.hpp"
#include "clients/ctl/verbs.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(ModeTable, HasARowForEveryTransition) {
  const auto text = lines_of(mode_table(TableStyle::kText));
  const auto markdown = lines_of(mode_table(TableStyle::kMarkdown));
  ASSERT_EQ(text.size(), kTransitions.size() + 1);
  ASSERT_EQ(markdown.size(), kTransitions.size() + 2);
  for (std::size_t i = 0; i < kTransitions.size(); ++i) {
    const Transition& t = kTransitions[i];
    EXPECT_EQ(markdown[i + 2],
              fmt::format("| {} | {} | {} |", name_of(t.from), t.when, name_of(t.to)));
    const std::string& row = text[i + 1];
    EXPECT_NE(row.find(t.when), std::string::npos) << row;
    EXPECT_TRUE(row.ends_with("  " + std::string(name_of(t.to)))) << row;
  }
}

TEST(ModeTable, TextIsAlignedAndNamesAModeOnce) {
  const auto text = lines_of(mode_table(TableStyle::kText));
  const std::size_t column = text[0].find("leads to");
  for (std::size_t i = 1; i < text.size(); ++i) {
    EXPECT_EQ(text[i][column - 1], ' ') << text[i];
    EXPECT_NE(text[i][column], ' ') << text[i];
  }
  const auto named =
      std::ranges::count_if(text, [](const std::string& row) { return row[0] != ' '; });
  EXPECT_EQ(named, 1 + 6) << "the heading and six modes";
}

const Verb& verb_named(std::string_view name) {
  return *std::ranges::find(kVerbs, name, &Verb::name);
}

TEST(Verbs, AnAppliedRequestIsOneLine) {
  reply_t reply{};
  reply.applied_tick = 512;
  set_text(reply.text, "RUNNING");
  EXPECT_EQ(applied_line(verb_named("arm"), reply), "armed: RUNNING from tick 512");
  set_text(reply.text, "HELD at the rig file's initial state");
  EXPECT_EQ(applied_line(verb_named("reset"), reply),
            "reset: HELD at the rig file's initial state");
  set_text(reply.text, "speed 0.5");
  EXPECT_EQ(applied_line(verb_named("speed"), reply), "speed 0.5 from tick 512");
  set_text(reply.text, "rotors spin up");
  EXPECT_EQ(applied_line(verb_named("rotors"), reply), "rotors spin up from tick 512");
}

class BalanceTest : public ::testing::Test {
 protected:
  bool on(double at_s, double tilt_deg, std::int32_t mode = status_t::MODE_RUNNING) {
    state_t state{};
    state.header.epoch = epoch_;
    state.header.sim_time_ns = static_cast<std::int64_t>(1e9 * at_s + 0.5);
    state.mode = mode;
    state.valid = state_t::VALID_TILT;
    state.tilt_rad[1] = -radians(tilt_deg);
    return watch_.on(state);
  }
  BalanceWatch watch_{radians(1.0), 1'000'000'000};
  std::int64_t epoch_ = 1;
};

TEST_F(BalanceTest, IsContentAfterTheWholeSpan) {
  EXPECT_FALSE(on(5.0, 0.9));
  EXPECT_FALSE(on(5.999, 0.9));
  EXPECT_TRUE(on(6.0, 0.9));
  EXPECT_NEAR(degrees(watch_.tilt()), 0.9, 1e-12);
}

TEST_F(BalanceTest, BeginsAnewAfterEveryBreak) {
  EXPECT_FALSE(on(0.0, 0.9));
  EXPECT_FALSE(on(0.9, 1.1)) << "too far";
  EXPECT_FALSE(on(1.5, 0.9));
  EXPECT_FALSE(on(2.0, 0.9, status_t::MODE_PAUSED)) << "standing still is no balance";
  EXPECT_FALSE(on(2.6, 0.9));
  epoch_ = 2;
  EXPECT_FALSE(on(3.7, 0.9)) << "another run";
  EXPECT_TRUE(on(4.7, 0.9));
}

TEST_F(BalanceTest, NeedsATilt) {
  state_t state{};
  state.mode = status_t::MODE_RUNNING;
  BalanceWatch watch(radians(1.0), 0);
  EXPECT_FALSE(watch.on(state));
  state.valid = state_t::VALID_TILT;
  state.tilt_rad[0] = std::nan("");
  EXPECT_FALSE(watch.on(state));
  state.tilt_rad[0] = 0.0;
  EXPECT_TRUE(watch.on(state));
}

}  // namespace
}  // namespace gyrotwin
