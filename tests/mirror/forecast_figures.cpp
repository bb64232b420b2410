// How early falls are forecast, and how often in vain: many seeded runs, a line for each trouble.
//   forecast_figures [FIRST_SEED [SEEDS [FILTER [FADE LASTING CONFIRM PATIENCE]]]]
// With VERBOSE set also a line a run: when each forecast was told, whether its own course falls (F)
// or stands (s), the share that falls, and after @ how long until then, once there is an alarm.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/mirror/falls.hpp"

namespace gyrotwin::support {
namespace {

constexpr double kAhead = 0.3;  // [s]

struct Tally {
  int runs = 0, falls = 0, in_time = 0, possible = 0, possible_in_time = 0, stands = 0, false_ = 0;
  std::vector<double> leads;

  void add(const Fate& run) {
    // What falls before its trouble, for want of rotor speed, is another matter.
    if (run.fell_at >= 0.0 && run.fell_at < run.cause_at) return;
    ++runs;
    if (run.fell_at < 0.0) {
      ++stands;
      false_ += false_alarm(run);
      return;
    }
    ++falls;
    const double ahead = lead(run);
    leads.push_back(ahead);
    const bool good = ahead >= kAhead;
    in_time += good;
    // Who falls sooner after its cause could not be warned in time by anybody.
    if (run.fell_at - run.cause_at >= kAhead + 0.1) {
      ++possible;
      possible_in_time += good;
    }
  }
  void add(const Tally& other) {
    runs += other.runs, falls += other.falls, in_time += other.in_time;
    possible += other.possible, possible_in_time += other.possible_in_time;
    stands += other.stands, false_ += other.false_;
    leads.insert(leads.end(), other.leads.begin(), other.leads.end());
  }
  void print(const char* name, const char* rig) {
    std::ranges::sort(leads);
    const auto quantile = [this](double share) {
      return leads.empty() ? 0.0 : leads[static_cast<std::size_t>(share * (leads.size() - 1))];
    };
    std::printf("| %s | %s | %d | %d | %d | %d | %d | %.2f | %.2f | %d | %d |\n", name, rig, runs,
                falls, in_time, possible, possible_in_time, quantile(0.05), quantile(0.5), stands,
                false_);
    std::fflush(stdout);
  }
};

}  // namespace
}  // namespace gyrotwin::support

int main(int argc, char** argv) {
  using namespace gyrotwin::support;
  const auto number = [&](int i, double otherwise) {
    return argc > i ? std::strtod(argv[i], nullptr) : otherwise;
  };
  const auto first = static_cast<std::uint64_t>(number(1, 1000));
  const auto seeds = static_cast<std::uint64_t>(number(2, 20));
  const char* filter = argc > 3 ? argv[3] : "";
  gyrotwin::ForecastSettings settings;
  settings.fade_s = number(4, settings.fade_s);
  settings.lasting_s = number(5, settings.lasting_s);
  settings.confirm_s = number(6, settings.confirm_s);
  settings.patience = number(7, settings.patience);
  const bool verbose = std::getenv("VERBOSE") != nullptr;

  std::puts(
      "| trouble | rig | runs | falls | 0.3 s ahead | could be | of these ahead | lead 5 % | "
      "median | stand | false alarm |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|");
  Tally all;
  for (const Trouble& trouble : troubles()) {
    const std::string name = std::string(trouble.name) + ' ' + trouble.rig;
    if (name.find(filter) == std::string::npos) continue;
    Tally tally;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
      const Fate fate = run_trouble(trouble, seed, settings);
      tally.add(fate);
      if (!verbose) continue;
      // All that a rule of alarm may look at: told when, whether its own course falls, the share.
      std::printf("%s,%d,%.3f,%.3f,%.3f", name.c_str(), static_cast<int>(seed), fate.fell_at,
                  fate.cause_at, fate.peak_tilt);
      for (const Told& told : fate.told) {
        std::printf(",%.3f%c%.2f@%.2f", told.at, told.forecast.tilt_margin_rad < 0.0 ? 'F' : 's',
                    told.forecast.fall_probability,
                    1e-9 * static_cast<double>(told.forecast.falls_in_ns));
      }
      std::puts("");
    }
    tally.print(trouble.name, trouble.rig);
    all.add(tally);
  }
  all.print("all", "");
}
