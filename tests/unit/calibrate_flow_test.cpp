// Sensitivities of flows and readings against differences of the model itself.
#include <gtest/gtest.h>

#include <cmath>

#include "clients/calibrate/flow.hpp"
#include "clients/calibrate/readings.hpp"
#include "services/integrator/plant.hpp"

namespace gyrotwin::calibration {
namespace {

struct Case {
  const char* name;
  std::vector<std::string> keys;
  std::vector<std::string> overrides;
};

const std::vector<Case> kCases{
    {"double_brennan",
     {"structure.inertia_tilt_kgm2", "structure.cm_height_m", "gyros.rotor_inertia_kgm2",
      "gyros.damping_nms_per_rad"},
     {}},
    {"prototype_b",
     {"structure.inertia_x_kgm2", "disc.inertia_polar_kgm2", "gyros.rotor_inertia_kgm2",
      "contact.stiffness_n_per_m1_5", "disc.coulomb_friction_nm"},
     {}},
    {"prototype_b",
     {"rotor_drive.viscous_drag_nms_per_rad", "rotor_drive.coulomb_drag_nm",
      "gyros.rotor_inertia_kgm2"},
     {}},
    {"load_cell_rig", {"structure.cm_height_m", "load_cell.stiffness_n_per_m"}, {}},
};

class CalibrateFlow : public ::testing::TestWithParam<std::size_t> {
 protected:
  CalibrateFlow()
      : what(kCases[GetParam()]),
        rig(load_rig(what.name, what.overrides)),
        family(what.name, what.overrides, what.keys) {
    for (const Parameter& p : family.parameters()) x.push_back(p.start / p.scale);
    around = std::make_unique<Neighbourhood>(family.around(x));
    const model::State start = rig.initial_state(around->machine);
    held = start.rotor_speed;
    y.resize(packed_size(around->machine));
    pack(around->machine, start, y.data());
    for (Eigen::Index i = 0; i < around->machine.coordinates(); ++i) y[i] += 0.001 * (i + 1.0);
  }

  model::Input input(int tick) const {
    model::Input input;
    for (std::size_t i = 0; i < around->machine.drives.size(); ++i) {
      input.drive[i] = 0.05 * around->machine.drives[i].torque_limit * std::sin(0.3 * tick + 1.0);
    }
    return input;
  }

  Eigen::VectorXd end(const Neighbourhood& at, const Eigen::VectorXd& from, int ticks) const {
    Flow flow(at, held, from, false);
    for (int k = 0; k < ticks; ++k) {
      EXPECT_TRUE(flow.advance(input(k), rig.loop.tick_s(), rig.loop.tick_s()));
    }
    return flow.state();
  }

  const Case& what;
  Rig rig;
  Family family;
  std::vector<double> x;
  std::unique_ptr<Neighbourhood> around;
  model::RotorSpeeds held;
  Eigen::VectorXd y;
};

/// Of a column, where differences of size `noise` are too small to be told.
void expect_near(const Eigen::VectorXd& found, const Eigen::VectorXd& differences, double relative,
                 double noise, const std::string& of) {
  const double tolerance = relative * differences.norm() + noise;
  EXPECT_LT((found - differences).norm(), tolerance) << of << "\n"
                                                     << found.transpose() << "\n"
                                                     << differences.transpose();
}

TEST_P(CalibrateFlow, GoesWhereThePlantGoes) {
  Plant plant(around->machine, rig.loop.tick_s(), {StepPolicy::Kind::kAdaptive});
  plant.set_state(unpack(around->machine, y.data(), held));
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(plant.advance(input(k)));
  Eigen::VectorXd there(y.size());
  pack(around->machine, plant.state(), there.data());
  // measured 2e-6: a tolerance of 1e-7 a step, and 50 ticks of starting anew
  EXPECT_LT((end(*around, y, 50) - there).cwiseAbs().maxCoeff(), 2e-5);
}

TEST_P(CalibrateFlow, SensitivitiesAreThoseOfDifferences) {
  constexpr int kTicks = 20;
  Flow flow(*around, held, y, true);
  for (int k = 0; k < kTicks; ++k) {
    ASSERT_TRUE(flow.advance(input(k), rig.loop.tick_s(), rig.loop.tick_s()));
  }
  const Eigen::MatrixXd& S = flow.sensitivity();
  for (Eigen::Index j = 0; j < y.size(); ++j) {
    const double step = j < 2 * around->machine.coordinates() ? 1e-4 : 1.0;
    Eigen::VectorXd up = y;
    Eigen::VectorXd down = y;
    up[j] += step;
    down[j] -= step;
    const Eigen::VectorXd slope =
        (end(*around, up, kTicks) - end(*around, down, kTicks)) / (2.0 * step);
    expect_near(S.col(j), slope, 2e-3, 1e-6 / step, "state " + std::to_string(j));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    constexpr double kStep = 1e-3;
    std::vector<double> moved = x;
    moved[i] = x[i] + kStep;
    const Neighbourhood up{family.machine_at(moved), {}};
    moved[i] = x[i] - kStep;
    const Neighbourhood down{family.machine_at(moved), {}};
    const Eigen::VectorXd slope = (end(up, y, kTicks) - end(down, y, kTicks)) / (2.0 * kStep);
    expect_near(S.col(y.size() + static_cast<Eigen::Index>(i)), slope, 2e-3, 1e-6 / kStep,
                what.keys[i]);
  }
}

TEST_P(CalibrateFlow, ReadingsHangOnStateAsDifferencesSay) {
  const model::State state = unpack(around->machine, y.data(), held);
  const ReadingDerivatives d = reading_derivatives(*around, state, input(3), *rig.sensors);
  for (Eigen::Index j = 0; j < y.size(); ++j) {
    const double step = j < 2 * around->machine.coordinates() ? 1e-6 : 1e-2;
    const auto at = [&](double by) {
      Eigen::VectorXd moved = y;
      moved[j] += by;
      return predict(around->machine, unpack(around->machine, moved.data(), held), input(3),
                     *rig.sensors);
    };
    const Readings slope = (at(step) - at(-step)) / (2.0 * step);
    expect_near(d.by_state.col(j), slope, 1e-5, 1e-6 / step * 1e-3, "state " + std::to_string(j));
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, CalibrateFlow, ::testing::Range(std::size_t{0}, kCases.size()));

}  // namespace
}  // namespace gyrotwin::calibration
