// The twin beside a live rig: near the truth, sure of its health, ahead of a fall, fit to close the
// loop, and the same once more from the record.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include "services/runtime/text.hpp"
#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;

/// A rig with its twin.
class TwinLab : public Lab {
 public:
  explicit TwinLab(const std::string& of, std::vector<std::string> more = {})
      : Lab(of, with_estimate(std::move(more))) {}
  ~TwinLab() { mirror.reset(); }

  void start_twin() {
    mirror = start("mirror");
    const bool came = until([](const Reception& heard) {
      if (heard.channel != Channel::kMirrorStatus) return false;
      status_t status;
      Bus::decode(heard, status);
      return status.mode == status_t::MODE_WAITING || status.mode == status_t::MODE_ACTIVE;
    });
    ASSERT_TRUE(came) << mirror->output();
  }

  std::unique_ptr<support::Process> mirror;

 private:
  static std::vector<std::string> with_estimate(std::vector<std::string> more) {
    more.insert(more.begin(), "loop.state=estimate");
    return more;
  }
};

TEST(Twin, IsNearTheTruthAndSaysThatAllIsWell) {
  TwinLab lab("double_brennan");
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.start_twin());
  ASSERT_NO_FATAL_FAILURE(lab.balance());

  std::map<std::int64_t, truth_t> truths;
  double worst = 0.0;
  int compared = 0, agreed = 0, healths = 0, forecasts = 0;
  ASSERT_TRUE(lab.until([&](const Reception& heard) {
    if (heard.channel == Channel::kTruth) {
      truth_t truth;
      Bus::decode(heard, truth);
      truths[truth.header.sequence] = truth;
    } else if (heard.channel == Channel::kTwinState) {
      state_t twin;
      Bus::decode(heard, twin);
      const auto truth = truths.find(twin.header.sequence);
      if (truth == truths.end()) return false;
      worst = std::max({worst, std::abs(twin.tilt_rad[0] - truth->second.q[0]),
                        std::abs(twin.tilt_rad[1] - truth->second.q[1])});
      ++compared;
    } else if (heard.channel == Channel::kHealth) {
      health_t health;
      Bus::decode(heard, health);
      healths += health.verdict != health_t::NONE;
      agreed += health.verdict == health_t::AGREES;
    } else if (heard.channel == Channel::kForecast) {
      forecast_t forecast;
      Bus::decode(heard, forecast);
      ++forecasts;
      EXPECT_EQ(forecast.outcome, forecast_t::STANDS);
      EXPECT_EQ(forecast.law, 1);
    }
    return compared >= 1000 && healths >= 50 && forecasts >= 20;
  }));
  EXPECT_LT(worst, 0.01) << "the accelerometer's bias alone is 0.003 rad";
  EXPECT_GT(agreed, healths * 9 / 10);

  EXPECT_EQ(lab.run("ctl", {"status"}), 0);
  EXPECT_NE(lab.said.find("mirror      ACTIVE"), std::string::npos) << lab.said;
}

TEST(Twin, SeesAFallComeWhenTheControllerIsKilled) {
  TwinLab lab("double_brennan");
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.start_twin());
  ASSERT_NO_FATAL_FAILURE(lab.balance());
  lab.controller->signal(SIGKILL);

  std::int64_t foreseen = -1, fallen = -1;
  ASSERT_TRUE(lab.until(
      [&](const Reception& heard) {
        if (heard.channel == Channel::kForecast) {
          forecast_t forecast;
          Bus::decode(heard, forecast);
          const bool falls = forecast.outcome == forecast_t::FALLS;
          if (falls && foreseen < 0) foreseen = forecast.header.sim_time_ns + forecast.age_ns;
        } else if (heard.channel == Channel::kState) {
          state_t state;
          Bus::decode(heard, state);
          if (state.mode == status_t::MODE_FALLEN) fallen = state.header.sim_time_ns;
        }
        return fallen >= 0;
      },
      120.0));
  ASSERT_GE(foreseen, 0) << "no forecast of it";
  EXPECT_LE(foreseen, fallen - 300'000'000);
}

TEST(Twin, ClosesTheLoopAndIsMissedWhenItDies) {
  TwinLab lab("prototype_b");
  lab.start_owner();
  ASSERT_NO_FATAL_FAILURE(lab.start_twin());
  lab.controller = lab.start("controller", {"--on", "twin"});
  ASSERT_NO_FATAL_FAILURE(lab.balance());
  ASSERT_EQ(lab.run("disturb", {"impulse", "--watch", "2"}), 0) << lab.said;

  lab.mirror->signal(SIGKILL);
  lab.await_mode(status_t::MODE_SAFE_STOP);
  EXPECT_TRUE(lab.until([](const Reception& heard) {
    if (heard.channel != Channel::kControllerStatus) return false;
    status_t status;
    Bus::decode(heard, status);
    return text_view(status.text).find("no TWIN/STATE is heard") != std::string_view::npos;
  })) << lab.controller->output();
}

TEST(Twin, NamesWhatItWaitsFor) {
  TwinLab lab("double_brennan");
  lab.mirror = lab.start("mirror");
  const auto says = [&](std::string_view what) {
    return lab.until([what](const Reception& heard) {
      if (heard.channel != Channel::kMirrorStatus) return false;
      status_t status;
      Bus::decode(heard, status);
      return status.mode == status_t::MODE_WAITING &&
             text_view(status.text).find(what) != std::string_view::npos;
    });
  };
  EXPECT_TRUE(says("no owner is heard"));

  // An owner that speaks, and has no sensors.
  Bus owner(bus_config(lab.rig, header_t::SIMULATION));
  bool named = false;
  for (int i = 1; i < 300 && !named; ++i) {
    status_t status{};
    status.service = status_t::INTEGRATOR;
    set_text(status.host, "bench");
    owner.send(Channel::kIntegratorStatus, status, {5, i, 0, 0});
    named = lab.until(
        [](const Reception& heard) {
          if (heard.channel != Channel::kMirrorStatus) return false;
          status_t mirror;
          Bus::decode(heard, mirror);
          return text_view(mirror.text).find("sends no SENSORS") != std::string_view::npos;
        },
        0.1);
  }
  EXPECT_TRUE(named);
}

TEST(Twin, TheRecordGivesItOnceMore) {
  TwinLab lab("double_brennan", {"loop.clock=lockstep"});
  const std::string log = (lab.folder() / "run.lcm").string();
  const std::string first = (lab.folder() / "first.lcm").string();
  const std::string second = (lab.folder() / "second.lcm").string();
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  const auto record = lab.start("log", {"record", log});
  ASSERT_TRUE(lab.until([&](const Reception&) { return std::filesystem::exists(log); }));
  ASSERT_NO_FATAL_FAILURE(lab.arm());
  ASSERT_TRUE(lab.until([](const Reception& heard) {
    if (heard.channel != Channel::kState) return false;
    state_t state;
    Bus::decode(heard, state);
    return state.header.tick > 1500;
  }));
  lab.owner.reset();
  lab.controller.reset();
  record->signal(SIGINT);
  EXPECT_EQ(record->wait(), 0) << record->output();

  const auto rerun = [&](const std::vector<std::string>& arguments) {
    std::vector<std::string> words{std::string(GYROTWIN_BIN) + "/gyrotwin-rerun"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    support::Process process(words, lab.folder() / "rerun");
    const int code = process.wait();
    lab.said = process.output();
    return code;
  };
  const auto content = [](const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_EQ(rerun({"mirror", log, "--output", first}), 0) << lab.said;
  EXPECT_EQ(rerun({"mirror", log, "--output", second}), 0) << lab.said;
  EXPECT_GT(content(first).size(), 300'000u);
  EXPECT_EQ(content(first), content(second));
  EXPECT_EQ(rerun({"controller", log}), 0) << lab.said;
  EXPECT_NE(lab.said.find(": identical"), std::string::npos) << lab.said;
}

}  // namespace
}  // namespace gyrotwin
