// gyrotwin-calibrate: the parameters of a rig from its logs.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "clients/calibrate/report.hpp"
#include "clients/common/interrupt.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin::calibration {

namespace {

constexpr std::size_t kMostReadings = 200'000;  // with every tick; more are thinned out

struct Options {
  std::vector<std::string> logs, fit, use, added;
  std::string experiment, drive = "command", output, report;
  bool json = false;
  double segment_s = 0.0, from_s = 0.0, to_s = 1e9;
  int every = 0, threads = 0;
};

void add_what(Command& app, Options& options) {
  app.add_option("logs", options.logs, "Logs of `gyrotwin log record` or `gyrotwin experiment`")
      .required()
      .type("FILE...");
  app.add_option("--experiment", options.experiment,
                 "What was done: says which keys are sought, and what was pinned")
      .check(one_of(names_of(kExperiments)))
      .type("NAME");
  app.add_option("--fit", options.fit,
                 "A key of the rig file to seek, repeatable; default: those of the experiment")
      .repeatable()
      .type("KEY");
  app.add_option("--added-mass", options.added,
                 "Bolted to the structure, repeatable: kg and where, in its frame [m]; what was "
                 "put on with `gyrotwin disturb mass` is in the log")
      .repeatable()
      .type("KG@X,Y,Z");
  app.add_option("--drive", options.drive,
                 "Where the drives' torques are taken from: what was commanded, or the currents")
      .check(one_of({"command", "current"}))
      .shows_default();
  app.add_option("--use", options.use, "Only this sensor counts, repeatable; default: all")
      .repeatable()
      .check(one_of({kSensorNames.begin(), kSensorNames.end()}));
  app.add_option("--from", options.from_s, "Begin at this time of each run [s]")
      .check(number_within(0.0, 1e9).untold())
      .type("S");
  app.add_option("--to", options.to_s, "End at this time of each run [s]")
      .check(number_within(0.0, 1e9).untold())
      .type("S");
}

void add_how(Command& app, Options& options) {
  app.add_option("--segment", options.segment_s,
                 "Length of what is shot through at a time [s]; default 0.2, where axles ride on a "
                 "ring 0.05")
      .check(number_within(1e-3, 1e3).untold())
      .type("S");
  app.add_option("--every", options.every,
                 "Only each so many ticks' readings count; default: as many as make 200000")
      .check(whole_within(1, 100'000))
      .type("N");
  app.add_option("--threads", options.threads, "How many share the work; default: all processors")
      .check(whole_within(1, 256))
      .type("N");
  app.add_flag("--json", options.json, "As one JSON object, every digit");
  app.add_option("--report", options.report,
                 "Also as one HTML page with residuals before and after")
      .type("FILE.html");
  app.add_option("--output", options.output,
                 "A new rig file: a copy in which what was identified stands with its sigma")
      .type("NEW.toml");
}

model::PointMass added_mass(const std::string& text) {
  model::PointMass mass;
  char end = 0;
  const int read = std::sscanf(text.c_str(), "%lf@%lf,%lf,%lf%c", &mass.mass, &mass.position.x(),
                               &mass.position.y(), &mass.position.z(), &end);
  if (read == 4 && mass.mass > 0.0 && std::isfinite(mass.mass) && mass.position.allFinite()) {
    return mass;
  }
  throw Error("--added-mass " + text + ": expected KG@X,Y,Z, e.g. 10@0,0,-0.3");
}

Circumstances circumstances_of(const Options& options) {
  Circumstances c{
      .drive = options.drive == "current" ? DriveSource::kCurrent : DriveSource::kCommand,
      .added = {},
      .from_s = options.from_s,
      .to_s = options.to_s};
  if (options.added.size() > model::kMaxAddedMasses) {
    throw Error(fmt::format("--added-mass: {} at most", model::kMaxAddedMasses));
  }
  std::ranges::transform(options.added, std::back_inserter(c.added), added_mass);
  return c;
}

Cuts cuts_of(const Options& options, const model::Machine& machine,
             const std::vector<Stretch>& stretches) {
  Cuts cuts;
  cuts.length_s = options.segment_s > 0.0 ? options.segment_s : default_length(machine);
  for (const std::string& name : options.use) {
    cuts.use.push_back(
        static_cast<SensorKind>(std::ranges::find(kSensorNames, name) - kSensorNames.begin()));
  }
  std::size_t readings = 0;
  for (const Stretch& stretch : stretches) readings += kReadings * stretch.moments.size();
  cuts.every = options.every > 0 ? options.every : static_cast<int>(readings / kMostReadings) + 1;
  return cuts;
}

/// Says how far it is: on a terminal all the time, elsewhere now and then in a line of its own.
class Progress {
 public:
  bool show(const FitProgress& p) {
    const auto now = std::chrono::steady_clock::now();
    if (terminal_ || now - said_ > kSilence) {
      said_ = now;
      fmt::print(stderr, "{}{}, step {}, chi^2 {:.6g}{}", terminal_ ? "\r\x1b[K" : "",
                 p.parameters_free ? "parameters" : "states", p.iteration, p.chi_square,
                 terminal_ ? "" : "\n");
    }
    return !interrupt_.wanted();
  }
  void end() const {
    if (terminal_) std::fputs("\r\x1b[K", stderr);
  }

 private:
  static constexpr std::chrono::seconds kSilence{10};
  Interrupt interrupt_;
  bool terminal_ = isatty(STDERR_FILENO) == 1;
  std::chrono::steady_clock::time_point said_ = std::chrono::steady_clock::now();
};

void write_new(const std::string& name, const std::string& text) {
  if (std::filesystem::exists(name)) throw Error(name + ": exists already; give a new file");
  std::ofstream file(name, std::ios::binary);
  file << text << std::flush;
  if (!file) throw Error(name + ": cannot be written; give a file in a folder that exists");
}

std::string text_of_file(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

int run(const RigOptions& rig_options, const Options& options) {
  const Rig as_filed = rig_options.load();
  const ExperimentKind* kind =
      options.experiment.empty() ? nullptr : &experiment_of(options.experiment);
  std::vector<std::string> keys = options.fit;
  if (keys.empty() && kind != nullptr) keys = keys_of(*kind, as_filed);
  if (keys.empty()) throw Error("what is sought? Give --experiment, or --fit KEY");

  std::vector<std::string> overrides = rig_options.overrides();
  if (kind != nullptr) {
    std::ranges::copy(arrangement(*kind, as_filed), std::back_inserter(overrides));
  }
  const Family family(rig_options.name(), overrides, keys);
  const Rig rig = load_rig(rig_options.name(), overrides);
  const model::Machine machine = rig.build_machine();
  std::vector<Stretch> stretches;
  std::vector<std::string> files;
  for (const std::string& log : options.logs) {
    files.push_back(std::filesystem::path(log).filename().string());
    std::ranges::move(read_runs(log, rig, machine, circumstances_of(options)),
                      std::back_inserter(stretches));
  }

  Progress progress;
  const int processors = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1u));
  const FitOptions how{.threads = options.threads > 0 ? options.threads : processors,
                       .progress = [&](const FitProgress& p) { return progress.show(p); }};
  const Fit found = fit(family, rig, stretches, cuts_of(options, machine, stretches), how);
  progress.end();
  const Identifiability known = identify(found.information, found.inflation());
  const Calibration calibration{as_filed.name, files, stretches,
                                found,         known, findings(family, found, known)};
  std::fputs((options.json ? json_of(calibration) : text_of(calibration)).c_str(), stdout);
  if (!options.report.empty()) write_new(options.report, page_of(calibration));
  if (!options.output.empty() && std::ranges::any_of(calibration.findings, &Finding::identified)) {
    write_new(options.output, rig_file_of(calibration, text_of_file(as_filed.file)));
  }
  return std::ranges::all_of(calibration.findings, &Finding::identified) ? kDone : kNotDone;
}

std::string footer() {
  std::string text = "Experiments:\n";
  for (const ExperimentKind& kind : kExperiments) {
    text += fmt::format("  {:<11} {}\n", kind.name, kind.does);
  }
  return text +
         "A parameter whose sigma is above 30 % of it is refused, with the reason and the\n"
         "experiment that would tell it; the rig file keeps what it had.\n"
         "Exit code 0: all were identified; 1: some were not, or it failed; 2: asked wrongly.\n"
         "Examples:\n"
         "  gyrotwin calibrate --experiment coast-down coast.lcm --output new.toml\n"
         "  gyrotwin calibrate --experiment swing swing_5kg.lcm swing_10kg.lcm --report "
         "swing.html\n"
         "  gyrotwin calibrate --rig double_brennan run.lcm --fit gyros.rotor_inertia_kgm2 --json";
}

}  // namespace

}  // namespace gyrotwin::calibration

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Finds parameters of a rig, with their covariance, from logs of its runs.",
      "gyrotwin-calibrate");
  app.footer(gyrotwin::calibration::footer());
  const gyrotwin::RigOptions rig_options(app);
  gyrotwin::calibration::Options options;
  gyrotwin::calibration::add_what(app, options);
  gyrotwin::calibration::add_how(app, options);
  return app.run(argc, argv, [&] { return gyrotwin::calibration::run(rig_options, options); });
}
