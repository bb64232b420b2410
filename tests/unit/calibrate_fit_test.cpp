// Calibration: logs of simulated rigs in, their parameters out, and what cannot be told refused.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "clients/calibrate/findings.hpp"
#include "clients/calibrate/fit.hpp"
#include "tests/support/recorded_run.hpp"

namespace gyrotwin::calibration {
namespace {

using support::Folder;
using support::record_run;
using support::RunToRecord;

/// What is sought, and how far off the search begins.
struct Search {
  std::vector<std::string> keys;
  double off = 0.03;      ///< of the first key, of the others by turns the other way
  double length_s = 0.0;  ///< of a segment; 0: the default
  int every = 1;
  std::vector<SensorKind> use = {};                   ///< sensors that count; none: all
  std::vector<std::string> assumed = {};              ///< overrides besides those of the run
  std::vector<model::PointMass> counterweights = {};  ///< of the runs, one each
};

struct Outcome {
  Fit fit;
  Identifiability known;
  Eigen::VectorXd error;  ///< found over true, minus 1
  std::vector<Finding> findings;

  /// error' covariance^-1 error: chi^2 distributed with as many degrees of freedom as parameters.
  double distance() const { return (fit.information * error).squaredNorm(); }
};

Outcome calibrate(const std::vector<RunToRecord>& runs, const Search& search) {
  const RunToRecord& first = runs.front();
  std::vector<std::string> overrides = first.overrides;
  overrides.insert(overrides.end(), search.assumed.begin(), search.assumed.end());
  const Family truth(first.rig, overrides, search.keys);
  double off = search.off;
  for (const Parameter& p : truth.parameters()) {
    overrides.push_back(p.key + "=" + std::to_string(p.start * (1.0 + off)));
    off = -off;
  }
  const Family family(first.rig, overrides, search.keys);
  const Rig rig = load_rig(first.rig, overrides);
  const model::Machine machine = rig.build_machine();

  const Folder folder;
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::filesystem::path log = folder / ("run" + std::to_string(i) + ".lcm");
    record_run(log, runs[i]);
    Circumstances circumstances;
    if (i < search.counterweights.size()) circumstances.added = {search.counterweights[i]};
    for (Stretch& s : read_runs(log, rig, machine, circumstances)) stretches.push_back(s);
  }
  Cuts cuts;
  cuts.length_s = search.length_s > 0.0 ? search.length_s : default_length(machine);
  cuts.every = search.every;
  cuts.use = search.use;
  Outcome outcome{fit(family, rig, stretches, cuts, {.threads = 2}), {}, {}, {}};
  outcome.known = identify(outcome.fit.information, outcome.fit.inflation());
  outcome.findings = findings(family, outcome.fit, outcome.known);
  outcome.error.resize(static_cast<Eigen::Index>(search.keys.size()));
  for (std::size_t i = 0; i < search.keys.size(); ++i) {
    const double found = family.parameters()[i].value(outcome.fit.x[i]);
    outcome.error[static_cast<Eigen::Index>(i)] = found / truth.parameters()[i].start - 1.0;
    std::printf("%s: error %.2g, sigma %.2g, alone %.2g\n", search.keys[i].c_str(),
                outcome.error[static_cast<Eigen::Index>(i)], outcome.known.of[i].sigma,
                outcome.known.of[i].alone);
  }
  std::printf("chi^2 %.4g of %.4g, %d steps; rms", outcome.fit.after.chi_square,
              outcome.fit.freedom, outcome.fit.iterations);
  for (const int reading : outcome.fit.after.readings()) {
    std::printf(" %d: %.2f", reading, outcome.fit.after.rms(reading));
  }
  std::printf("\n");
  return outcome;
}

void expect_within_three_sigma(const Outcome& found) {
  for (const Finding& finding : found.findings)
    EXPECT_TRUE(finding.identified()) << finding.refusal;
  for (std::size_t i = 0; i < found.known.of.size(); ++i) {
    EXPECT_LT(std::abs(found.error[static_cast<Eigen::Index>(i)]), 3.0 * found.known.of[i].sigma)
        << found.findings[i].key;
  }
}

std::function<double(std::int64_t, int)> sines(double amplitude, double rate_hz, double frequency) {
  return [=](std::int64_t tick, int drive) {
    return amplitude * std::sin(2.0 * std::numbers::pi * (frequency + drive) *
                                static_cast<double>(tick) / rate_hz);
  };
}

std::string seed(int i) { return "sensors.seed=" + std::to_string(i); }

// One reading of each sensor that is no number costs that reading, and nothing else: neither the
// fit nor its first guesses hang on it.
TEST(CalibrateFit, ReadingsThatAreNoNumbersCostThemselvesAlone) {
  const auto run = [](std::function<void(std::int64_t, sensors_t&)> spoil) {
    return calibrate({{.rig = "double_brennan",
                       .seconds = 0.2,
                       .excitation = sines(0.5, 500.0, 3.0),
                       .spoil = std::move(spoil)}},
                     {.keys = {"gyros.rotor_inertia_kgm2"}, .length_s = 0.1});
  };
  constexpr std::int64_t kSegment = 50;  // begins a segment, whose start is guessed from it
  const Outcome whole = run({});
  const Outcome spoilt = run([](std::int64_t k, sensors_t& sensors) {
    if (k != kSegment) return;
    sensors.gyro_rad_s[0] = std::numeric_limits<double>::quiet_NaN();
    sensors.acceleration_m_s2[1] = std::numeric_limits<double>::infinity();
    sensors.gimbal_angle_rad[0] = std::numeric_limits<double>::quiet_NaN();
    sensors.rotor_speed_rad_s[0] = -std::numeric_limits<double>::infinity();
  });
  EXPECT_EQ(spoilt.fit.after.points.size(), whole.fit.after.points.size() - 3);
  EXPECT_NEAR(spoilt.fit.x[0], whole.fit.x[0], 0.5 * whole.known.of[0].sigma);
  expect_within_three_sigma(spoilt);
}

// Over several seeds the errors are as large as their covariance says, and chi^2 of the residuals
// is that of the noise.
TEST(CalibrateFit, DoubleBrennansErrorsAreAsLargeAsSaid) {
  double distance = 0.0;
  for (int i = 1; i <= 3; ++i) {
    const Outcome found =
        calibrate({{.rig = "double_brennan",
                    .overrides = {seed(i)},
                    .seconds = 0.4,
                    .excitation = sines(0.5, 500.0, 3.0)}},
                  {.keys = {"structure.inertia_tilt_kgm2", "structure.cm_height_m",
                            "gyros.rotor_inertia_kgm2"}});
    expect_within_three_sigma(found);
    EXPECT_NEAR(found.fit.reduced_chi_square(), 1.0, 0.1);
    distance += found.distance();
  }
  std::printf("distance %.3g of 9\n", distance);
  // chi^2 of 9 degrees of freedom: 1.7 to 23.6 with 99 %
  EXPECT_GT(distance, 1.7);
  EXPECT_LT(distance, 23.6);
}

TEST(CalibrateFit, PrototypeBsErrorsAreAsLargeAsSaidThroughContact) {
  double distance = 0.0;
  for (int i = 1; i <= 2; ++i) {
    const Outcome found =
        calibrate({{.rig = "prototype_b",
                    .overrides = {seed(i)},
                    .seconds = 0.2,
                    .excitation = sines(3.0, 1000.0, 4.0)}},
                  {.keys = {"structure.inertia_x_kgm2", "disc.inertia_polar_kgm2",
                            "gyros.rotor_inertia_kgm2", "contact.stiffness_n_per_m1_5"}});
    expect_within_three_sigma(found);
    EXPECT_NEAR(found.fit.reduced_chi_square(), 1.0, 0.1);
    distance += found.distance();
  }
  std::printf("distance %.3g of 8\n", distance);
  // chi^2 of 8 degrees of freedom: 1.3 to 22.0 with 99 %
  EXPECT_GT(distance, 1.3);
  EXPECT_LT(distance, 22.0);
}

/// The rig as it is for an experiment, with more overrides.
std::vector<std::string> arranged(const std::string& experiment,
                                  const std::vector<std::string>& more) {
  std::vector<std::string> all = arrangement(experiment_of(experiment), load_rig("prototype_b"));
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST(CalibrateFit, CoastDownTellsTheDiscsFrictionAndInertia) {
  const auto torque = [](std::int64_t k, int) { return k < 300 ? (k < 150 ? 4.0 : -4.0) : 0.0; };
  const Outcome found = calibrate(
      {{.rig = "prototype_b",
        .overrides = arranged("coast-down", {"rotor_drive.start_share=0", "initial.q=[0,0,0,0]",
                                             "initial.v=[0,0,-15,0]"}),
        .seconds = 3.0,
        .excitation = torque,
        .law = false,
        .spin_down = true}},
      {.keys = keys_of(experiment_of("coast-down"), load_rig("prototype_b")),
       .off = 0.2,
       .length_s = 0.5,
       .every = 5});
  expect_within_three_sigma(found);
}

TEST(CalibrateFit, RunDownTellsTheRotorsDrag) {
  const Outcome found = calibrate(
      {{.rig = "prototype_b",
        .overrides =
            arranged("run-down", {"initial.q=[0,0,0,0]", "initial.v=[0,0,0,0]", "loop.rate_hz=20"}),
        .seconds = 50.0,
        .law = false,
        .mode = status_t::MODE_SAFE_STOP,
        .spin_down = true}},
      {.keys = keys_of(experiment_of("run-down"), load_rig("prototype_b")),
       .off = 0.2,
       .length_s = 10.0,
       .every = 10});
  expect_within_three_sigma(found);
}

/// Hanging by a counterweight, rotors at rest, let go at 6 deg.
RunToRecord swing(const model::PointMass& weight, double seconds) {
  return {.rig = "prototype_b",
          .overrides = arranged("swing", {"rotor_drive.start_share=0", "initial.q=[0.1,0,0,0]",
                                          "initial.v=[0,0,0,0]"}),
          .seconds = seconds,
          .law = false,
          .mode = status_t::MODE_SAFE_STOP,
          .load = [weight](model::Input& input) { input.added.add(weight); },
          .spin_down = true};
}
const model::PointMass kLight{8.0, {0.0, 0.0, -0.4}}, kHeavy{14.0, {0.0, 0.0, -0.4}};

TEST(CalibrateFit, TwoCounterweightsTellInertiaAndCentreOfMass) {
  const Outcome found = calibrate({swing(kLight, 2.0), swing(kHeavy, 2.0)},
                                  {.keys = keys_of(experiment_of("swing"), load_rig("prototype_b")),
                                   .off = 0.1,
                                   .length_s = 0.5,
                                   .every = 5,
                                   .counterweights = {kLight, kHeavy}});
  expect_within_three_sigma(found);
}

TEST(CalibrateFit, RefusesWhatOneCounterweightCannotTellApart) {
  const Outcome found =
      calibrate({swing(kLight, 0.5)},
                {.keys = {"structure.inertia_x_kgm2", "structure.mass_kg", "structure.cm_height_m"},
                 .off = 0.0,
                 .length_s = 0.5,
                 .every = 5,
                 .counterweights = {kLight}});
  // Mass and height stand in one product alone.
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}}) {
    EXPECT_FALSE(found.findings[i].identified());
    EXPECT_NE(found.findings[i].refusal.find("cannot be told from"), std::string::npos)
        << found.findings[i].refusal;
  }
}

/// Sensors of a tenth of the price.
const std::vector<std::string> kPoor{"sensors.gyro_noise_rad_s=0.002",
                                     "sensors.disc_noise_rad=0.02"};

TEST(CalibrateFit, RefusesFrictionFromShortDrivenRuns) {
  const Outcome found =
      calibrate({{.rig = "prototype_b",
                  .overrides = kPoor,
                  .seconds = 0.15,
                  .excitation = sines(3.0, 1000.0, 4.0)}},
                {.keys = {"gyros.rotor_inertia_kgm2", "disc.viscous_friction_nms_per_rad",
                          "disc.coulomb_friction_nm", "structure.damping_nms_per_rad"},
                 .off = 0.0,
                 .use = {SensorKind::kGyro, SensorKind::kDisc}});
  EXPECT_NEAR(found.fit.reduced_chi_square(), 1.0, 0.2);
  EXPECT_TRUE(found.findings[0].identified());
  EXPECT_FALSE(found.findings[1].identified());
  EXPECT_NE(found.findings[1].advice.find("coast-down"), std::string::npos);
}

TEST(CalibrateFit, GyroAloneDoesNotTellTheTopplingStiffness) {
  const Outcome found = calibrate({{.rig = "prototype_b",
                                    .overrides = kPoor,
                                    .seconds = 0.15,
                                    .excitation = sines(3.0, 1000.0, 4.0)}},
                                  {.keys = {"structure.inertia_x_kgm2", "disc.inertia_polar_kgm2",
                                            "structure.cm_height_m", "gyros.rotor_inertia_kgm2"},
                                   .off = 0.0,
                                   .use = {SensorKind::kGyro}});
  EXPECT_FALSE(found.findings[2].identified());
  EXPECT_NE(found.findings[2].advice.find("swing"), std::string::npos);
}

}  // namespace
}  // namespace gyrotwin::calibration
