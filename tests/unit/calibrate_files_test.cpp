// Rig files that are written, logs that are no good, keys and experiments.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "clients/calibrate/experiments.hpp"
#include "clients/calibrate/family.hpp"
#include "clients/calibrate/recording.hpp"
#include "clients/calibrate/rig_text.hpp"
#include "clients/calibrate/segment.hpp"
#include "clients/common/run_name.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig_reader.hpp"
#include "tests/support/recorded_run.hpp"

namespace gyrotwin::calibration {
namespace {

using support::Folder;
using support::record_run;

std::string shipped(const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(rig_folder() / (name + ".toml"), std::ios::binary).rdbuf();
  return text.str();
}

std::string message_of(const std::function<void()>& what) {
  try {
    what();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(RigText, ChangesOneLineOfAShippedRigAndNothingElse) {
  const std::string before = shipped("prototype_b");
  const std::string after = with_values(
      before, {{"disc.coulomb_friction_nm", "0.1234", "measured: sigma 0.0005, a.lcm"}});
  const std::string old = "coulomb_friction_nm = 0.1            # estimated: bearing and gear\n";
  const std::string changed =
      "coulomb_friction_nm = 0.1234  # measured: sigma 0.0005, a.lcm; before: 0.1, estimated: "
      "bearing and gear\n";
  const std::size_t at = before.find(old);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(after, before.substr(0, at) + changed + before.substr(at + old.size()));
}

TEST(RigText, ChangesEveryNumberOfEveryShippedMachineInPlace) {
  for (const std::string& name : shipped_rigs()) {
    const Rig rig = load_rig(name);
    for (const ExperimentKind& kind : kExperiments) {
      std::vector<NewValue> values;
      for (const std::string& key : keys_of(kind, rig))
        values.push_back({key, "0.0625", "measured"});
      const std::string before = shipped(name);
      const std::string after = with_values(before, values);
      EXPECT_EQ(std::count(before.begin(), before.end(), '\n'),
                std::count(after.begin(), after.end(), '\n'))
          << name << " " << kind.name;
    }
  }
}

TEST(RigText, KeepsOddLayout) {
  const std::string document =
      "# a = 1\r\n[ disc ]  # the disc\r\n  b=2.0 # two\r\n\r\n# about c\r\n[c]\r\nb = 3.0\r\nlast "
      "= \"#\"";
  EXPECT_EQ(with_values(document, {{"disc.b", "2.5", "new"}}),
            "# a = 1\r\n[ disc ]  # the disc\r\n  b=2.5  # new; before: 2.0, two\r\n\r\n# about "
            "c\r\n[c]\r\nb = 3.0\r\nlast = \"#\"");
  EXPECT_EQ(with_values("[a]\nx = 1.0\n\n[b]\ny = 1.0\n", {{"a.z", "2.0", "new"}}),
            "[a]\nx = 1.0\nz = 2.0  # new\n\n[b]\ny = 1.0\n");
  EXPECT_EQ(with_values("[a]\nx = 1.0\n", {{"b.z", "2.0", "new"}}),
            "[a]\nx = 1.0\n\n[b]\nz = 2.0  # new\n");
}

TEST(RigText, RefusesWhatItWouldChangeWrongly) {
  const std::string document = "[a]\ntext = \"\"\"\n[b]\nx = 1.0\n\"\"\"\n[b]\nx = 2.0\n";
  EXPECT_THROW(with_values(document, {{"b.x", "3.0", "new"}}), Error);
  EXPECT_THROW(with_values("no toml", {}), Error);
}

TEST(RigText, WritesTwoDigitsOfTheDeviation) {
  EXPECT_EQ(number_with_sigma(0.131234567, 0.0004), "0.13123");
  EXPECT_EQ(number_with_sigma(1.0e7, 1e5), "1e+07");
  EXPECT_EQ(number_with_sigma(12.0, 0.0), "12.0");
}

TEST(Experiments, SeekKeysThatTheRigsHave) {
  for (const std::string& name : shipped_rigs()) {
    const Rig rig = load_rig(name);
    for (const ExperimentKind& kind : kExperiments) {
      const std::vector<std::string> keys = keys_of(kind, rig);
      for (const std::string& key : keys) {
        ASSERT_NE(best_for(key), nullptr) << key;
        EXPECT_EQ(best_for(key)->name, kind.name) << key;
      }
      EXPECT_NO_THROW(Family(name, {}, keys)) << name << " " << kind.name;
    }
  }
}

TEST(Family, SaysWhichKeysItCannotSeek) {
  EXPECT_EQ(message_of([] { Family("prototype_b", {}, {"disc.viscous_frction_nms_per_rad"}); }),
            "--fit disc.viscous_frction_nms_per_rad: is no number of this rig's machine; did you "
            "mean `disc.viscous_friction_nms_per_rad`?");
  EXPECT_NE(message_of([] { Family("prototype_b", {}, {"gyros.cm_distance_m"}); }).find("is 0"),
            std::string::npos);
  EXPECT_NE(message_of([] { Family("prototype_b", {}, {"controller.kp_nms_per_rad"}); }),
            "no error");
}

class Recording : public ::testing::Test {
 protected:
  std::vector<Stretch> read(const std::string& rig_name) {
    const Rig rig = load_rig(rig_name);
    const model::Machine machine = rig.build_machine();
    return read_runs(folder / "run.lcm", rig, machine, circumstances);
  }
  Folder folder;
  Circumstances circumstances;
};

TEST_F(Recording, HasTheInputsThatActed) {
  record_run(folder / "run.lcm",
             {.rig = "double_brennan",
              .seconds = 0.1,
              .excitation = [](std::int64_t k,
                               int drive) { return static_cast<double>(k) + 100.0 * drive; },
              .law = false});
  const auto stretches = read("double_brennan");
  ASSERT_EQ(stretches.size(), 1u);
  ASSERT_EQ(stretches[0].moments.size(), 51u);
  for (std::int64_t k = 0; k < 50; ++k) {
    const Moment& moment = stretches[0].moments[static_cast<std::size_t>(k)];
    EXPECT_EQ(moment.tick, k);
    EXPECT_TRUE(moment.sensors.has_value());
    EXPECT_EQ(moment.input.drive[0], static_cast<double>(k));
    EXPECT_EQ(moment.input.drive[1], static_cast<double>(k) + 100.0);
  }
}

TEST_F(Recording, KnowsTheDrivesOfASafeStop) {
  record_run(
      folder / "run.lcm",
      {.rig = "double_brennan", .seconds = 0.1, .law = false, .mode = status_t::MODE_SAFE_STOP});
  const auto stretches = read("double_brennan");
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].moments[3].input.mode, model::DriveMode::kBrake);
  EXPECT_EQ(stretches[0].moments[3].input.drive[0], 20.0);
}

TEST_F(Recording, TakesAStretchOfTime) {
  record_run(folder / "run.lcm", {.rig = "double_brennan", .seconds = 0.3});
  circumstances.from_s = 0.1;
  circumstances.to_s = 0.2;
  const auto stretches = read("double_brennan");
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].moments.front().tick, 50);
  EXPECT_EQ(stretches[0].moments.back().tick, 100);
}

TEST_F(Recording, RefusesBadLogs) {
  record_run(folder / "run.lcm", {.rig = "double_brennan", .seconds = 0.02});
  EXPECT_NE(message_of([&] { read("prototype_b"); }).find("is a log of rig double_brennan (id 3)"),
            std::string::npos);
  EXPECT_NE(message_of([&] { read("double_brennan"); }).find("no 20 ticks on end"),
            std::string::npos);
  circumstances.drive = DriveSource::kCurrent;
  EXPECT_NE(message_of([&] { read("double_brennan"); }).find("no motor currents"),
            std::string::npos);
}

TEST_F(Recording, RefusesMoreMassesThanAMachineCarries) {
  record_run(folder / "run.lcm", {.rig = "double_brennan", .seconds = 0.1});
  circumstances.added.assign(model::kMaxAddedMasses, {0.1, {0.0, 0.0, 0.2}});
  EXPECT_EQ(read("double_brennan").front().moments.front().input.added.size,
            model::kMaxAddedMasses);
  circumstances.added.push_back(circumstances.added.front());
  EXPECT_NE(message_of([&] { read("double_brennan"); }).find("run.lcm: at tick 0 of run "),
            std::string::npos);
}

TEST_F(Recording, RefusesALogWithoutSensors) {
  const Rig rig = load_rig("double_brennan");
  {
    support::LogMaker log(folder / "run.lcm", rig, print_rig("double_brennan", {}));
    for (int k = 0; k < 100; ++k) log.add(Channel::kState, state_t{}, k);
  }
  EXPECT_NE(message_of([&] { read("double_brennan"); }).find("has no LIVE/SENSORS"),
            std::string::npos);
}

/// 40 ticks of SENSORS, STATE and COMMAND, a torque of 1 N m; `change` spoils some.
void write_log(const std::filesystem::path& path, const std::string& rig_name,
               const std::function<void(std::int64_t tick, sensors_t&, command_t&)>& change) {
  const Rig rig = load_rig(rig_name);
  support::LogMaker log(path, rig, print_rig(rig_name, {}));
  for (std::int64_t k = 0; k < 40; ++k) {
    sensors_t sensors{};
    sensors.valid |= sensors_t::VALID_GYRO;
    sensors.valid |= sensors_t::VALID_CURRENTS;
    command_t command{};
    command.mode = command_t::TORQUE_NM;
    command.valid_ticks = 5;
    command.value[0] = 1.0;
    command.for_tick = k;
    command.owner_epoch = support::LogMaker::kEpoch;
    command.writer = 1;
    command.counter = k + 1;
    change(k, sensors, command);
    state_t state{};
    state.mode = status_t::MODE_RUNNING;
    log.add(Channel::kSensors, sensors, k);
    log.add(Channel::kState, state, k);
    log.add(Channel::kCommand, command, k);
  }
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST_F(Recording, HoldsTheCommandBeforeOneThatIsNoNumber) {
  write_log(folder / "run.lcm", "double_brennan", [](std::int64_t k, sensors_t&, command_t& c) {
    c.value[0] = k == 20 ? kNaN : static_cast<double>(k);
  });
  const auto stretches = read("double_brennan");
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].moments[19].input.drive[0], 19.0);
  EXPECT_EQ(stretches[0].moments[20].input.drive[0], 19.0);
  EXPECT_EQ(stretches[0].moments[21].input.drive[0], 21.0);
}

TEST_F(Recording, GoesByTheCommandWhereACurrentIsNoNumber) {
  write_log(folder / "run.lcm", "prototype_b", [](std::int64_t k, sensors_t& s, command_t&) {
    s.drive_current_a[0] = k == 20 ? kNaN : 0.5;
  });
  circumstances.drive = DriveSource::kCurrent;
  const auto stretches = read("prototype_b");
  ASSERT_EQ(stretches.size(), 1u);
  const model::Machine machine = load_rig("prototype_b").build_machine();
  const double by_current = input_of(stretches[0].moments[18], machine).drive[0];
  EXPECT_TRUE(stretches[0].moments[18].current.has_value());
  EXPECT_FALSE(stretches[0].moments[19].current.has_value());
  EXPECT_EQ(input_of(stretches[0].moments[19], machine).drive[0], 1.0);
  EXPECT_EQ(input_of(stretches[0].moments[20], machine).drive[0], by_current);
}

TEST_F(Recording, RefusesALeap) {
  const Rig rig = load_rig("double_brennan");  // 500 Hz
  {
    support::LogMaker log(folder / "run.lcm", rig, print_rig("double_brennan", {}));
    for (const std::int64_t tick : {0, 1, 2, 30'002, 60'003}) {
      log.add(Channel::kSensors, sensors_t{}, tick);
    }
  }
  // 60 s are borne, a tick more is not.
  EXPECT_NE(message_of([&] { read("double_brennan"); })
                .find("run.lcm: tick 60003 comes right after tick 30002 of run " +
                      run_name(support::LogMaker::kEpoch) + ":"),
            std::string::npos);
}

TEST(Readings, ThatAreNoNumbersAreMissing) {
  const model::Machine machine = load_rig("prototype_b").build_machine();
  sensors_t sensors{};
  sensors.valid |= sensors_t::VALID_GYRO;
  sensors.valid |= sensors_t::VALID_DISC;
  sensors.gyro_rad_s[1] = kNaN;
  EXPECT_EQ(valid_readings(sensors, machine), (std::vector<int>{0, 2, 6}));
  sensors.disc_angle_rad = std::numeric_limits<double>::infinity();
  EXPECT_EQ(valid_readings(sensors, machine), (std::vector<int>{0, 2}));
}

}  // namespace
}  // namespace gyrotwin::calibration
