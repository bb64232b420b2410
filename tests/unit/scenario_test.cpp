// Scenario files: what they say, and every way to get one wrong.
#include "clients/common/scenario.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "services/integrator/schedule.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

std::vector<PlannedEvent> read(const std::string& text,
                               const std::vector<std::string>& overrides = {}) {
  return read_scenario(text, "s.toml", overrides);
}

std::string mistakes(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read(text, overrides);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

/// With the heading line that names the file.
std::string told(const std::string& mistake) { return "s.toml cannot be used:\n" + mistake; }

TEST(ScenarioFile, SaysWhatTheCommandLineSays) {
  const auto events = read(R"(
[[event]]
kind = "sensor"
at_s = 3
sensor = "acceleration"
bias_m_s2 = 0.5
duration_s = 1.5

[[event]]
at_s = 1.0
kind = "step"
roll_nm = 5
push_y_n = -2.5

[[event]]
kind = "rotor"
at_s = 3.0
rotor = 2

[[event]]
kind = "drive"
at_s = 0.5
drive = "all"
strength = 0.5
)");
  ASSERT_EQ(events.size(), 4u);
  const auto request = [&](std::size_t i) {
    return request_of(events[i], Rig{}, 2 * kMillisecond, 100);
  };
  EXPECT_EQ(events[0].event.kind->name, "drive") << "in order of time";
  EXPECT_EQ(request(0).target, -1);
  EXPECT_EQ(request(0).start_tick, 100 + 250);
  EXPECT_EQ(events[1].place, "s.toml:9");
  EXPECT_EQ(request(1).moment_nm[0], 5.0);
  EXPECT_EQ(request(1).force_n[1], -2.5);
  EXPECT_EQ(events[2].event.kind->name, "sensor") << "of the same time, in order of the file";
  EXPECT_EQ(request(2).level, 0.5);
  EXPECT_EQ(request(2).duration_ns, 1500 * kMillisecond);
  EXPECT_EQ(request(3).target, 2);
  EXPECT_EQ(request(3).start_tick, 100 + 1500);
}

TEST(ScenarioFile, BeginsWithTickOneWhereZeroWouldMeanTheNext) {
  const auto events = read("[[event]]\nkind = \"link\"\nat_s = 0\n");
  EXPECT_EQ(request_of(events[0], Rig{}, kMillisecond, 0).start_tick, 1);
  EXPECT_EQ(request_of(events[0], Rig{}, kMillisecond, 7).start_tick, 7);
}

TEST(ScenarioFile, FlagsThatAreFalseSayNothing) {
  const std::string sensor = "[[event]]\nkind = \"sensor\"\nat_s = 0\nsensor = \"gyro\"\n";
  EXPECT_EQ(read(sensor + "drop = true\nstuck = false\n")[0].event.values.size(), 1u);
  EXPECT_EQ(mistakes(sensor + "drop = false\n"),
            told("s.toml:1:1: error: sensor: give exactly one of `stuck`, `bias_rad_s`, "
                 "`noise_rad_s`, `drop`, `delay_s`"));
}

TEST(ScenarioFile, TellsAllMistakesAtOnceWithTheirPlaces) {
  EXPECT_EQ(mistakes(R"([[event]]
at_s = -1
kind = "step"
roll = 3
pitch_nm = "x"
[[event]]
kind = "sensor"
at_s = 2
sensor = "gyor"
)"),
            told("s.toml:2:8: error: `at_s` is -1, expected a number from 0 to 1e+06\n"
                 "s.toml:4:1: error: unknown key `roll`; the keys of \"step\" are kind, at_s, "
                 "roll_nm, pitch_nm, yaw_nm, push_x_n, push_y_n, push_z_n, duration_s, rise_s; "
                 "did you mean `roll_nm`?\n"
                 "s.toml:5:12: error: `pitch_nm` is 'x', expected a number from -1e+09 to 1e+09\n"
                 "s.toml:9:10: error: `sensor` is 'gyor', expected one of \"gyro\", "
                 "\"acceleration\", \"disc\", \"gimbals\", \"rotors\", \"currents\", \"voltage\", "
                 "\"load_cell\"; did you mean `gyro`?"));
}

TEST(ScenarioFile, TellsEachKindOfMistake) {
  const auto contains = [](const std::string& text, const std::string& part) {
    EXPECT_NE(mistakes(text).find(part), std::string::npos) << mistakes(text);
  };
  contains("", "s.toml:1:1: error: no [[event]] is there");
  contains("event = 3", "s.toml:1:1: error: `event` is to be a list of tables");
  contains("event = [3]", "`event` is to be a list of tables");
  contains("[[event", "error: not TOML: ");
  contains("evnt = 3",
           "unknown key `evnt`; a scenario has [[event]] tables alone; did you mean "
           "`event`?");
  contains("[[event]]\nat_s = 1", "s.toml:1:1: error: missing key `kind`, one of \"impulse\"");
  contains("[[event]]\nat_s = 1\nkind = \"impuls\"", "did you mean `impulse`?");
  contains("[[event]]\nat_s = 1\nkind = 3", "s.toml:3:8: error: `kind` is 3, expected one of");
  contains("[[event]]\nkind = \"link\"", "s.toml:1:1: error: missing key `at_s`");
  contains("[[event]]\nkind = \"link\"\nat_s = nan", "`at_s` is nan, expected a number");
  contains("[[event]]\nkind = \"drive\"\nat_s = 1\nstrength = 0",
           "missing key `drive`, one of \"0\", \"1\"");
  contains("[[event]]\nkind = \"drive\"\nat_s = 1\ndrive = 4\nstrength = 0", "`drive` is 4,");
  contains("[[event]]\nkind = \"gust\"\nat_s = 1\nroll_nm = 1\nseed = 1.5",
           "`seed` is 1.5, expected an integer");
  contains("[[event]]\nkind = \"ramp\"\nat_s = 1\nroll_nm = 1", "ramp: `rise_s` is missing");
}

TEST(ScenarioFile, TakesOtherValues) {
  const std::string text = "[[event]]\nkind = \"step\"\nat_s = 1\nroll_nm = 5\n";
  const auto events = read(
      text, {"event1.roll_nm=-2.5", "event1.at_s=0.5", "event1.at_s=2", "event1.duration_s=1"});
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].at_s, 2.0);
  double roll = 0.0;
  for (const auto& [quantity, value] : events[0].event.values) {
    if (quantity->unit.symbol == "N m") roll = value;
  }
  EXPECT_EQ(roll, -2.5);

  for (const std::string form :
       {"roll_nm=1", "event.roll_nm=1", "event1.roll_nm", "event1=2.0", "event1.=2",
        "event1.roll_nm=", "event1.roll_nm=1\nat_s=9", "event99999999999999999999.roll_nm=1",
        "events1.roll_nm=1", "event-1.roll_nm=1", "event1x.roll_nm=1", ""}) {
    EXPECT_NE(
        mistakes(text, {form}).find("`" + form + "` changes nothing; expected eventN.key=value"),
        std::string::npos)
        << form;
  }
  for (const std::string number : {"0", "2", "1000"}) {
    EXPECT_NE(mistakes(text, {"event" + number + ".roll_nm=1"})
                  .find("there are 1 events, counted from 1"),
              std::string::npos)
        << number;
  }
  EXPECT_NE(mistakes(text, {"event1.rol_nm=1"}).find("did you mean `roll_nm`?"), std::string::npos);
}

TEST(ScenarioFile, HoldsAsManyEventsAsAnOwner) {
  std::string text;
  for (int i = 0; i < Schedule::kCapacity; ++i) text += "[[event]]\nkind = \"link\"\nat_s = 1\n";
  EXPECT_EQ(mistakes(text), "none");
  EXPECT_NE(mistakes(text + text).find("128 events, and an owner takes 64 at most"),
            std::string::npos);
}

TEST(ShippedScenarios, CanBeReadByTheirNames) {
  int found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(rig_folder() / "scenarios")) {
    EXPECT_FALSE(load_scenario(entry.path().stem().string()).empty()) << entry.path();
    ++found;
  }
  EXPECT_GE(found, 2);
  try {
    load_scenario("push_and_gusts");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean `push_and_gust`?"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(load_scenario("./no_such.toml"), Error);
}

}  // namespace
}  // namespace gyrotwin
