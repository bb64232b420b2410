#include "clients/analyze/motions.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "clients/analyze/loads.hpp"
#include "clients/analyze/recording.hpp"
#include "clients/common/parallel.hpp"
#include "clients/common/tilt.hpp"

namespace gyrotwin {

namespace {

constexpr double kLeastGimbalSpan = 1.0;  // of a chart [deg]
constexpr int kStarts = 12;               // of a ring of the portrait
constexpr double kPortraitTime = 4.0;     // [s], for what becomes of them
constexpr double kShown = 6.0;            // drawn of a path, in e-foldings of an unsupported tilt

/// Long enough to see the slow motion come to rest.
double response_time(const Analysis& analysis) {
  const auto& linear = analysis.as_filed().linear;
  if (!linear || linear->modes.growth >= -kNoGrowth) return 6.0;
  return std::clamp(-5.0 / linear->modes.growth, 4.0, 20.0);
}

/// t, roll and pitch [deg], disc speed [rad/s], first two gimbals [deg], first two torques [N m].
Columns response(const Rig& rig, double push_at, double duration) {
  const model::Machine machine = rig.build_machine();
  const Look look = [&](const Sample& sample) -> std::vector<double> {
    const model::Observation seen = machine.observe(sample.state);
    const model::Truth truth = machine.truth(sample.state, sample.input);
    const std::size_t other = machine.layout.gimbals.size() > 2 ? 2 : 1;
    return {sample.t,
            degrees(seen.tilt[0]),
            degrees(seen.tilt[1]),
            seen.disc_rate,
            degrees(seen.gimbal_angle[0]),
            degrees(seen.gimbal_angle[other]),
            truth.drive_torque[0],
            truth.drive_torque[1]};
  };
  return record(rig, machine, push_scenario(rig, machine, push_at, duration), look);
}

Curve curve(std::string name, const Columns& columns, std::size_t y,
            Curve::Style style = Curve::Style::kLine, std::optional<int> colour = {}) {
  if (columns.empty()) return {std::move(name), {}, {}, style, colour};
  return {std::move(name), columns[0], columns[y], style, colour};
}

Chart over_time(const std::string& title, double duration, const std::string& quantity) {
  Chart chart;
  chart.title = title;
  chart.x = {"time [s]", 0.0, duration};
  chart.y.label = quantity;
  return chart;
}

/// Gives a chart whose curves hardly move a span in which that shows.
void widen(Chart& chart, double least_span) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Curve& drawn : chart.curves) {
    for (const double y : drawn.y) {
      low = std::min(low, y);
      high = std::max(high, y);
    }
  }
  if (!(high - low < least_span)) return;
  chart.y.low = 0.5 * (low + high - least_span);
  chart.y.high = 0.5 * (low + high + least_span);
}

/// Under the law, and (empty: the same) with the drives left alone.
struct Responses {
  Columns with_law, alone;
  double duration;  // [s]
  model::Layout layout;

  bool second_axis() const { return layout.disc == model::kFixed && layout.tilts() > 1; }
};

CaptionedChart tilt_chart(const Responses& seen, const std::string& what) {
  Chart tilt = over_time("Tilt after the reference push", seen.duration, "tilt [deg]");
  tilt.curves.push_back(curve("roll", seen.with_law, 1));
  if (seen.layout.tilts() > 1) tilt.curves.push_back(curve("pitch", seen.with_law, 2));
  const bool driven = !seen.alone.empty();
  if (driven) {
    tilt.curves.push_back(
        curve("roll, drives left alone", seen.alone, 1, Curve::Style::kDashed, 6));
  }
  // What falls would flatten what stands.
  const double most = std::ranges::max(seen.with_law[1], {}, [](double x) { return std::abs(x); });
  const double reach = std::max(2.0, 1.6 * std::abs(most));
  tilt.y.low = -reach;
  tilt.y.high = reach;
  return {tilt, "Full model from the initial state, with " + what +
                    (driven ? "; dashed, the same with the drives left alone." : ".")};
}

CaptionedChart disc_chart(const Responses& seen) {
  Chart disc = over_time("Disc speed", seen.duration, "disc speed [rad/s]");
  disc.curves.push_back(curve("disc", seen.with_law, 3));
  return {disc, "The tilt rate throws the disc about; the drive only steers its mean."};
}

CaptionedChart gimbal_chart(const Responses& seen) {
  Chart gimbals = over_time("Gimbal angles", seen.duration, "gimbal [deg]");
  gimbals.curves.push_back(curve("first", seen.with_law, 4));
  if (seen.second_axis()) gimbals.curves.push_back(curve("second pair", seen.with_law, 5));
  widen(gimbals, kLeastGimbalSpan);
  return {gimbals, "How far the gyros turn; their stops are the end of what they can take."};
}

CaptionedChart torque_chart(const Responses& seen) {
  Chart torque = over_time("Drive torque", seen.duration, "torque [N m]");
  torque.curves.push_back(curve("first drive", seen.with_law, 6));
  if (seen.second_axis()) torque.curves.push_back(curve("second drive", seen.with_law, 7));
  return {torque, "What the law gets of its drives, within their limits."};
}

/// Of an unsupported tilt, e-fold; of one that hangs, its swing [1/s].
double toppling_rate(const Rig& rig) {
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    const auto r = model::reduce(*umbrella);
    return std::sqrt(std::abs(r.U) / r.A);
  }
  const auto r = model::reduce(std::get<model::GimballedParameters>(rig.machine));
  return std::sqrt(std::abs(r.U) / r.A);
}

/// One start of the portrait: where it goes, and whether it stands.
struct Path {
  std::vector<double> tilt, rate;  // [deg], [deg/s]
  bool falls = false;
};

Path path_from(const Rig& rig, const model::Machine& machine, double tilt, double rate) {
  Scenario scenario = live_scenario(rig, machine, kPortraitTime);
  const auto set = [&](int coordinate, double q, double v) {
    if (coordinate == model::kFixed) return;
    scenario.start.q[coordinate] = q;
    scenario.start.v[coordinate] = v;
  };
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const bool roll = axis == 0;
    set(machine.layout.tilt[axis], roll ? tilt : 0.0, roll ? rate : 0.0);
    set(machine.layout.disc_tilt[axis], roll ? tilt : 0.0, roll ? rate : 0.0);
  }
  const int roll = machine.layout.tilt[0];
  const auto look = [&](const Sample& sample) -> std::vector<double> {
    return {sample.t, degrees(sample.state.q[roll]), degrees(sample.state.v[roll]),
            machine.tilt(sample.state)};
  };
  const Columns seen = record(rig, machine, scenario, look, true);
  const double most = *std::ranges::max_element(seen[3]);
  Path path{{}, {}, most > rig.safety.fall_tilt_rad};
  const double shown = kShown / toppling_rate(rig);
  for (std::size_t i = 0; i < seen[0].size() && seen[0][i] <= shown; ++i) {
    path.tilt.push_back(seen[1][i]);
    path.rate.push_back(seen[2][i]);
  }
  return path;
}

/// V_eff [J] over the tilt, zero upright.
struct Potential {
  std::string name;
  std::function<double(double)> value;
};

/// How far to either side it is worth looking: some way beyond the outermost valley.
double reach_of(const std::vector<Potential>& potentials, double fall) {
  constexpr int kLooks = 4000;
  constexpr double kBeyond = 4.0;
  double outermost = 0.0;
  for (std::size_t k = 1; k < potentials.size(); ++k) {  // the first is the weight's, without any
    double lowest = 0.0, place = 0.0;
    for (int i = 1; i < kLooks; ++i) {
      const double tilt = fall * i / kLooks;
      const double value = potentials[k].value(tilt);
      if (value < lowest) {
        lowest = value;
        place = tilt;
      }
    }
    if (place < 0.98 * fall) outermost = std::max(outermost, place);
  }
  return outermost > 0.0 ? std::min(kBeyond * outermost, fall) : fall;
}

std::vector<Potential> potentials_of(const Rig& rig) {
  std::vector<Potential> all;
  if (const auto* p = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    const auto r = model::reduce(*p);
    const double tg0 = p->gyros.ring_elevation;
    // Towards where it presses the axles down.
    const double working = std::copysign(r.C * rig.controller.disc_speed.value_or(1.0), -r.Nh);
    const auto with = [=](double momentum) {
      return [=](double tilt) {
        const double turned = r.Nh * (std::sin(tg0 + r.k * std::abs(tilt)) - std::sin(tg0));
        const double left = momentum - turned;
        return (left * left - momentum * momentum) / (2.0 * r.C) + r.U * (std::cos(tilt) - 1.0);
      };
    };
    all.push_back({"weight alone", [=](double tilt) { return r.U * (std::cos(tilt) - 1.0); }});
    all.push_back({"disc at rest upright, p = 0", with(0.0)});
    all.push_back(
        {fmt::format("disc pressing the axles down, p = {:.2g}", working), with(working)});
    all.push_back({fmt::format("disc lifting them, p = {:.2g}", -working), with(-working)});
    return all;
  }
  const auto r = model::reduce(std::get<model::GimballedParameters>(rig.machine));
  all.push_back({"weight alone", [=](double tilt) { return r.U * (std::cos(tilt) - 1.0); }});
  all.push_back({"gimbals free, p = 0", [=](double tilt) {
                   return r.H * r.H * tilt * tilt / (2.0 * r.J) + r.U * (std::cos(tilt) - 1.0);
                 }});
  return all;
}

}  // namespace

std::vector<CaptionedChart> response_charts(const Rig& rig, const Analysis& analysis, int threads) {
  const double push_at = analysis.as_filed().push_at;
  const double duration = push_at + response_time(analysis);
  const bool driven = rig.controller.law != LawKind::kNone;
  Responses seen{{}, {}, duration, rig.build_machine().layout};
  for_each_index(driven ? 2 : 1, threads, [&](std::size_t i) {
    (i == 0 ? seen.with_law : seen.alone) =
        response(i == 0 ? rig : left_alone(rig), push_at, duration);
  });
  const std::string what = rig.reference_impulse_nms > 0.0
                               ? fmt::format("a push of {:g} N m s in roll at {:.3g} s",
                                             rig.reference_impulse_nms, push_at)
                               : std::string("its initial state");
  std::vector<CaptionedChart> charts;
  if (seen.layout.tilts() > 0) charts.push_back(tilt_chart(seen, what));
  if (seen.layout.disc != model::kFixed) charts.push_back(disc_chart(seen));
  charts.push_back(gimbal_chart(seen));
  if (driven) charts.push_back(torque_chart(seen));
  return charts;
}

std::optional<CaptionedChart> phase_portrait(const Rig& rig, int threads) {
  const model::Machine machine = rig.build_machine();
  if (machine.layout.tilt[0] == model::kFixed) return std::nullopt;
  if (std::holds_alternative<model::GyroscopeParameters>(rig.machine)) return std::nullopt;
  const double fall = rig.safety.fall_tilt_rad;
  const double rate = toppling_rate(rig);
  std::vector<std::pair<double, double>> starts;
  for (const double share : {0.25, 0.6}) {
    for (int i = 0; i < kStarts; ++i) {
      const double angle = 2.0 * std::acos(-1.0) * i / kStarts;
      starts.emplace_back(share * fall * std::cos(angle), share * fall * rate * std::sin(angle));
    }
  }
  std::vector<Path> paths(starts.size());
  for_each_index(starts.size(), threads, [&](std::size_t i) {
    paths[i] = path_from(rig, machine, starts[i].first, starts[i].second);
  });

  const double reach = degrees(1.15 * fall);
  double fastest = reach * rate;
  for (const Path& path : paths) {
    if (path.falls) continue;  // in the end it is as fast as it likes
    for (const double v : path.rate) fastest = std::max(fastest, 1.05 * std::abs(v));
  }
  Chart chart{"Phase portrait in roll",
              {"tilt [deg]", -reach, reach},
              {"tilt rate [deg/s]", -fastest, fastest},
              {},
              {{Rule::Direction::kVertical, degrees(fall), "fallen"},
               {Rule::Direction::kVertical, -degrees(fall), "fallen"}}};
  bool told_stands = false, told_falls = false;
  for (const Path& path : paths) {
    bool& told = path.falls ? told_falls : told_stands;
    chart.curves.push_back({told         ? ""
                            : path.falls ? "falls"
                                         : "stands",
                            path.tilt, path.rate,
                            path.falls ? Curve::Style::kDashed : Curve::Style::kLine,
                            path.falls ? 1 : 0});
    told = true;
  }
  Curve starts_at{"starts", {}, {}, Curve::Style::kPoints, 6};
  for (const auto& [tilt, tilt_rate] : starts) {
    starts_at.x.push_back(degrees(tilt));
    starts_at.y.push_back(degrees(tilt_rate));
  }
  chart.curves.push_back(starts_at);
  return CaptionedChart{chart,
                        fmt::format("Full model under its law from starts on two rings: which "
                                    "still stand after {:g} s, and how they begin.",
                                    kPortraitTime)};
}

std::optional<CaptionedChart> amended_potential(const Rig& rig) {
  if (std::holds_alternative<model::GyroscopeParameters>(rig.machine)) return std::nullopt;
  constexpr int kPlaces = 400;
  const std::vector<Potential> potentials = potentials_of(rig);
  const double reach = reach_of(potentials, rig.safety.fall_tilt_rad);
  Chart chart{
      "Amended potential", {"tilt [deg]", -degrees(reach), degrees(reach)}, {"potential [J]"}, {}};
  double depth = 0.0;
  for (const Potential& potential : potentials) {
    Curve curve{potential.name,
                {},
                {},
                chart.curves.empty() ? Curve::Style::kDashed : Curve::Style::kLine,
                chart.curves.empty() ? 6 : static_cast<int>(chart.curves.size()) - 1};
    for (int i = 0; i <= kPlaces; ++i) {
      const double tilt = reach * (2.0 * i / kPlaces - 1.0);
      curve.x.push_back(degrees(tilt));
      curve.y.push_back(potential.value(tilt));
      depth = std::max(depth, -curve.y.back());
    }
    chart.curves.push_back(curve);
  }
  chart.y.low = -1.5 * depth;
  chart.y.high = 3.0 * depth;
  const bool umbrella = std::holds_alternative<model::UmbrellaParameters>(rig.machine);
  return CaptionedChart{
      chart,
      umbrella
          ? "What tilt moves in when nothing drives the disc, nothing rubs, and the disc is held "
            "level: p = C Omega + N h (sin tg - sin tg0) stays what it is [N m s]. A valley at 0 "
            "stands; with "
            "p > 0 there are two, and it parks tilted."
          : "What tilt moves in when the gimbals are left alone, without friction and for small "
            "turns: p = J q' + H theta stays what it is. A valley stands as long as nothing rubs; "
            "friction or a load lets the gimbals run to their stops."};
}

}  // namespace gyrotwin
