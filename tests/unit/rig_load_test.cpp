// The rig file: overrides, tables that may be left out, how it is found and printed.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <map>

#include "services/runtime/rig.hpp"
#include "tests/support/rig_text.hpp"

namespace gyrotwin {
namespace {

using support::edited;
using support::line_of;
using support::mistakes_in;
using support::Strings;
using support::text_of;

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

TEST(Override, OfALawTellsTheNumbersThatItMisses) {
  const std::string text = text_of(rig_folder() / "prototype_b_sleeping.toml");
  const std::string place = line_of(text, "controller", "[controller]");
  EXPECT_EQ(mistakes_in(text, {"controller.law=tilt_to_speed"}),
            (Strings{place + "1: error: missing key `controller.tilt_speed_gain_per_s`, a number "
                             ">= 0: law tilt_to_speed needs it",
                     place + "1: error: missing key `controller.rate_speed_gain`, a number >= 0: "
                             "law tilt_to_speed needs it",
                     place + "1: error: missing key `controller.speed_limit_rad_s`, a number > 0: "
                             "law tilt_to_speed needs it"}));
  EXPECT_EQ(
      mistakes_in(text, {"controller.law=tilt_to_speed", "controller.rate_speed_gain=4",
                         "controller.tilt_speed_gain_per_s=40", "controller.speed_limit_rad_s=20"}),
      Strings{});
  EXPECT_EQ(mistakes_in(text, {"controller.law=precession_lqr"})
                .front()
                .find("--set controller.law: error: law precession_lqr does not fit"),
            0U);
}

TEST(OptionalTables, AreAbsentOrWhole) {
  const Rig with = load_rig("load_cell_rig");
  ASSERT_TRUE(with.load_cell);
  EXPECT_EQ(with.load_cell->point, Eigen::Vector3d(0.0, 0.0, 0.3));
  EXPECT_NEAR(with.load_cell->direction.y(), 1.0, 1e-15);
  EXPECT_NEAR(with.load_cell->rest, -0.3 * std::sin(0.035), 1e-15);
  EXPECT_FALSE(with.wind);

  const Rig without = load_rig("prototype_b");
  EXPECT_FALSE(without.load_cell);
  ASSERT_TRUE(without.wind);
  EXPECT_EQ(without.wind->area, 0.06);

  std::string text = text_of(rig_folder() / "prototype_b.toml");
  const std::size_t at = text.find("[rotor_drive]");
  text.erase(at, text.find("[wind]") - at);
  TomlReader reader(text, "r.toml", {});
  const Rig bare = read_rig(reader);
  reader.finish();
  EXPECT_FALSE(bare.rotor_drive);
  EXPECT_EQ(bare.initial_rotor_share, 1.0);
}

TEST(OptionalTables, AnOverrideAsksForTheRestOfTheTable) {
  const std::string text = text_of(rig_folder() / "prototype_b.toml");
  EXPECT_EQ(mistakes_in(text, {"load_cell.height_m=0.3"}),
            Strings{"r.toml:1:1: error: missing table [load_cell] with the keys direction_rad "
                    "lean_rad stiffness_n_per_m damping_ns_per_m"});
}

TEST(OptionalTables, StartShareIsThatOfTheInitialState) {
  const Rig rig = load_rig("gyrocar", {"rotor_drive.start_share=0.25"});
  const model::Machine machine = rig.build_machine();
  EXPECT_EQ(rig.initial_state(machine).rotor_speed[0], 0.25 * machine.nominal_rotor_speed[0]);
}

TEST(Override, ATickSpinsForHalfItsTimeAtMost) {
  const std::string text = text_of(rig_folder() / "prototype_b.toml");
  EXPECT_EQ(mistakes_in(text, {"loop.spin_us=300"}), Strings{});
  EXPECT_EQ(mistakes_in(text, {"loop.spin_us=301"}).size(), 1U);
  EXPECT_EQ(mistakes_in(text, {"loop.rate_hz=2000", "loop.spin_us=250"}), Strings{});
  const Strings mistakes = mistakes_in(text, {"loop.rate_hz=2000", "loop.spin_us=251"});
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_NE(mistakes[0].find("set `loop.spin_us` to 250 or less"), std::string::npos)
      << mistakes[0];
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
                 "double_brennan, gooch, gyrocar, load_cell_rig, prototype_a, prototype_b, "
                 "prototype_b_sleeping, simple_gyroscope, townsend (a file of your own is given by "
                 "its path, with a / or ending in .toml); "
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
