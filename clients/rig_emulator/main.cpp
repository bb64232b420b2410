// gyrotwin-rig_emulator: a rig for those who have none at hand.
#include <cstdio>
#include <string>

#include "clients/rig_emulator/runner.hpp"
#include "clients/rig_emulator/terminal.hpp"
#include "clients/rig_emulator/trouble.hpp"
#include "services/runtime/cli.hpp"

namespace gyrotwin {

namespace {

constexpr int kPriority = 82;  // above the owner's: a rig waits for nobody

struct Line {
  std::string link, device;
};

void add_options(Command& app, Line& line, EmulatorOptions& options) {
  const Option link =
      app.add_option("--link", line.link,
                     "A symbolic link to the pseudo-terminal, as long as it is there")
          .type("PATH")
          .group("Line");
  app.add_option("--device", line.device,
                 "A tty instead of a pseudo-terminal, e.g. one end of a null modem cable; its rate "
                 "is set before, with stty")
      .type("PATH")
      .group("Line")
      .excludes(link);
  app.add_option("--clock-offset-s", options.clock_offset_s,
                 "How far the device's clock is ahead of this host's at the start")
      .check(number_within(-1e6, 1e6))
      .shows_default()
      .type("S")
      .group("Time");
  app.add_option("--clock-drift-ppm", options.clock_drift_ppm,
                 "How much faster it runs; the rig ticks by it")
      .check(number_within(-1e5, 1e5))
      .shows_default()
      .type("PPM")
      .group("Time");
  app.add_option("--trouble", options.troubles,
                 "What goes wrong, from when, for how long [s]; may be repeated")
      .repeatable()
      .type("KIND[@AT][+DURATION][=SHARE]")
      .group("Trouble");
  app.add_flag("--from-stdin", options.from_stdin,
               "Take troubles from standard input too, one a line; without @AT: now")
      .group("Trouble");
  app.add_option("--truth", options.truth, "What really happens, as CSV")
      .type("FILE")
      .group("Output");
  app.add_option("--truth-period-s", options.truth_period_s,
                 "Time between two of its rows; default: every tick")
      .check(number_within(0.0, 1e3))
      .type("S")
      .group("Output");
}

std::string footer() {
  std::string text = "Troubles, times since the start; without DURATION they stay:\n";
  for (const TroubleWord& word : trouble_words()) {
    text += fmt::format("  {:<9}{}\n", word.name, word.what);
  }
  return text +
         "The rig is propped up at its initial state until the host lets it run, and again "
         "whenever\n"
         "the host says HELD. Pushes reach it through the daemon, by `gyrotwin disturb`. Ctrl-C "
         "ends it.\n"
         "Exit code 0: stopped; 1: the line is gone, or --truth cannot be written; 2: asked "
         "wrongly.\n"
         "Examples:\n"
         "  gyrotwin rig_emulator --link /tmp/rig &\n"
         "  gyrotwin hardware --device /tmp/rig\n"
         "  gyrotwin rig_emulator --set structure.mass_kg=2.9 --truth truth.csv\n"
         "  gyrotwin rig_emulator --trouble silent@5+0.5 --trouble flips@8+2=0.001\n"
         "  echo estop+1 | gyrotwin rig_emulator --from-stdin";
}

int run(const RigOptions& rig_options, const Line& line, const EmulatorOptions& options) {
  const Rig rig = rig_options.load();
  Daemon daemon("gyrotwin-rig_emulator");
  Terminal terminal =
      line.device.empty() ? Terminal::pseudo(line.link) : Terminal::device(line.device);
  Runner runner(rig, options, terminal, daemon);
  // For whoever opens it: the one line on standard output.
  std::printf("%s\n", terminal.path().c_str());
  std::fflush(stdout);
  daemon.become_realtime(kPriority);
  runner.run();
  return terminal.lost() || !runner.sound() ? kNotDone : kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "A rig behind its line: a simulated plant with the firmware of a real one, on a "
      "pseudo-terminal, in real time. The hardware daemon owns it like any other.",
      "gyrotwin-rig_emulator");
  app.footer(gyrotwin::footer());
  const gyrotwin::RigOptions rig_options(app);
  gyrotwin::Line line;
  gyrotwin::EmulatorOptions options;
  gyrotwin::add_options(app, line, options);
  return app.run(argc, argv, [&] { return gyrotwin::run(rig_options, line, options); });
}
