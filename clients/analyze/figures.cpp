#include "clients/analyze/figures.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <variant>

#include "clients/analyze/motions.hpp"
#include "clients/common/parallel.hpp"
#include "clients/plot/chart.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kLocusSteps = 60;
constexpr int kMapCells = 28;
constexpr double kPossible = 0.98;  // of the mass that the inertia about the support allows
constexpr double kZoom =
    20.0;  // fast modes this much faster than slow ones get a chart of their own

double between(const KeyRange& range, int i, int steps) {
  return range.low + (range.high - range.low) * i / (steps - 1);
}

/// Eigenvalues of that member; empty where it has none.
Eigen::VectorXcd eigenvalues_of(const RigFamily& family, const std::vector<std::string>& keys) {
  try {
    const std::optional<LinearModel> linear = linear_model(family(keys));
    return linear ? linear->modes.eigenvalues : Eigen::VectorXcd{};
  } catch (const Error&) {
    return {};  // such a rig cannot be
  }
}

/// Points of the locus in quarters of its range, so that its direction shows.
struct Locus {
  std::vector<Curve> curves;
  double slowest = 0.0, fastest = 0.0;  // magnitudes of what moves [1/s]
};

Locus locus_of(const std::vector<Eigen::VectorXcd>& found, const KeyRange& range) {
  Locus locus;
  const std::array<int, 4> colours{0, 2, 4, 1};
  std::vector<double> sizes;
  for (int part = 0; part < 4; ++part) {
    const int begin = part * kLocusSteps / 4;
    const int end = (part + 1) * kLocusSteps / 4;
    Curve curve;
    curve.name = fmt::format("{:.4g} to {:.4g}", between(range, begin, kLocusSteps),
                             between(range, end - 1, kLocusSteps));
    curve.style = Curve::Style::kPoints;
    curve.colour = colours[static_cast<std::size_t>(part)];
    for (int i = begin; i < end; ++i) {
      for (const std::complex<double>& rate : found[static_cast<std::size_t>(i)]) {
        curve.x.push_back(rate.real());
        curve.y.push_back(rate.imag());
        if (std::abs(rate) > 1e-6) sizes.push_back(std::abs(rate));
      }
    }
    locus.curves.push_back(curve);
  }
  if (sizes.empty()) return locus;
  std::ranges::sort(sizes);
  locus.slowest = sizes[sizes.size() / 4];
  locus.fastest = sizes.back();
  return locus;
}

Curve own_eigenvalues(const LinearModel& own) {
  Curve curve{"this rig", {}, {}, Curve::Style::kCrosses, 6};
  for (const std::complex<double>& rate : own.modes.eigenvalues) {
    curve.x.push_back(rate.real());
    curve.y.push_back(rate.imag());
  }
  return curve;
}

void add_locus(const RigFamily& family, const LinearModel& own, const KeyRange& range, int threads,
               std::vector<Figure>& all) {
  std::vector<Eigen::VectorXcd> found(kLocusSteps);
  for_each_index(kLocusSteps, threads, [&](std::size_t i) {
    const double value = between(range, static_cast<int>(i), kLocusSteps);
    found[i] = eigenvalues_of(family, {setting(range.key, value)});
  });
  Locus locus = locus_of(found, range);
  locus.curves.push_back(own_eigenvalues(own));
  Chart chart{"Root locus over " + range.key,
              {"real part: growth [1/s]"},
              {"imaginary part: swing [rad/s]"},
              locus.curves,
              {{Rule::Direction::kVertical, 0.0, "grows to the right"}}};
  all.push_back(
      {svg(chart), "Eigenvalues of the closed loop as it is sampled, for values of " + range.key +
                       " from blue to vermilion. A point right of the dotted line is a deviation "
                       "that grows; its distance to the left is how fast one dies out."});
  if (locus.fastest < kZoom * std::max(locus.slowest, 1e-3)) return;
  const double reach = 4.0 * locus.slowest;
  chart.title += ", slow part";
  chart.x.low = -reach;
  chart.x.high = reach;
  chart.y.low = -reach;
  chart.y.high = reach;
  all.push_back({svg(chart), "The same, close to the origin: the slow motions decide."});
}

/// @param own values of the rig itself, where they are known
void add_map(const RigFamily& family, const Rig& rig, const std::pair<KeyRange, KeyRange>& keys,
             const std::optional<std::pair<double, double>>& own, int threads,
             std::vector<Figure>& all) {
  const KeyRange &across = keys.first, &up = keys.second;
  CellMap map;
  map.title = "Growth rate over two parameters";
  map.x = {across.key};
  map.y = {up.key};
  map.value_label = "growth [1/s]";
  for (int i = 0; i < kMapCells; ++i) {
    map.xs.push_back(between(across, i, kMapCells));
    map.ys.push_back(between(up, i, kMapCells));
  }
  if (own) map.curves = {{"this rig", {own->first}, {own->second}, Curve::Style::kCrosses}};
  map.values.assign(map.xs.size() * map.ys.size(), kNaN);
  for_each_index(map.values.size(), threads, [&](std::size_t cell) {
    const double x = map.xs[cell % map.xs.size()];
    const double y = map.ys[cell / map.xs.size()];
    const Eigen::VectorXcd rates =
        eigenvalues_of(family, {setting(across.key, x), setting(up.key, y)});
    if (rates.size() > 0) map.values[cell] = rates[0].real();
  });
  all.push_back({svg(map), "The fastest growth of a small deviation of " + rig.name +
                               ": blue dies out and stands, vermilion grows and falls; empty: no "
                               "such rig, or none that moves steadily."});
}

const char* parse_number(const char* begin, const char* end, double& value) {
  const auto [after, error] = std::from_chars(begin, end, value);
  return error == std::errc{} && std::isfinite(value) ? after : nullptr;
}

}  // namespace

std::string setting(const std::string& key, double value) {
  return fmt::format("{}={:.17g}", key, value);
}

KeyRange parse_range(const std::string& text) {
  const std::size_t equals = text.find('=');
  KeyRange range{text.substr(0, equals), 0.0, 0.0};
  const char* at =
      text.data() + std::min(text.size(), equals == std::string::npos ? text.size() : equals + 1);
  const char* end = text.data() + text.size();
  at = parse_number(at, end, range.low);
  if (at != nullptr && at != end && *at == ':') at = parse_number(at + 1, end, range.high);
  if (at != end || !(range.low < range.high) || range.key.empty()) {
    throw Error("`" + text +
                "` is no range; expected KEY=LOW:HIGH with LOW below HIGH, such as "
                "gyros.rotor_speed_rad_s=200:1800");
  }
  return range;
}

FigureKeys default_keys(const Rig& rig) {
  using Range = std::optional<KeyRange>;
  const auto around = [](const char* key, double value, double low, double high) -> Range {
    if (value == 0.0) return std::nullopt;  // no range about it
    const auto [least, most] = std::minmax({low * value, high * value});
    return KeyRange{key, least, most};
  };
  const auto keys_with = [](const Range& rotors, const Range& other) {
    FigureKeys keys{rotors, std::nullopt};
    if (rotors && other) keys.map = {*rotors, *other};
    return keys;
  };
  const char* rotor_key = "gyros.rotor_speed_rad_s";
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    const std::optional<double> speed = rig.controller.disc_speed;
    const auto& s = umbrella->structure;
    const double least = std::min(s.inertia_x, s.inertia_y), height2 = s.cm_height * s.cm_height;
    return keys_with(
        around(rotor_key, umbrella->gyros.rotor_speed, 0.1, 1.6),
        speed.value_or(0.0) != 0.0
            ? around("controller.disc_speed_rad_s", *speed, 0.1, 2.6)
            : around("structure.cm_height_m", s.cm_height, 0.5,
                     std::min(1.6, std::sqrt(kPossible * least / (s.mass * height2)))));
  }
  if (const auto* gimballed = std::get_if<model::GimballedParameters>(&rig.machine)) {
    const auto& s = gimballed->structure;
    const double point = s.mass * s.cm_height * s.cm_height;
    return keys_with(around(rotor_key, gimballed->gyros.rotor_speed, 0.05, 1.6),
                     around("structure.mass_kg", s.mass, 0.7,
                            std::min(1.5, kPossible * s.inertia_tilt / point)));
  }
  return {};
}

std::vector<Figure> figures_of(const Rig& rig, const Analysis& analysis, const RigFamily& family,
                               const FigureKeys& keys, int threads) {
  std::vector<Figure> all;
  for (const auto& [chart, caption] : response_charts(rig, analysis, threads)) {
    all.push_back({svg(chart), caption});
  }
  if (const auto portrait = phase_portrait(rig, threads)) {
    all.push_back({svg(portrait->chart), portrait->caption});
  }
  if (const auto potential = amended_potential(rig)) {
    all.push_back({svg(potential->chart), potential->caption});
  }
  if (analysis.as_filed().linear) {
    if (keys.locus) add_locus(family, *analysis.as_filed().linear, *keys.locus, threads, all);
    if (keys.map) add_map(family, rig, *keys.map, keys.own, threads, all);
  }
  return all;
}

}  // namespace gyrotwin
