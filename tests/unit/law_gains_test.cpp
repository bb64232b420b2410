// Gains and closed-loop poles of the linear laws, and their signs on the whole machine.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <complex>

#include "services/controller/law.hpp"
#include "services/controller/precession.hpp"
#include "services/controller/precession_lqr.hpp"
#include "services/controller/reduced_lqr.hpp"
#include "services/controller/riccati.hpp"
#include "services/controller/shelf.hpp"
#include "tests/support/law_rigs.hpp"

namespace gyrotwin {
namespace {

using model::Observation;
using reference::brennan;
using reference::double_brennan;
using reference::gyrocar;
using reference::reduced_lqr;
using std::literals::complex_literals::operator""i;

/// From the Hamiltonian's eigenvectors in 50 digits (mpmath), to 8 or more of them.
struct Known {
  const char* name;
  Rig rig;
  Eigen::RowVectorXd K;
  std::vector<std::complex<double>> poles;
};

class Gains : public testing::TestWithParam<Known> {};

const Feedback& feedback_of(const Law& law) {
  if (const auto* reduced = dynamic_cast<const ReducedLqr*>(&law)) return reduced->feedback();
  if (const auto* classical = dynamic_cast<const Precession*>(&law)) return classical->feedback();
  if (const auto* shelf = dynamic_cast<const Shelf*>(&law)) return shelf->feedback();
  return dynamic_cast<const PrecessionLqr&>(law).feedback();
}

TEST_P(Gains, AreThoseOfAnIndependentSolver) {
  const Known& known = GetParam();
  const auto law = make_law(known.rig);
  const Feedback& feedback = feedback_of(*law);
  ASSERT_EQ(feedback.K.size(), known.K.size());
  // measured 3.4e-10, the digits given
  EXPECT_LT((feedback.K.cwiseQuotient(known.K).array() - 1.0).abs().maxCoeff(), 1e-9);
  ASSERT_EQ(feedback.poles.size(), std::ssize(known.poles));
  for (std::size_t i = 0; i < known.poles.size(); ++i) {
    // measured 2.7e-8, the digits given
    EXPECT_LT(std::abs(feedback.poles[i] - known.poles[i]), 1e-7 * std::abs(known.poles[i]));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Machines, Gains,
    testing::Values(
        Known{"prototype_b",
              reduced_lqr("prototype_b", 2.0, 0.02, 5.0),
              Eigen::RowVector3d(100.5366177, 0.05193757287, 0.7697347509),
              {-3.7941537, -3.2447839 - 139.97223i, -3.2447839 + 139.97223i}},
        Known{"prototype_a",
              reduced_lqr("prototype_a", 4.0, 0.05, 3.0),
              Eigen::RowVector3d(87.44163403, 11.89123835, 1.869274951),
              {-8.9688619, -5.4582055 - 6.311546i, -5.4582055 + 6.311546i}},
        Known{"brennan",
              brennan(),
              Eigen::RowVector4d(697927.3846, 258227.34, -66666.66667, 3778.9613),
              {-13.670277 - 20.400858i, -13.670277 + 20.400858i, -2.976893, -1.3449629}},
        Known{"double",
              double_brennan(),
              Eigen::RowVector4d(72.23561115, 1.725553765, -20.0, 0.2061524171),
              {-18.069977 - 133.97724i, -18.069977 + 133.97724i, -12.314707, -0.72644451}},
        Known{"gyrocar",
              gyrocar(),
              Eigen::RowVector4d(21743.58329, 732.3091527, -6000.0, 86.38257409),
              {-9.1668318 - 95.945322i, -9.1668318 + 95.945322i, -5.8441252, -0.40143861}}),
    [](const auto& case_) { return std::string(case_.param.name); });

TEST(Gain, IsDescribedWithItsPoles) {
  EXPECT_EQ(make_law(brennan())->describe(),
            "precession_lqr: u = -K (th, th', q, q'), K = (697927, 258227, -66666.7, 3778.96), "
            "closed-loop poles -13.67+-20.4i, -2.977, -1.345 1/s");
}

/// Eigenvalues of the closed loop at q = v = 0, by central differences.
Eigen::VectorXcd closed_loop_poles(const Rig& rig) {
  const model::Machine machine = model::build(std::get<model::GimballedParameters>(rig.machine));
  const auto law = make_law(rig);
  const int n = machine.coordinates();
  const auto acceleration = [&](const model::State& state) {
    model::Input input;
    input.mode = model::DriveMode::kIdealTorque;
    input.drive = law->torque(machine.observe(state), LawState::Zero());
    return machine.acceleration(state, input);
  };
  constexpr double kStep = 1e-5;
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  F.topRightCorner(n, n).setIdentity();
  for (int i = 0; i < 2 * n; ++i) {
    model::State plus = machine.state({}, {}), minus = plus;
    (i < n ? plus.q[i] : plus.v[i - n]) = kStep;
    (i < n ? minus.q[i] : minus.v[i - n]) = -kStep;
    F.block(n, i, n, 1) = ((acceleration(plus) - acceleration(minus)) / (2.0 * kStep)).head(n);
  }
  return poles(F);
}

void expect_reduced_poles(const Rig& rig, double tolerance) {
  const auto law = make_law(rig);
  SCOPED_TRACE(law->describe());
  const Eigen::VectorXcd& reduced = feedback_of(*law).poles;
  const Eigen::VectorXcd whole = closed_loop_poles(rig);
  EXPECT_LT(whole.real().maxCoeff(), 0.0);
  for (const std::complex<double>& pole : whole) {  // of two pairs: each pole twice
    EXPECT_LT((reduced.array() - pole).abs().minCoeff(), tolerance * std::abs(pole));
  }
}

TEST(Signs, ClosedLoopOfTheWholeMachineHasTheReducedModelsPoles) {
  for (const Rig& rig : {brennan(), gyrocar(), double_brennan(),
                         reference::precession("brennan_monorail", 2e5, 1500.0, 8e3),
                         reference::precession("gyrocar", 2e4, 500.0, 6e3),
                         reference::precession("double_brennan", 60.0, 1.0, 20.0)}) {
    expect_reduced_poles(rig, 1e-9);  // measured 3.4e-11
  }
  for (const Rig& rig : {reference::shelf("brennan_monorail", 6000.0, 0.03, 1500.0, 8e3),
                         reference::shelf("gyrocar", 600.0, 0.03, 500.0, 6e3),
                         reference::shelf("double_brennan", 1.8, 0.03, 1.0, 20.0)}) {
    expect_reduced_poles(rig, 1e-7);  // measured 8.3e-8: tanh over the step of the differences
  }
}

TEST(Signs, OfTheReducedPlatformKeepItUp) {
  const Rig rig = reduced_lqr("prototype_a", 4.0, 0.05, 3.0);
  const auto law = make_law(rig);
  const auto& p = std::get<model::UmbrellaParameters>(rig.machine);
  const auto r = model::reduce(p);
  // Columns by unit steps from (th, th', phi') = (0.01, 0, -Om0), where friction's tanh is flat.
  const auto rates = [&](const Eigen::Vector3d& x) {
    Observation seen;
    seen.disc_rate = x[2];
    seen.tilt[0] = x[0];
    seen.tilt_rate[0] = x[1];
    const double tau = law->torque(seen, LawState::Zero())[0];
    return Eigen::Vector3d(x[1], (r.U * x[0] - p.structure.damping * x[1] + r.H * x[2]) / r.A,
                           (tau - r.H * x[1] - p.disc.viscous_friction * x[2]) / r.C);
  };
  const Eigen::Vector3d at(0.01, 0.0, -4.0);
  Eigen::Matrix3d F;
  for (int i = 0; i < 3; ++i) {
    F.col(i) = (rates(at + 1e-3 * Eigen::Vector3d::Unit(i)) - rates(at)) / 1e-3;
  }
  const Eigen::VectorXcd expected = dynamic_cast<const ReducedLqr&>(*law).feedback().poles;
  const Eigen::VectorXcd found = poles(F);
  EXPECT_LT(found.real().maxCoeff(), -5.0);
  EXPECT_LT((found - expected).norm(), 1e-9);  // measured 1.5e-11
}

}  // namespace
}  // namespace gyrotwin
