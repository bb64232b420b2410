// gyrotwin-analyze: does a rig stand, by how much, and why.
#include <toml++/toml.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "clients/analyze/analysis.hpp"
#include "clients/analyze/figures.hpp"
#include "clients/analyze/report.hpp"
#include "clients/analyze/words.hpp"
#include "clients/common/variation.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

namespace {

struct Options {
  Variation variation;
  double duration = 60.0;
  int threads = 0;
  bool json = false;
  std::string report, locus;
  std::vector<std::string> map;
};

void add_options(Command& app, Options& options) {
  add_variation(app, options.variation);
  app.add_option("--duration", options.duration,
                 "How long undisturbed runs last [s]; pushes and limits a third of it")
      .check(number_within(1.0, 1e5))
      .shows_default()
      .type("S");
  app.add_option("--threads", options.threads, "How many share the work; default: all processors")
      .check(whole_within(1, 256))
      .type("N");
  app.add_flag("--json", options.json, "As one JSON object, every digit");
  app.add_option("--report", options.report, "Also as one HTML page with pictures")
      .type("FILE.html");
  app.add_option("--locus", options.locus,
                 "Rig key of the report's root locus; default: rotor speed")
      .type("KEY=LOW:HIGH");
  app.add_option("--map", options.map, "Two rig keys of the report's stability map")
      .values(2)
      .type("KEY=LOW:HIGH");
}

/// What the rig file has under the map's keys, where both are numbers.
std::optional<std::pair<double, double>> own_values(const std::string& rig_text,
                                                    const std::pair<KeyRange, KeyRange>& map) {
  const toml::table rig = toml::parse(rig_text);
  const auto x = rig.at_path(map.first.key).value<double>();
  const auto y = rig.at_path(map.second.key).value<double>();
  if (!x || !y) return std::nullopt;
  return std::pair{*x, *y};
}

FigureKeys keys_for(const Rig& rig, const std::string& rig_text, const Options& options) {
  FigureKeys keys = default_keys(rig);
  if (!options.locus.empty()) keys.locus = parse_range(options.locus);
  if (!options.map.empty()) keys.map = {parse_range(options.map[0]), parse_range(options.map[1])};
  if (keys.map) keys.own = own_values(rig_text, *keys.map);
  return keys;
}

/// @throws Error where no rig can be at either end or between, as with a misspelt key
void check(const KeyRange& range, const RigFamily& family) {
  std::string first;
  for (const double value : {range.low, 0.5 * (range.low + range.high), range.high}) {
    try {
      family({setting(range.key, value)});
      return;
    } catch (const Error& error) {
      if (first.empty()) first = error.what();
    }
  }
  throw Error(first);
}

/// What was asked for is refused before the work begins.
void check(const Options& options, const FigureKeys& keys, const RigFamily& family) {
  if (options.report.empty()) {
    if (options.locus.empty() && options.map.empty()) return;
    throw Error("--locus and --map are pictures of the page: give --report FILE.html too");
  }
  if (!options.locus.empty()) check(*keys.locus, family);
  if (options.map.empty()) return;
  check(keys.map->first, family);
  check(keys.map->second, family);
}

void write_file(const std::string& name, const std::string& text) {
  std::ofstream file(name, std::ios::binary);
  file << text << std::flush;
  if (!file) throw Error(name + ": cannot be written; give a file in a folder that exists");
}

int run(RigOptions& rig_options, const Options& options) {
  apply(options.variation, rig_options);
  const Rig rig = rig_options.load();
  const RigFamily family = [&](const std::vector<std::string>& more) {
    std::vector<std::string> overrides = rig_options.overrides();
    overrides.insert(overrides.end(), more.begin(), more.end());
    return load_rig(rig_options.name(), overrides);
  };
  const FigureKeys keys =
      keys_for(rig, print_rig(rig_options.name(), rig_options.overrides()), options);
  check(options, keys, family);
  const int processors = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1u));
  const int threads = options.threads > 0 ? options.threads : processors;
  std::fprintf(stderr, "%g s of each closed loop are computed ...\n", options.duration);
  const Analysis analysis = analyse(rig, options.duration, threads);
  if (!options.report.empty()) {
    std::fputs("the page's curves are computed ...\n", stderr);
    write_file(options.report,
               report_html(rig, analysis, figures_of(rig, analysis, family, keys, threads)));
  }
  const std::string text =
      options.json ? json_of(rig, analysis).dump(1) + "\n" : text_of(rig, analysis);
  std::fputs(text.c_str(), stdout);
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app("Says whether a rig stands, by how much, and why.", "gyrotwin-analyze");
  gyrotwin::RigOptions rig_options(app);
  gyrotwin::Options options;
  gyrotwin::add_options(app, options);
  return app.run(argc, argv, [&] { return gyrotwin::run(rig_options, options); });
}
