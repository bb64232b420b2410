// The rig file: every kind of mistake at its place with its fix, overrides, and the shipped rigs.
#include "services/runtime/rig.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>
#include <map>
#include <sstream>

#include "services/runtime/error.hpp"
#include "services/runtime/rig_reader.hpp"

namespace gyrotwin {
namespace {

using Strings = std::vector<std::string>;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

Strings lines_of(const std::string& text) {
  Strings lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// What a rig read from this text and these overrides is blamed for, one mistake an entry.
Strings mistakes_in(const std::string& text, const Strings& overrides = {}) {
  try {
    TomlReader reader(text, "r.toml", overrides);
    read_rig(reader);
    reader.finish();
  } catch (const Error& error) {
    Strings lines = lines_of(error.what());
    EXPECT_EQ(lines.front(), "r.toml cannot be used:");
    lines.erase(lines.begin());
    return lines;
  }
  return {};
}

/// A shipped rig with one text replaced by another.
std::string edited(const std::string& rig, const std::string& from, const std::string& to) {
  std::string text = text_of(rig_folder() / (rig + ".toml"));
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// "r.toml:LINE:" of the first line that begins with `start`, after the header of `table`.
std::string line_of(const std::string& text, const std::string& table, const std::string& start) {
  const Strings lines = lines_of(text);
  bool inside = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] == '[' + table + ']') inside = true;
    if (inside && lines[i].starts_with(start)) return "r.toml:" + std::to_string(i + 1) + ':';
  }
  ADD_FAILURE() << table << ' ' << start;
  return {};
}

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
     "2: error: unknown table [disc]; the tables of this rig are [rig] [network] [loop] [safety] "
     "[gimballed] [structure] [gyros] [drive] [controller] [initial] [disturbance]"},
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
  EXPECT_EQ(mistakes.size(), 10U);  // all but loop, safety, bushing and controller
}

TEST(Override, ReplacesAValueAndTheLastOneWins) {
  const Rig rig = load_rig("prototype_b", {"loop.rate_hz=250", "loop.rate_hz=500"});
  EXPECT_EQ(rig.loop.rate_hz, 500.0);
}

TEST(Override, WordsAndAddressesNeedNoQuotes) {
  const Rig rig =
      load_rig("prototype_b", {"umbrella.mount=rigid", "network.group=239.1.2.3",
                               "network.interface=veth-a", "rig.summary=\"two words\""});
  EXPECT_EQ(std::get<model::UmbrellaParameters>(rig.machine).mount, model::Mount::kRigid);
  EXPECT_EQ(rig.network.group, "239.1.2.3");
  EXPECT_EQ(rig.network.interface, "veth-a");
  EXPECT_EQ(rig.summary, "two words");
}

TEST(Override, GivesAListAndAKeyThatTheFileLacks) {
  const Rig rig = load_rig("double_brennan", {"controller.gain=[72.24, 1.726,-20,0.2062]"});
  EXPECT_EQ(rig.controller.gain, (std::vector<double>{72.24, 1.726, -20.0, 0.2062}));
}

TEST(Override, TakesNumbersAsPapersPrintThem) {
  const Rig rig = load_rig("double_brennan", {"controller.gain=[72.24,1.726,-20,.2062]",
                                              "loop.rate_hz=500.", "network.group=239.255.71.9"});
  EXPECT_EQ(rig.controller.gain, (std::vector<double>{72.24, 1.726, -20.0, 0.2062}));
  EXPECT_EQ(rig.loop.rate_hz, 500.0);
  EXPECT_EQ(rig.network.group, "239.255.71.9");
  EXPECT_EQ(load_rig("double_brennan", {"controller.tilt_max_rad=.5e-1"}).controller.tilt_max,
            0.05);
}

TEST(Override, MistakesAreToldByTheirKey) {
  const std::string text = text_of(rig_folder() / "prototype_b.toml");
  const std::map<std::string, std::string> expected{
      {"controller.gian=[1]",
       "--set controller.gian: error: unknown key `controller.gian`; did you mean "
       "`controller.gain`?"},
      {"controler.gain=[1]",
       "--set controler.gain: error: unknown key `controler.gain`; did you mean "
       "`controller.gain`?"},
      {"gain=[1]", "--set gain: error: unknown key `gain`; did you mean `controller.gain`?"},
      {"controller.gain=[1,",
       "--set controller.gain: error: `[1,` is no TOML value; write a number, true, a word, \"a "
       "text\" or [a, list], and quote it against the shell"},
      {"controller.gain=1",
       "--set controller.gain: error: `controller.gain` is 1, expected a list of numbers"},
      {"controller.gain=[1, inf]",
       "--set controller.gain: error: element 2 of `controller.gain` is inf, expected a number"},
      {"loop.rate_hz", "--set loop.rate_hz: error: no value; write `--set table.key=value`"},
      {"loop.rate_hz=1\nx=2",
       "--set loop.rate_hz: error: `1\nx=2` is no TOML value; write a number, true, a word, \"a "
       "text\" or [a, list], and quote it against the shell"},
      {"disc.mass_kg=nan",
       "--set disc.mass_kg: error: `disc.mass_kg` is nan, expected a number > 0"},
      {"umbrella.mount=universal_joint",
       "--set umbrella.mount: error: `initial.q` has 4 numbers, expected 6: (thx, thy, bx, by, "
       "phi, "
       "tg), as `umbrella.mount` says"},
      {"gyros.stop_upper_rad=-1",
       "--set gyros.stop_upper_rad: error: `gyros.stop_lower_rad` must be below "
       "`gyros.stop_upper_rad`"},
  };
  for (const auto& [override_text, message] : expected) {
    std::string all;
    for (const std::string& mistake : mistakes_in(text, {override_text})) {
      all += (all.empty() ? "" : "\n") + mistake;
    }
    EXPECT_EQ(all.substr(0, message.size()), message) << override_text;
  }
}

TEST(Override, MendsAMistakeOfTheFile) {
  const std::string text = edited("prototype_b", "rate_hz = 1000", "rate_hz = 0");
  EXPECT_EQ(mistakes_in(text).size(), 1U);
  EXPECT_EQ(mistakes_in(text, {"loop.rate_hz=1000"}), Strings{});
}

TEST(Load, NamesTheShippedRigsWhenThereIsNoSuchRig) {
  try {
    load_rig("prototype_c");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "no shipped rig is called `prototype_c`: there are brennan_monorail, "
                 "double_brennan, gooch, gyrocar, prototype_a, prototype_b, prototype_b_sleeping, "
                 "townsend (a file of your own is given by its path, with a / or ending in .toml); "
                 "did you mean `prototype_a`?");
  }
  EXPECT_THROW(load_rig("./prototype_b"), Error);
  EXPECT_THROW(load_rig("no_such.toml"), Error);
  EXPECT_THROW(load_rig(rig_folder() / "." / ""), Error);  // a folder
}

TEST(Load, FolderOfRigsCanBeNamed) {
  const std::filesystem::path folder = testing::TempDir() + "gyrotwin_rig_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "mine.toml") << edited("prototype_b", "\"prototype_b\"", "\"mine\"");
  ::setenv("GYROTWIN_RIGS", folder.c_str(), 1);
  EXPECT_EQ(shipped_rigs(), Strings{"mine"});
  EXPECT_EQ(load_rig("mine").name, "mine");
  ::setenv("GYROTWIN_RIGS", "/no/such/folder", 1);
  EXPECT_THROW(rig_folder(), Error);
  ::unsetenv("GYROTWIN_RIGS");
  std::filesystem::remove_all(folder);
}

TEST(Print, WhatIsPrintedReadsBackTheSame) {
  for (const std::string& name : shipped_rigs()) {
    const std::string printed = print_rig(name, {"loop.overrun=stop"});
    EXPECT_NE(printed.find("\noverrun = \"stop\"\n"), std::string::npos) << name;
    TomlReader reader(printed, "printed", {});
    read_rig(reader);
    ASSERT_NO_THROW(reader.finish()) << name;
    EXPECT_EQ(printed.substr(printed.find('\n') + 1), reader.effective()) << name;
  }
}

TEST(Law, HasTheNameOfTheFile) {
  for (const auto& [name, law] : kLawWords) EXPECT_EQ(name_of(law), name);
}

}  // namespace
}  // namespace gyrotwin
