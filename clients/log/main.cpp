// gyrotwin-log: keeps the record of a rig, shows it, plays it back, repairs it, hands it on.
#include <cmath>
#include <cstdio>
#include <string>

#include "clients/log/cat.hpp"
#include "clients/log/export.hpp"
#include "clients/log/log_info.hpp"
#include "clients/log/plot.hpp"
#include "clients/log/record.hpp"
#include "clients/log/recover.hpp"
#include "clients/log/replay.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr double kLongest = 1e9;  // [s]

/// What the command line says.
struct Options {
  RecordOptions record;
  bool all = false;
  double rotate_mb = 0.0, rotate_s = 0.0;
  std::string file, recovered;
  bool json = false;
  Selection selection;
  double speed = 1.0;
  ExportOptions exported;
  PlotOptions plot;
};

void add_file(Command& sub, Options& options) {
  sub.add_option("file", options.file, "A log").required().type("FILE");
}

void add_record(Command& sub, Options& options) {
  sub.add_option("file", options.record.file, "A new file; default: named by rig and time")
      .type("FILE");
  sub.add_flag("--all", options.all,
               "Also keep foreign short messages on the rig's group, as they are");
  sub.add_option("--rotate-mb", options.rotate_mb,
                 "Begin a new file when one has this size; files are then numbered [MB]")
      .type("X")
      .check(number_within(1e-3, 1e9).untold());
  sub.add_option("--rotate-s", options.rotate_s,
                 "Begin a new file when one has lasted this long [s]")
      .type("S")
      .check(number_within(1e-3, kLongest).untold());
}

void add_keep(Command& sub, RecordOptions& record) {
  sub.add_option(
         "--keep", record.limits.keep,
         "Of the numbered files keep the last N, the one being written included, and remove "
         "this record's older ones; default: all")
      .type("N")
      .check(whole_within(2, 1'000'000).untold());
}

void add_times(Command& sub, double& from_s, double& to_s) {
  sub.add_option("--from", from_s, "Begin so long after the first message [s]")
      .type("S")
      .check(number_within(0.0, kLongest).untold());
  sub.add_option("--to", to_s, "End so long after the first message [s]")
      .type("S")
      .check(number_within(0.0, kLongest).untold());
}

void add_selection(Command& sub, Selection& selection) {
  sub.add_option("--channel", selection.channels,
                 "Only this channel, whole or its end, e.g. LIVE/STATE; repeatable")
      .type("NAME")
      .repeatable();
  add_times(sub, selection.from_s, selection.to_s);
}

void add_export(Command& sub, ExportOptions& options) {
  sub.add_option("file", options.file, "A log").required().type("FILE");
  sub.add_option("out", options.out,
                 "A new file ending .mat or .mcap, or .csv: then one a channel, OUT.CHANNEL.csv")
      .required()
      .type("OUT");
  sub.add_option("--format", options.format, "csv, mat or mcap; default: OUT's ending")
      .type("NAME")
      .check(one_of({"csv", "mat", "mcap"}).untold());
  add_selection(sub, options.selection);
  sub.add_option("--every", options.every, "Of each channel, take every N-th message only")
      .type("N")
      .check(whole_within(1, 1'000'000'000).untold());
  sub.add_flag("--force", options.force, "Replace files that are there");
  sub.add_flag(
      "--uncompressed", [&options] { options.compress = false; },
      "Do not compress what is in a .mat or .mcap");
}

void add_plot(Command& sub, PlotOptions& options) {
  sub.add_option("file", options.file, "A log").required().type("FILE");
  sub.add_option("--field", options.fields,
                 "Draw this one, e.g. LIVE/STATE.tilt_rad[0], without [0] all of its elements; "
                 "repeatable; default: tilt, disc, gimbals and torque of LIVE/STATE")
      .type("NAME")
      .repeatable();
  add_times(sub, options.from_s, options.to_s);
  sub.add_option("--output", options.output, "A new file; default: FILE's name, ending .svg")
      .type("OUT");
  sub.add_flag("--force", options.force, "Replace the file that is there");
}

int run_record(const RigOptions& rig_options, const Options& options) {
  const Rig rig = rig_options.load();
  RecordOptions what = options.record;
  if (what.limits.keep > 0 && options.rotate_mb == 0.0 && options.rotate_s == 0.0) {
    throw Error("--keep is about the files of a record in several: add --rotate-mb or --rotate-s");
  }
  what.keep = options.all ? Tap::Keep::kAll : Tap::Keep::kRig;
  what.limits.bytes = std::llround(1e6 * options.rotate_mb);
  what.limits.time_us = std::llround(1e6 * options.rotate_s);
  return record(rig, print_rig(rig_options.name(), rig_options.overrides()), what);
}

int run_info(const Options& options) {
  Log log(options.file);
  const LogInfo info = survey(log);
  if (info.messages == 0 && !log.catalog().about()) {
    throw NotDone(options.file + ": no log, or nothing of one is left: not one event in " +
                  std::to_string(log.size()) + " bytes");
  }
  const auto text = options.json ? info_json : info_text;
  std::fputs(text(options.file, log, info).c_str(), stdout);
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Keeps the record of a rig in LCM's log format, shows it, plays it back, repairs it, hands "
      "it on.",
      "gyrotwin-log");
  app.footer(
      "Exit code 0: done; 1: not done, or not to the end; 2: asked wrongly.\n"
      "Examples:\n"
      "  gyrotwin log record run.lcm            # until Ctrl-C\n"
      "  gyrotwin log record --rotate-s 60 --keep 1440 run.lcm  # for ever; the last day stays\n"
      "  gyrotwin log info run.lcm\n"
      "  gyrotwin log cat --channel LIVE/STATE --from 2 --to 3 --json run.lcm\n"
      "  gyrotwin log replay run.lcm\n"
      "  gyrotwin log export run.lcm run.mcap   # or run.mat, run.csv\n"
      "  gyrotwin log plot --field LIVE/STATE.tilt_rad --to 10 run.lcm\n"
      "  gyrotwin log recover broken.lcm whole.lcm");
  gyrotwin::Options options;

  gyrotwin::Command record = app.add_subcommand("record", "Record the rig's bus until Ctrl-C");
  gyrotwin::add_record(record, options);
  gyrotwin::add_keep(record, options.record);
  const gyrotwin::RigOptions record_rig(record);

  gyrotwin::Command info = app.add_subcommand("info", "What is in a log");
  gyrotwin::add_file(info, options);
  info.add_flag("--json", options.json, "For programs");

  gyrotwin::Command cat = app.add_subcommand(
      "cat", "Messages of a log, one a line; what is zero is left out, but with --json");
  gyrotwin::add_file(cat, options);
  gyrotwin::add_selection(cat, options.selection);
  cat.add_flag("--json", options.json, "JSON lines with every field and digit");

  gyrotwin::Command replay =
      app.add_subcommand("replay", "Send a log on the rig's bus, as recorded");
  gyrotwin::add_file(replay, options);
  gyrotwin::add_selection(replay, options.selection);
  replay.add_option("--speed", options.speed, "Recorded over wall time")
      .type("X")
      .shows_default()
      .check(gyrotwin::number_within(1e-3, 1e6).untold());
  const gyrotwin::RigOptions replay_rig(replay);

  gyrotwin::Command recover = app.add_subcommand("recover", "Copy what is sound in a damaged log");
  gyrotwin::add_file(recover, options);
  recover.add_option("out", options.recovered, "A new file").required().type("OUT");

  gyrotwin::Command exported =
      app.add_subcommand("export", "Turn a log into CSV, MATLAB's MAT or Foxglove's MCAP");
  gyrotwin::add_export(exported, options.exported);

  gyrotwin::Command plot = app.add_subcommand("plot", "Draw fields of a log over time, as SVG");
  gyrotwin::add_plot(plot, options.plot);

  return app.run(argc, argv, [&] {
    if (record.given()) return gyrotwin::run_record(record_rig, options);
    if (info.given()) return gyrotwin::run_info(options);
    if (cat.given()) return gyrotwin::cat(options.file, options.selection, options.json);
    if (replay.given()) {
      const gyrotwin::Rig rig = replay_rig.load();
      return gyrotwin::replay(rig, options.file, options.selection, options.speed);
    }
    if (recover.given()) return gyrotwin::recover(options.file, options.recovered);
    if (exported.given()) return gyrotwin::export_log(options.exported);
    if (plot.given()) return gyrotwin::plot_log(options.plot);
    throw gyrotwin::UsageError("record, info, cat, replay, recover, export or plot is required");
  });
}
