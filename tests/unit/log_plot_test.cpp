// Plots of logs: no peak is lost, and what cannot be drawn is said.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>

#include "clients/common/file_text.hpp"
#include "clients/log/envelope.hpp"
#include "clients/log/plot.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"
#include "tests/support/small_log.hpp"

namespace gyrotwin {
namespace {

namespace fs = std::filesystem;

TEST(Envelope, KeepsEveryPeakOfALongCurveInLittle) {
  constexpr int kPoints = 1'000'000;
  constexpr std::size_t kStretches = 256;
  for (const int peak : {1, 12'345, 500'000, kPoints - 2}) {
    Envelope envelope(kStretches);
    for (int i = 0; i < kPoints; ++i) {
      envelope.add(1e-3 * i, i == peak ? 1.0 : i == peak + 1 ? -1.0 : 0.0);
    }
    const Envelope::Points kept = envelope.points();
    EXPECT_LE(kept.x.size(), 4 * kStretches);
    EXPECT_GE(kept.x.size(), 4 * kStretches / 2);
    EXPECT_TRUE(std::ranges::is_sorted(kept.x));
    const auto high = std::ranges::max_element(kept.y) - kept.y.begin();
    const auto low = std::ranges::min_element(kept.y) - kept.y.begin();
    EXPECT_EQ(kept.y[static_cast<std::size_t>(high)], 1.0);
    EXPECT_EQ(kept.x[static_cast<std::size_t>(high)], 1e-3 * peak);
    EXPECT_EQ(kept.x[static_cast<std::size_t>(low)], 1e-3 * (peak + 1));
    EXPECT_EQ(kept.x.front(), 0.0);
    EXPECT_EQ(kept.x.back(), 1e-3 * (kPoints - 1));
  }
}

TEST(Envelope, IsInterruptedWhereANumberIsNone) {
  Envelope envelope(16);
  for (const double y : {0.0, 0.0, std::nan(""), 0.0}) envelope.add(envelope.points().x.size(), y);
  EXPECT_TRUE(envelope.is_zero());
  const Envelope::Points kept = envelope.points();
  EXPECT_EQ(std::ranges::count_if(kept.y, [](double y) { return std::isnan(y); }), 1);
  envelope.add(100.0, -1e-9);
  EXPECT_FALSE(envelope.is_zero());
}

class LogPlot : public testing::Test {
 protected:
  LogPlot() {
    std::string pattern = (fs::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    LogBytes bytes = support::sample_opening(false, 0);
    for (int i = 0; i < 100; ++i) {
      state_t state{};
      state.header.rig_id = support::kSampleRig;
      state.tilt_rad[0] = i == 50 ? 0.25 : 0.0;
      state.drive_torque_nm[1] = 1e-3 * i;
      LogBytes payload(static_cast<std::size_t>(state.getEncodedSize()));
      state.encode(payload.data(), 0, state.getEncodedSize());
      append_event(bytes, {0, 1000 * i, "TEST/LIVE/STATE", payload});
    }
    const LogBytes reply = support::sample_content(Channel::kReply, false).data;
    append_event(bytes, {0, 100'000, "TEST/REPLY", reply});
    LogWriter(folder_ / "run.lcm").append(bytes);
  }
  ~LogPlot() override { fs::remove_all(folder_); }

  PlotOptions of(std::vector<std::string> fields) const {
    return {.file = folder_ / "run.lcm", .output = folder_ / "plot.svg", .fields = fields};
  }
  std::string failure(const std::string& field) const {
    try {
      plot_log(of({field}));
    } catch (const std::exception& error) {
      EXPECT_FALSE(fs::exists(folder_ / "plot.svg"));
      return error.what();
    }
    ADD_FAILURE() << field << " did not fail";
    return "";
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++n;
    return n;
  }

  fs::path folder_;
};

TEST_F(LogPlot, DrawsWhatTheRigHasWithAPanelAUnit) {
  ASSERT_EQ(plot_log(of({})), kDone);
  const std::string svg = file_text(folder_ / "plot.svg");
  EXPECT_EQ(count(svg, "time since the first message [s]"), 2U);
  for (const char* text : {">[rad]<", ">[N m]<", ">tilt_rad[0]<", ">drive_torque_nm[1]<",
                           "'>run.lcm  TEST/LIVE/STATE<"}) {
    EXPECT_EQ(count(svg, text), 1U) << text;
  }
  EXPECT_EQ(count(svg, "gimbal_angle_rad"), 0U) << "what is 0 throughout is not there";
  EXPECT_THROW(plot_log(of({})), Error) << "a file that is there is kept";
}

TEST_F(LogPlot, DrawsNamedFieldsOfSeveralChannels) {
  ASSERT_EQ(plot_log(of({"LIVE/STATE.tilt_rad[0]", "STATE.header.tick", "REPLY.result",
                         "LIVE/STATE.rotor_speed_rad_s"})),
            kDone);
  const std::string svg = file_text(folder_ / "plot.svg");
  for (const char* text : {">LIVE/STATE.tilt_rad[0]<", ">LIVE/STATE.header.tick<", ">REPLY.result<",
                           ">LIVE/STATE.rotor_speed_rad_s[3]<"}) {
    EXPECT_EQ(count(svg, text), 1U) << text;
  }
}

TEST_F(LogPlot, SaysWhatCannotBeDrawn) {
  EXPECT_NE(failure("LIVE/STATE.tilt_red[0]").find("did you mean `tilt_rad[0]`?"),
            std::string::npos);
  EXPECT_NE(failure("LIVE/STATE.tilt_rad[2]").find("state_t has no field tilt_rad[2]"),
            std::string::npos);
  EXPECT_NE(failure("LIVE/STATE").find("expected CHANNEL.FIELD"), std::string::npos);
  EXPECT_NE(failure("REPLY.text").find("is a text"), std::string::npos);
  EXPECT_NE(failure("LIVE/COMMAND.value").find("TEST/LIVE/STATE"), std::string::npos);
}

}  // namespace
}  // namespace gyrotwin
