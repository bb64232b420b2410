// What all programs share on their command lines: exit codes, messages, the options about the rig.
#include "services/runtime/cli.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <stdexcept>

#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

struct Outcome {
  int code;
  std::string out, err;
};

/// Runs a small program with options, subcommands and the rig's options.
Outcome run(std::vector<std::string> arguments, const std::function<int(const Rig&)>& body) {
  CommandLine app("A program to try options with", "gyrotwin-trial");
  const RigOptions rig(app);
  double speed = 1.0;
  app.add_option("--speed", speed, "Speed").check(number_within(0.01, 100.0));
  std::string drive = "torque";
  app.add_option("--drive", drive, "Kind of drive").check(one_of({"torque", "voltage"}));
  app.add_subcommand("arm", "A verb");
  Command fault = app.add_subcommand("fault", "A verb with verbs of its own");
  fault.add_subcommand("sensor", "A verb's verb");
  bool weak = false;
  fault.add_subcommand("drive", "Another").add_flag("--weak", weak, "");
  double roll = 0.0;
  fault.add_subcommand("step", "One with a duty").add_option("--roll", roll, "").required();
  arguments.insert(arguments.begin(), "gyrotwin-trial");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());

  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code =
      app.run(static_cast<int>(argv.size()), argv.data(), [&] { return body(rig.load()); });
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

Outcome run(const std::vector<std::string>& arguments) {
  return run(arguments, [](const Rig&) -> int { return kDone; });
}

TEST(CommandLine, ReturnsWhatTheBodyReturns) {
  EXPECT_EQ(run({}).code, 0);
  EXPECT_EQ(run({}, [](const Rig&) -> int { return kNotDone; }).code, 1);
}

TEST(CommandLine, HelpAndVersionAreAnswersNotErrors) {
  const Outcome help = run({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("--set KEY=VALUE"), std::string::npos) << help.out;
  EXPECT_EQ(help.err, "");
  const Outcome version = run({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out.find("gyrotwin-trial "), 0U) << version.out;
}

TEST(CommandLine, WrongUsageEndsWith2AndOneMessage) {
  const Outcome unknown = run({"--sped", "3"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.err,
            "gyrotwin-trial: error: not expected: `--sped`, `3`; did you mean `--speed`?\n"
            "`gyrotwin trial --help` shows what can be given\n");
}

TEST(CommandLine, ErrorEndsWith2) {
  const Outcome outcome = run({}, [](const Rig&) -> int { throw Error("no such thing"); });
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "gyrotwin-trial: error: no such thing\n");
}

// The journal knows the program, and marks what is an error.
TEST(CommandLine, ForTheJournalAnErrorHasItsPriority) {
  const Outcome outcome = run({}, [](const Rig&) -> int {
    struct stat journal {};
    fstat(STDERR_FILENO, &journal);
    setenv("JOURNAL_STREAM",
           (std::to_string(journal.st_dev) + ':' + std::to_string(journal.st_ino)).c_str(), 1);
    throw Error("no such thing");
  });
  unsetenv("JOURNAL_STREAM");
  EXPECT_EQ(outcome.err, "<3>no such thing\n");
}

TEST(CommandLine, WhatGoesWrongWhileRunningEndsWith1) {
  const Outcome outcome = run({}, [](const Rig&) -> int { throw std::runtime_error("lost it"); });
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "gyrotwin-trial: error: lost it\n");
}

struct Slip {
  std::vector<std::string> arguments;
  std::string meant;  // empty: nothing is near
};

TEST(CommandLine, SaysWhatAMisspeltWordWasLikelyMeantToBe) {
  const Slip slips[]{{{"amr"}, "arm"},
                     {{"fualt"}, "fault"},
                     {{"fault", "senser"}, "sensor"},
                     {{"fault", "driv"}, "drive"},
                     {{"fault", "amr"}, "arm"},  // a verb of the program, given too late
                     {{"disarmament"}, ""},
                     {{"--sped", "3"}, "--speed"},
                     {{"--sped=3"}, "--speed"},
                     {{"arm", "--rog", "gooch"}, "--rig"},
                     {{"fault", "drive", "--week"}, "--weak"},
                     {{"fault", "drive", "--chek-config"}, "--check-config"},
                     {{"fault", "step", "--rol", "2"}, "--roll"},
                     {{"--colour"}, ""}};
  for (const auto& [arguments, meant] : slips) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments.back();
    const std::string tail = outcome.err.substr(0, outcome.err.find('\n'));
    if (meant.empty()) {
      EXPECT_EQ(tail.find("did you mean"), std::string::npos) << outcome.err;
    } else {
      EXPECT_TRUE(tail.ends_with("; did you mean `" + meant + "`?")) << outcome.err;
    }
  }
}

TEST(OneOf, RefusesOtherWordsAndSaysWhichWasMeant) {
  EXPECT_EQ(run({"--drive", "voltage"}).code, 0);
  const Outcome outcome = run({"--drive", "voltaje"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err.substr(0, outcome.err.find('\n')),
            "gyrotwin-trial: error: --drive: `voltaje` is not one of torque, voltage; did you mean "
            "`voltage`?");
  EXPECT_NE(run({"--help"}).out.find("--drive TEXT:{torque, voltage}"), std::string::npos);
}

TEST(NumberWithin, RefusesWhatIsNoNumberInTheRange) {
  for (const char* text : {"nan", "inf", "-inf", "-1", "0", "101", "fast", "1x", ""}) {
    const Outcome outcome = run({"--speed=" + std::string(text)});
    EXPECT_EQ(outcome.code, 2) << text;
  }
  EXPECT_NE(run({"--speed", "nan"}).err.find("--speed: `nan` is no number from 0.01 to 100"),
            std::string::npos);
  for (const char* text : {"0.01", "100", "1e1", "3"}) {
    EXPECT_EQ(run({"--speed", text}).code, 0) << text;
  }
}

TEST(WholeWithin, RefusesWhatIsNoWholeNumberInTheRange) {
  const Check check = whole_within(-2, 1'000'000'000);
  for (const char* text : {"-3", "1000000001", "1.5", "1e2", "3.0", "010", "-0", "+1", " 1", "1 ",
                           "99999999999999999999", "x", ""}) {
    EXPECT_EQ(check.fault(text),
              '`' + std::string(text) + "` is no whole number from -2 to 1000000000");
  }
  for (const char* text : {"-2", "0", "10", "1000000000"}) EXPECT_EQ(check.fault(text), "") << text;
  EXPECT_EQ(check.allowed, "in -2 to 1000000000");
}

/// A program with each kind of option.
struct Kinds {
  CommandLine line{"Has options of each kind", "gyrotwin-kinds"};
  std::string file, link, device;
  std::vector<std::string> fields, pair, list;
  double number = 0.0;
  bool flag = false, called = false;
  Option linked = line.add_option("--link", link, "");
  Command sub = line.add_subcommand("sub", "A verb");

  Kinds() {
    line.add_option("file", file, "");
    line.add_option("--field", fields, "").repeatable();
    line.add_option("--pair", pair, "").values(2);
    line.add_option("--list", list, "").separated_by(',');
    line.add_option("--device", device, "").excludes(linked);
    line.add_number(
        "--number", [this](double x) { number = x; }, "");
    line.add_flag("--flag", flag, "");
    line.add_flag(
        "--call", [this] { called = true; }, "");
    line.add_subcommand("other", "A verb");
    sub.alias("second");
  }

  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "gyrotwin-kinds");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStderr();
    const int code = line.run(static_cast<int>(argv.size()), argv.data(), [this]() -> int {
      if (file == "none") throw UsageError("a file is required");
      return kDone;
    });
    said = testing::internal::GetCapturedStderr();
    return code;
  }

  std::string said;
};

TEST(Option, TakesWhatItsKindTakes) {
  Kinds kinds;
  ASSERT_EQ(kinds.run({"--field", "a", "name", "--field", "b", "--pair", "1", "2", "--list", "x,y",
                       "--number", "2.5", "--flag", "--call", "--link", "here"}),
            kDone)
      << kinds.said;
  EXPECT_EQ(kinds.fields, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(kinds.file, "name");
  EXPECT_EQ(kinds.pair, (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(kinds.list, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(kinds.number, 2.5);
  EXPECT_TRUE(kinds.flag);
  EXPECT_TRUE(kinds.called);
  EXPECT_TRUE(kinds.linked.given());
  EXPECT_EQ(kinds.line.given_subcommand(), "");

  EXPECT_EQ(Kinds().run({"--pair", "1"}), kUsage);
  EXPECT_EQ(Kinds().run({"--link", "a", "--device", "b"}), kUsage);
  EXPECT_EQ(Kinds().run({"--number", "x"}), kUsage);
  EXPECT_EQ(Kinds().run({"--link", ""}), kUsage);
  EXPECT_EQ(Kinds().run({""}), kUsage);
}

TEST(Command, HasOneSubcommandAtMost) {
  Kinds kinds;
  ASSERT_EQ(kinds.run({"second"}), kDone) << kinds.said;
  EXPECT_TRUE(kinds.sub.given());
  EXPECT_FALSE(kinds.linked.given());
  EXPECT_EQ(kinds.line.given_subcommand(), "sub");
  Kinds both;
  EXPECT_EQ(both.run({"sub", "other"}), kUsage);
  EXPECT_EQ(both.said,
            "gyrotwin-kinds: error: not expected: `other`; one command at a time\n"
            "`gyrotwin kinds sub --help` shows what can be given\n");
}

TEST(Command, HasItsOwnOptionsOnly) {
  Kinds kinds;
  EXPECT_EQ(kinds.run({"sub", "--flag"}), kUsage);
  EXPECT_NE(kinds.said.find("not expected: `--flag`; it comes before the command\n"),
            std::string::npos)
      << kinds.said;
  EXPECT_EQ(run({"fault", "step", "step"}).err.find("gyrotwin-trial: error: --roll is required\n"),
            0u);
}

TEST(CommandLine, UsageErrorEndsWith2AndTellsWhereHelpIs) {
  Kinds kinds;
  EXPECT_EQ(kinds.run({"none"}), kUsage);
  EXPECT_EQ(kinds.said,
            "gyrotwin-kinds: error: a file is required\n"
            "`gyrotwin kinds --help` shows what can be given\n");
}

TEST(RigOptions, DefaultIsPrototypeB) {
  std::string name;
  run({}, [&](const Rig& rig) {
    name = rig.name;
    return 0;
  });
  EXPECT_EQ(name, "prototype_b");
}

TEST(RigOptions, EnvironmentNamesTheRigUnlessTheCommandLineDoes) {
  std::string name;
  const auto remember = [&](const Rig& rig) {
    name = rig.name;
    return 0;
  };
  ::setenv("GYROTWIN_RIG", "gooch", 1);
  run({}, remember);
  EXPECT_EQ(name, "gooch");
  run({"--rig", "townsend"}, remember);
  EXPECT_EQ(name, "townsend");
  ::unsetenv("GYROTWIN_RIG");
}

TEST(RigOptions, OverridesRepeatAndKeepListsWhole) {
  Rig seen;
  const Outcome outcome = run({"--set", "controller.gain=[1, 2,3]", "--set=loop.rate_hz=500", "arm",
                               "--set", "umbrella.mount=rigid"},
                              [&](const Rig& rig) {
                                seen = rig;
                                return 0;
                              });
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(seen.controller.gain, (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(seen.loop.rate_hz, 500.0);
  EXPECT_EQ(std::get<model::UmbrellaParameters>(seen.machine).mount, model::Mount::kRigid);
}

TEST(RigOptions, CheckAnswersWithoutRunning) {
  const auto never = [](const Rig&) -> int {
    ADD_FAILURE();
    return 0;
  };
  const Outcome good = run({"--check-config"}, never);
  EXPECT_EQ(good.code, 0);
  EXPECT_TRUE(good.out.ends_with("/prototype_b.toml: ok\n")) << good.out;

  const Outcome bad =
      run({"--check-config", "--set", "loop.rate_hz=-1", "--set", "disc.mass=1"}, never);
  EXPECT_EQ(bad.code, 2);
  EXPECT_EQ(bad.out, "");
  EXPECT_EQ(bad.err.substr(bad.err.find(", as --set")),
            ", as --set changes it, cannot be used:\n"
            "--set disc.mass: error: unknown key `disc.mass`; did you mean `disc.mass_kg`?\n"
            "--set loop.rate_hz: error: `loop.rate_hz` is -1, expected a number from 1 to 10000\n");

  const Outcome printed = run({"--print-config", "--set", "loop.rate_hz=500"}, never);
  EXPECT_EQ(printed.code, 0);
  EXPECT_NE(printed.out.find("\nrate_hz = 500.0\n"), std::string::npos) << printed.out;
}

TEST(Manual, HasEveryOptionSubcommandAndDefault) {
  const std::string page = run({"--print-manual"}).out;
  for (const char* part :
       {".TH GYROTWIN\\-TRIAL 1 ", "gyrotwin\\-trial \\- a program to try options with\n",
        "\\fBgyrotwin trial\\fR [\\fIOPTION\\fR]... \\fICOMMAND\\fR ...", ".SS Rig\n",
        "\\fB\\-\\-rig\\fR \\fINAME|FILE\\fR\n",
        "default: \\fB$GYROTWIN_RIG\\fR, else \\fBprototype_b\\fR.\n",
        "\\fB\\-\\-speed\\fR \\fIFLOAT\\fR in 0.01 to 100\nSpeed.\n",
        ".SS \"\\fBarm\\fR\"\nA verb.\n", ".SS \"\\fBfault sensor\\fR\"\n", "\\fB\\-\\-weak\\fR\n",
        ".BR gyrotwin (1)\n"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part << "\nin\n" << page;
  }
}

TEST(Manual, WhatTroffWouldTakeForItsOwnIsEscaped) {
  CommandLine app("Knows `C:\\n` and 5\" - don't.", "gyrotwin-trial");
  app.footer("Notes.\n.so /etc/passwd\nExamples:\n  gyrotwin trial --x");
  const std::string page = app.manual();
  EXPECT_NE(page.find("Knows \\(gaC:\\en\\(ga and 5\\(dq \\- don\\(aqt."), std::string::npos)
      << page;
  EXPECT_NE(page.find("\n\\&.so /etc/passwd\n"), std::string::npos) << page;
  EXPECT_NE(page.find(".SH EXAMPLES\n.nf\n  gyrotwin trial \\-\\-x\n.fi\n"), std::string::npos)
      << page;
}

TEST(Words, OfEachContextOnALine) {
  const std::string words = run({"--print-words"}).out;
  const std::string rig = "--rig=NAME|FILE --set=KEY=VALUE --check-config --print-config";
  EXPECT_EQ(words.find("gyrotwin-trial\tarm fault --help --version " + rig + " --speed=FLOAT "), 0U)
      << words;
  // What falls through from a subcommand stands there too.
  EXPECT_NE(words.find("\ngyrotwin-trial fault drive\t--weak --help --version " + rig),
            std::string::npos)
      << words;
}

}  // namespace
}  // namespace gyrotwin
