// gyrotwin-sweep: many runs of a rig with other numbers, and which of them stand.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "clients/common/file_text.hpp"
#include "clients/common/interrupt.hpp"
#include "clients/common/mount.hpp"
#include "clients/common/time_text.hpp"
#include "clients/common/variation.hpp"
#include "clients/simulate/stepper_word.hpp"
#include "clients/sweep/conduct.hpp"
#include "clients/sweep/experiment.hpp"
#include "clients/sweep/summary.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig_reader.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kDrawnRuns = 200;  // when nobody says how many

struct Options {
  std::vector<std::string> vary;
  std::string scenario, output;
  std::string stepper = word_of(Bench{}.stepper);
  Variation variation;
  std::int64_t runs = 0;
  std::uint64_t seed = 0;
  double duration = 20.0;
  int workers = 0;
};

void add_what(Command& app, Options& options) {
  app.add_option("--vary", options.vary,
                 "A key and its values, again for every key: a rig key (table.key), start.NAME or "
                 "start.NAME_dot for the initial state, eventN.KEY for the scenario's N-th event")
      .repeatable()
      .required()
      .type("KEY=VALUES");
  app.add_option("--runs", options.runs,
                 "How many runs for every combination of listed values; default 1, or 200 where "
                 "something is drawn")
      .check(whole_within(1, 1'000'000'000))
      .type("N");
  app.add_option("--seed", options.seed, "Of what is drawn: the same seed, the same sweep")
      .check(whole_within(0, 999'999))
      .shows_default()
      .type("N");
  app.add_option("--duration", options.duration, "How long each run lasts, at most to its fall [s]")
      .check(number_within(1e-3, 1e6))
      .shows_default()
      .type("S");
  app.add_option("--scenario", options.scenario,
                 "Disturbances and faults at their times: a scenario file, or the name of a "
                 "shipped one")
      .type("NAME|FILE");
}

void add_how(Command& app, Options& options) {
  add_variation(app, options.variation);
  app.add_option("--stepper", options.stepper, kStepperHelp)
      .check(one_of(stepper_words()))
      .shows_default();
  app.add_option("--workers", options.workers,
                 "How many processes do the runs; default: one a processor. Under mpirun its -n "
                 "says it, less one that gives out the work")
      .check(whole_within(1, 1024))
      .type("N");
  app.add_option("--output", options.output,
                 "Folder for runs.csv, summary.html and sweep.json; default sweep-RIG. One that "
                 "holds the same sweep, unfinished, is gone on with")
      .type("FOLDER");
}

Plan plan_of(const Options& options) {
  Plan plan;
  for (const std::string& text : options.vary) plan.variables.push_back(parse_variable(text));
  const bool drawn = std::ranges::any_of(plan.variables, &Variable::drawn);
  plan.repetitions = options.runs > 0 ? options.runs : drawn ? kDrawnRuns : 1;
  plan.seed = options.seed;
  return plan;
}

/// All that the lines of the sweep hang on.
nlohmann::json definition_of(const Bench& bench, const Plan& plan) {
  nlohmann::json vary = nlohmann::json::array();
  for (const Variable& variable : plan.variables)
    vary.push_back(variable.key + '=' + variable.spec);
  return {{"rig", print_rig(bench.rig, bench.overrides)},
          {"scenario", bench.scenario.document},
          {"vary", vary},
          {"runs", plan.repetitions},
          {"seed", plan.seed},
          {"duration_s", bench.duration},
          {"stepper", word_of(bench.stepper)},
          {"version", GYROTWIN_VERSION}};
}

/// How far it is, on one line of the terminal; elsewhere a line now and then.
class Progress {
 public:
  Progress(std::int64_t done, std::int64_t runs)
      : terminal_(isatty(STDERR_FILENO) == 1), before_(done), runs_(runs), start_(Clock::now()) {}
  ~Progress() {
    if (shown_ && terminal_) std::fputc('\n', stderr);
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::int64_t done) {
    const auto now = Clock::now();
    if (now < next_ || done == before_) return;
    next_ = now + pause();
    const double spent = std::chrono::duration<double>(now - start_).count();
    const double rate = static_cast<double>(done - before_) / std::max(spent, 1e-3);
    std::fprintf(stderr, "%s%lld of %lld runs, %.1f a second, %s left%s", terminal_ ? "\r" : "",
                 static_cast<long long>(done), static_cast<long long>(runs_), rate,
                 time_text(std::ceil(static_cast<double>(runs_ - done) / rate)).c_str(),
                 terminal_ ? "   " : "\n");
    shown_ = true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  Clock::duration pause() const {
    return terminal_ ? std::chrono::milliseconds(500) : std::chrono::seconds(10);
  }

  bool terminal_;
  std::int64_t before_, runs_;
  Clock::time_point start_, next_;
  bool shown_ = false;
};

std::string caution_for(const Rig& rig) {
  if (!held_level(rig)) return "";
  return fmt::format(
      "{}. `gyrotwin analyze` says with what moment, and what becomes of the rig without; `--mount "
      "universal_joint` sweeps it without.",
      kHeldLevel);
}

/// @return how many stand, in words
std::string write_summary(const std::filesystem::path& folder, const Experiment& experiment,
                          const Rig& rig, const Options& options) {
  const Results results = read_results(file_text(folder / "runs.csv"), experiment.plan().variables);
  const SummaryText text{
      .title = fmt::format("{}: which ones stand", rig.name),
      .about = fmt::format(
          "{} over {:g} s{}, seed {}", fmt::join(options.vary, "  "), options.duration,
          options.scenario.empty() ? "" : ", with scenario " + options.scenario, options.seed),
      .caution = caution_for(rig),
      .fall_tilt = rig.safety.fall_tilt_rad,
      .repeat =
          [&](std::size_t run) {
            return experiment.repeat_command(static_cast<std::int64_t>(run));
          },
      .refusal =
          [&](std::size_t run) { return experiment.refusal(static_cast<std::int64_t>(run)); }};
  const std::filesystem::path page = folder / "summary.html";
  std::ofstream stream(page, std::ios::binary);
  stream << summary_html(results, text) << std::flush;
  if (!stream) throw Error(page.string() + ": cannot be written");
  return standing_sentence(results, text);
}

int run(RigOptions& rig_options, const Options& options) {
  apply(options.variation, rig_options);
  const Rig rig = rig_options.load();
  Bench bench{rig_options.name(),
              rig_options.overrides(),
              {},
              options.duration,
              stepper_of(options.stepper)};
  if (!options.scenario.empty()) {
    bench.scenario = open_scenario(options.scenario);
    bench.scenario.source = options.scenario;  // the same wherever it is installed
  }
  const Experiment experiment(bench, plan_of(options));
  const std::int64_t runs = experiment.plan().runs();
  const Work work = [&](std::int64_t number) { return experiment.line(number); };

  const Interrupt interrupt;  // before the crew, which inherits it
  std::unique_ptr<Crew> crew;
  if (under_mpi()) {
    crew = mpi_crew(work);
    if (crew == nullptr) return kDone;  // a worker, whose work is done
  }
  Journal journal(options.output.empty() ? "sweep-" + rig.name : options.output,
                  definition_of(bench, experiment.plan()), experiment.header());
  const int processors = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1u));
  if (!crew) crew = process_crew(options.workers > 0 ? options.workers : processors, work);

  bool complete = false;
  {
    Progress progress(journal.written(), runs);
    complete = conduct(*crew, journal, runs, [&](std::int64_t done) {
      progress.show(done);
      return !interrupt.wanted();
    });
  }
  if (!complete) {
    std::fprintf(stderr, "%lld of %lld runs are done; the same command goes on with the rest\n",
                 static_cast<long long>(journal.written()), static_cast<long long>(runs));
    return kNotDone;
  }
  const std::string sentence = write_summary(journal.folder(), experiment, rig, options);
  std::printf("%s\n%s\n", sentence.c_str(), (journal.folder() / "summary.html").c_str());
  return kDone;
}

std::string footer() {
  return "VALUES: A,B,C (numbers or words); LOW:HIGH:N and log(LOW:HIGH:N), N of them; drawn anew\n"
         "for every run: normal(MEAN,SIGMA), uniform(LOW,HIGH), seed() for a `seed` key. A * "
         "before\n"
         "them multiplies what the rig has: '*normal(1,0.05)'. All combinations of lists are run,\n"
         "each --runs times.\n"
         "The same question gives the same bytes, whoever does the runs. After Ctrl-C or a kill "
         "the\n"
         "same command goes on. Ctrl-C waits for the runs under way; a kill loses them, and those\n"
         "that have ended but wait for one before them.\n"
         "Exit code 0: all runs are done; 1: not all; 2: asked wrongly.\n"
         "Examples:\n"
         "  gyrotwin sweep --vary start.thx=-0.4:0.4:41 --vary start.thx_dot=-3:3:41 --output map\n"
         "  gyrotwin sweep --vary 'structure.mass_kg=*normal(1,0.05)' \\\n"
         "                 --vary 'gyros.rotor_speed_rad_s=*uniform(0.8,1.1)' --runs 1000 \\\n"
         "                 --output built\n"
         "  gyrotwin sweep --scenario gust --vary event1.roll_nm=100:500:5 \\\n"
         "                 --vary 'event1.seed=seed()' --runs 100 --output gust\n"
         "  mpirun -n 9 gyrotwin sweep --vary controller.disc_speed_rad_s=1:9:33 --output speeds\n"
         "mpirun takes no more than its hosts' slots, unless told --oversubscribe.";
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Runs a rig again and again with other numbers, other starts, other disturbances, and says "
      "which of them stand.",
      "gyrotwin-sweep");
  app.footer(gyrotwin::footer());
  gyrotwin::RigOptions rig_options(app);
  gyrotwin::Options options;
  gyrotwin::add_what(app, options);
  gyrotwin::add_how(app, options);
  return app.run(argc, argv, [&] { return gyrotwin::run(rig_options, options); });
}
