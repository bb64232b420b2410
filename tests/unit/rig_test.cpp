// The rig file: every kind of mistake at its place with its fix.
#include <gtest/gtest.h>

#include <map>

#include "tests/support/rig_text.hpp"

namespace gyrotwin {
namespace {

using support::edited;
using support::line_of;
using support::mistakes_in;
using support::Strings;

struct Mistake {
  std::string name;
  std::string rig, from, to;
  std::string table, start;  // where it is told: the line that starts so
  std::string rest;          // column and message
};

void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.to; }

class OneMistake : public testing::TestWithParam<Mistake> {};

TEST_P(OneMistake, IsToldAtItsPlaceWithItsFix) {
  const Mistake& m = GetParam();
  const std::string text = edited(m.rig, m.from, m.to);
  EXPECT_EQ(mistakes_in(text), Strings{line_of(text, m.table, m.start) + m.rest});
}

const Mistake kMistakes[] = {
    {"UnknownKey", "prototype_b", "cm_height_m", "cm_heigth_m", "structure", "cm_heigth_m",
     "1: error: unknown key `structure.cm_heigth_m`; did you mean `structure.cm_height_m`?"},
    {"KeyWithoutItsUnit", "prototype_b", "mass_kg = 2.5", "mass = 2.5", "structure", "mass",
     "1: error: unknown key `structure.mass`; did you mean `structure.mass_kg`?"},
    {"KeyOfAnotherTable", "prototype_b", "track =", "port = 1\ntrack =", "umbrella", "port",
     "1: error: unknown key `umbrella.port`; did you mean `network.port`?"},
    {"KeyLikeNoOther", "prototype_b", "track =", "colour = 1\ntrack =", "umbrella", "colour",
     "1: error: unknown key `umbrella.colour`"},
    {"UnknownTable", "prototype_b", "[disc]", "[disk]", "disk", "[disk]",
     "2: error: unknown table [disk]; did you mean `disc`?"},
    {"TableOfTheOtherMachine", "double_brennan", "[drive]", "[disc]\n[drive]", "disc", "[disc]",
     "2: error: unknown table [disc]; the tables of this rig are [rig] [network] [loop] "
     "[gimballed] "
     "[structure] [gyros] [drive] [safety] [controller] [rotor_drive] [load_cell] [wind] [sensors] "
     "[estimator] [mirror] [hardware] [initial] [disturbance]"},
    {"MissingKey", "prototype_b", "mass_kg = 1.6", "", "disc", "[disc]",
     "1: error: missing key `disc.mass_kg`, a number > 0"},
    {"TextForANumber", "prototype_b", "mass_kg = 1.6", "mass_kg = \"heavy\"", "disc", "mass_kg",
     "11: error: `disc.mass_kg` is the text \"heavy\", expected a number > 0"},
    {"NumberForAText", "prototype_b", "prefix = \"PROTOTYPE_B\"", "prefix = 7", "network", "prefix",
     "10: error: `network.prefix` is 7, expected a text of A-Z 0-9 _, at most 31 characters"},
    {"PrefixInSmallLetters", "prototype_b", "\"PROTOTYPE_B\"", "\"proto\"", "network", "prefix",
     "10: error: `network.prefix` is the text \"proto\", expected a text of A-Z 0-9 _, at most 31 "
     "characters"},
    {"GroupThatIsNoMulticast", "prototype_b", "239.255.71.1", "192.168.1.1", "network", "group",
     "9: error: `network.group` is the text \"192.168.1.1\", expected an IPv4 multicast address, "
     "224.0.0.0 to 239.255.255.255"},
    {"FractionForAnInteger", "prototype_b", "substeps = 4", "substeps = 2.5", "loop", "substeps",
     "12: error: `loop.substeps` is 2.5, expected an integer from 1 to 1000"},
    {"NumberForAFlag", "prototype_b", "sign = true", "sign = 1", "network", "sign",
     "8: error: `network.sign` is 1, expected true or false"},
    {"NotANumber", "prototype_b", "mass_kg = 1.6", "mass_kg = nan", "disc", "mass_kg",
     "11: error: `disc.mass_kg` is nan, expected a number > 0"},
    {"Infinite", "prototype_b", "cm_offset_m = -0.02", "cm_offset_m = -inf", "disc", "cm_offset_m",
     "15: error: `disc.cm_offset_m` is -inf, expected a number"},
    {"Negative", "prototype_b", "supply_voltage_v = 24.0", "supply_voltage_v = -24", "drive",
     "supply_voltage_v", "20: error: `drive.supply_voltage_v` is -24, expected a number > 0"},
    {"Zero", "prototype_b", "resistance_ohm = 0.35", "resistance_ohm = 0", "drive",
     "resistance_ohm", "18: error: `drive.resistance_ohm` is 0, expected a number > 0"},
    {"OutOfRange", "prototype_b", "command_timeout_ticks = 10", "command_timeout_ticks = 11",
     "safety", "command_timeout_ticks",
     "25: error: `safety.command_timeout_ticks` is 11, expected an integer from 1 to 10"},
    {"AbovePortRange", "prototype_b", "port = 7671", "port = 99999999999", "network", "port",
     "8: error: `network.port` is 99999999999, expected an integer from 1 to 65535"},
    {"UnknownWord", "prototype_b", "mount = \"level\"", "mount = \"ridgid\"", "umbrella", "mount",
     "9: error: `umbrella.mount` is the text \"ridgid\", expected one of \"level\", "
     "\"universal_joint\", \"rigid\"; did you mean `rigid`?"},
    {"WordLikeNoOther", "prototype_b", "clock = \"realtime\"", "clock = \"sundial\"", "loop",
     "clock",
     "9: error: `loop.clock` is the text \"sundial\", expected one of \"realtime\", \"lockstep\", "
     "\"free\""},
    {"TooFewCoordinates", "prototype_b", "v = [0.0, 0.0, -5.0, 0.0]", "v = [0, 0, -5]", "initial",
     "v =",
     "5: error: `initial.v` has 3 numbers, expected 4: (thx, thy, phi, tg), as "
     "`umbrella.mount` says"},
    {"NoCoordinates", "double_brennan", "v = [0.0, 0.0, 0.0, 0.0]", "v = []", "initial", "v =",
     "5: error: `initial.v` has 0 numbers, expected 4: (thx, thy, qA, qB), as "
     "`gimballed.arrangement` says"},
    {"OneCoordinateNotANumber", "prototype_b", "v = [0.0, 0.0, -5.0, 0.0]", "v = [0, nan, -5, 0]",
     "initial", "v =", "9: error: element 2 of `initial.v` is nan, expected a number"},
    {"NumberForAList", "prototype_b", "v = [0.0, 0.0, -5.0, 0.0]", "v = 0", "initial",
     "v =", "5: error: `initial.v` is 0, expected a list of numbers"},
    {"StopsExchanged", "prototype_b", "stop_lower_rad = -0.6", "stop_lower_rad = 0.7", "gyros",
     "stop_lower_rad", "18: error: `gyros.stop_lower_rad` must be below `gyros.stop_upper_rad`"},
    {"UnsignedOnTheNetwork", "prototype_b", "ttl = 0\nsign = true", "ttl = 1\nsign = false",
     "network", "sign",
     "8: error: an unsigned rig must stay on this host: set `network.sign = true` or "
     "`network.ttl = 0`"},
    {"InertiaBelowThatOfItsMass", "prototype_b", "inertia_y_kgm2 = 0.131", "inertia_y_kgm2 = 0.05",
     "structure", "inertia_y_kgm2",
     "18: error: `structure.inertia_y_kgm2` is about the ground pivot: expected at least mass_kg * "
     "cm_height_m^2 = 0.081, found 0.05"},
    {"FlywheelHeavierThanItsUnit", "prototype_b", "rotor_inertia_kgm2 = 0.0021",
     "rotor_inertia_kgm2 = 0.003", "gyros", "rotor_inertia_kgm2",
     "22: error: the flywheel's `gyros.rotor_inertia_kgm2` is part of `gyros.inertia_axial_kgm2` "
     "and cannot be larger"},
    {"NoInertiaLeftForTheChassis", "double_brennan", "inertia_tilt_kgm2 = 0.3504",
     "inertia_tilt_kgm2 = 0.25", "structure", "inertia_tilt_kgm2",
     "21: error: `structure.inertia_tilt_kgm2` is about the support: it must exceed mass_kg * "
     "cm_height_m^2 = 0.2904, or nothing is left for the chassis without its gyros"},
    {"NoMassLeftForTheChassis", "double_brennan", "mass_kg = 1.04", "mass_kg = 1.5", "structure",
     "mass_kg",
     "11: error: `structure.mass_kg` counts everything and must exceed the 4 gyro units' 6 kg"},
    {"NumberThatTheLawMisses", "prototype_b", "momentum_rate_per_s = 5.0", "", "controller",
     "[controller]",
     "1: error: missing key `controller.momentum_rate_per_s`, a number > 0: law momentum_manager "
     "needs it"},
    {"WeightThatTheLawMisses", "gyrocar", "gimbal_max_rad = 0.1", "", "controller", "[controller]",
     "1: error: missing key `controller.gimbal_max_rad`, a number > 0: law precession_lqr needs it "
     "or `controller.gain`"},
    {"NumberOfTheLawMisspelt", "prototype_b", "momentum_rate_per_s", "momentum_rate_per_sec",
     "controller", "momentum_rate",
     "1: error: unknown key `controller.momentum_rate_per_sec`; did you mean "
     "`controller.momentum_rate_per_s`?"},
    {"LawOfAnotherMachine", "prototype_b", "law = \"momentum_manager\"", "law = \"shelf\"",
     "controller", "law",
     "7: error: law shelf does not fit an umbrella platform; laws that fit: none, open_loop, "
     "constant_speed, tilt_to_speed, momentum_manager, reduced_lqr"},
    {"UnknownWave", "prototype_b", "wave = \"relay\"", "wave = \"square\"", "controller", "wave",
     "8: error: `controller.wave` is the text \"square\", expected one of \"sine\", \"relay\""},
    {"RotorDriveWithoutAKey", "gyrocar", "time_constant_s = 2.0", "", "rotor_drive",
     "[rotor_drive]", "1: error: missing key `rotor_drive.time_constant_s`, a number > 0"},
    {"RotorMotorTooWeak", "gyrocar", "power_limit_w = 8000.0", "power_limit_w = 2000.0",
     "rotor_drive", "power_limit_w",
     "17: error: `rotor_drive.power_limit_w` must be at least 2523.28 W, what the drag takes at "
     "the nominal rotor speed"},
    {"RotorMotorTooSmall", "gyrocar", "torque_limit_nm = 30.0", "torque_limit_nm = 3",
     "rotor_drive", "torque_limit_nm",
     "19: error: `rotor_drive.torque_limit_nm` must be at least 4.01593 N m, what the drag takes "
     "at "
     "the nominal rotor speed"},
    {"StartsFasterThanItRuns", "gyrocar", "start_share = 1.0", "start_share = 1.5", "rotor_drive",
     "start_share", "15: error: `rotor_drive.start_share` is 1.5, expected a number from 0 to 1"},
    {"LeansTooFarFromTheCell", "load_cell_rig", "lean_rad = -0.035", "lean_rad = -1", "load_cell",
     "lean_rad", "12: error: `load_cell.lean_rad` is -1, expected a number from -0.7 to 0.7"},
    {"WindWithoutArea", "townsend", "area_m2 = 1.6", "area_m2 = 0", "wind", "area_m2",
     "11: error: `wind.area_m2` is 0, expected a number > 0"},
    {"WindOnAGyroscope", "simple_gyroscope", "[rotor_drive]", "[wind]\n[rotor_drive]", "wind",
     "[wind]",
     "2: error: unknown table [wind]; the tables of this rig are [rig] [network] [loop] "
     "[gyroscope] [drive] [safety] [controller] [rotor_drive] [sensors] [estimator] [mirror] "
     "[hardware] [initial] "
     "[disturbance]"},
    {"FlywheelHeavierThanItsAxle", "simple_gyroscope", "rotor_inertia_kgm2 = 0.0137",
     "rotor_inertia_kgm2 = 0.2", "gyroscope", "rotor_inertia_kgm2",
     "22: error: the flywheel's `gyroscope.rotor_inertia_kgm2` is part of "
     "`gyroscope.inertia_axial_kgm2` and cannot be larger"},
    {"ThreeCoordinatesOfAGyroscope", "simple_gyroscope", "v = [0.358, 0.0]", "v = [0, 0, 0]",
     "initial",
     "v =", "5: error: `initial.v` has 3 numbers, expected 2: (psi, tg), as `rig.machine` says"},
    {"HoldsSpeedWithoutGain", "prototype_b", "\"zero_torque\"", "\"hold_speed\"", "safety",
     "safe_stop", "13: error: this safe stop needs `safety.safe_stop_gain_nms_per_rad` > 0"},
};

INSTANTIATE_TEST_SUITE_P(Rig, OneMistake, testing::ValuesIn(kMistakes),
                         [](const auto& mistake) { return mistake.param.name; });

TEST(Rig, SyntaxErrorIsToldAtItsPlace) {
  const std::string text = edited("prototype_b", "mass_kg = 2.5 ", "mass_kg = ? ");
  const Strings mistakes = mistakes_in(text);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(mistakes[0].find(line_of(text, "structure", "mass_kg") + "11: error: not TOML: "), 0U)
      << mistakes[0];
}

TEST(Rig, KeyGivenTwiceIsASyntaxError) {
  const Strings mistakes = mistakes_in("[rig]\nid = 1\nid = 2\n");
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(mistakes[0].find("r.toml:3:6: error: not TOML: "), 0U) << mistakes[0];
}

TEST(Rig, ValueInPlaceOfATable) {
  EXPECT_EQ(mistakes_in("loop = 3\n" + edited("prototype_b", "[loop]", "[lop]"))[0],
            "r.toml:1:8: error: `loop` is to be a table: [loop], then its keys");
}

TEST(Rig, MissingTableIsToldOnceWithItsKeys) {
  const std::string text = edited("double_brennan", "[drive]\ntorque_limit_nm = 3.0", "");
  EXPECT_EQ(mistakes_in(text),
            Strings{"r.toml:1:1: error: missing table [drive] with the keys torque_limit_nm"});
}

TEST(Rig, MisspeltTableIsNotAlsoMissing) {
  EXPECT_EQ(mistakes_in(edited("prototype_b", "[contact]", "[contacts]")).size(), 1U);
}

TEST(Rig, AllMistakesAtOnceInTheOrderOfTheFile) {
  std::string text = edited("prototype_b", "port = 7671", "port = 0");
  for (const auto& [from, to] : std::map<std::string, std::string>{
           {"substeps", "substep"}, {"track = \"lower\"", "track = \"upper\""}, {"-5.0", "inf"}}) {
    text.replace(text.find(from), from.size(), to);
  }
  const Strings mistakes = mistakes_in(text, {"loop.rate_hz=0"});
  ASSERT_EQ(mistakes.size(), 5U);
  EXPECT_NE(mistakes[0].find("`network.port` is 0"), std::string::npos) << mistakes[0];
  EXPECT_NE(mistakes[1].find("unknown key `loop.substep`"), std::string::npos) << mistakes[1];
  EXPECT_NE(mistakes[2].find("`umbrella.track`"), std::string::npos) << mistakes[2];
  EXPECT_NE(mistakes[3].find("element 3 of `initial.v`"), std::string::npos) << mistakes[3];
  EXPECT_EQ(mistakes[4],
            "--set loop.rate_hz: error: `loop.rate_hz` is 0, expected a number from 1 to 10000");
}

TEST(Rig, EmptyFileMissesEveryTableThatIsNeeded) {
  const Strings mistakes = mistakes_in("");
  // All but loop, safety, bushing, controller, estimator and the tables that may be left out.
  EXPECT_EQ(mistakes.size(), 10U);
}

}  // namespace
}  // namespace gyrotwin
