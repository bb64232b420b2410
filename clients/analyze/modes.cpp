#include "clients/analyze/modes.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/MatrixFunctions>

#include "clients/analyze/loop.hpp"
#include "services/model/eigenvalues.hpp"
#include "services/model/linearise.hpp"

namespace gyrotwin {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kForgotten = 1e-12;  // an eigenvalue of one tick that leaves nothing
constexpr double kRounding = 1e-9;    // an imaginary part below that share of the whole is none
constexpr double kKink = 1e-3;        // slopes of a law that differ by this share are two
constexpr double kCorner = 0.05;      // slopes of a plant likewise: its contact is curved
constexpr double kAgrees = 1e-4;      // a larger difference from an exact Jacobian is no rounding

/// What the law does about small deviations.
struct LawSlopes {
  MatrixXd u_x, u_z;  // torques by plant state and by memory
  MatrixXd z_x, z_z;  // the memory's rates likewise
  bool kink = false;
};

LawSlopes law_slopes(const Loop& loop, const SteadyMotion& steady) {
  const Eigen::Index n = loop.plant_size();
  const Eigen::Index m = loop.memory_size();
  const auto answer = [&](const VectorXd& deviation) {
    const model::State state =
        loop.unpack(loop.pack(steady.state) + deviation.head(n), steady.state);
    LawState z = steady.memory;
    z.head(m) += deviation.tail(m);
    const DriveTorques torque = loop.torque(state, z);
    VectorXd out(model::kMaxDrives + m);
    out << Eigen::Map<const Eigen::Vector4d>(torque.data()), loop.memory_rate(state, z).head(m);
    return out;
  };
  const VectorXd here = VectorXd::Zero(n + m);
  const MatrixXd S = slopes(answer, here);
  LawSlopes found{S.topLeftCorner(model::kMaxDrives, n), S.topRightCorner(model::kMaxDrives, m),
                  S.bottomLeftCorner(m, n), S.bottomRightCorner(m, m)};
  const VectorXd at = answer(here);
  for (Eigen::Index i = 0; i < n + m; ++i) {
    VectorXd ahead = here;
    ahead[i] = Loop::kStep;
    const VectorXd forward = (answer(ahead) - at) / Loop::kStep;
    const double apart = (forward - S.col(i)).norm();
    if (apart > kKink * (1.0 + S.col(i).norm())) found.kink = true;
  }
  return found;
}

/// x' = A x + B u of the plant alone, and how far A is from differences.
struct PlantSlopes {
  MatrixXd A, B;
  double difference = 0.0;
  bool bends = false;
};

/// Every column against differences ahead, behind and across: at a corner it is that of one side.
/// What bends with a rate is a stop's damping, which takes energy on either side.
void compare_with_differences(const Loop& loop, const model::Machine& machine,
                              const SteadyMotion& steady, const model::Input& input,
                              PlantSlopes& plant) {
  const int n = loop.coordinates();
  const VectorXd at = loop.pack(steady.state);
  const auto moved = [&](Eigen::Index i, double step) -> VectorXd {
    VectorXd x = at;
    x[i] += step;
    return machine.acceleration(loop.unpack(x, steady.state), input).head(n);
  };
  const VectorXd here = moved(0, 0.0);
  const double largest = std::max(1.0, plant.A.bottomRows(n).cwiseAbs().maxCoeff());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const VectorXd ahead = (moved(i, Loop::kStep) - here) / Loop::kStep;
    const VectorXd behind = (here - moved(i, -Loop::kStep)) / Loop::kStep;
    const VectorXd across = 0.5 * (ahead + behind);
    const VectorXd exact = plant.A.col(i).tail(n);
    const auto off = [&](const VectorXd& x) { return (x - exact).cwiseAbs().maxCoeff() / largest; };
    plant.difference = std::max(plant.difference, std::min({off(ahead), off(behind), off(across)}));
    const bool corner = (ahead - across).norm() > kCorner * (1.0 + across.norm());
    if (corner && i < std::ssize(loop.positions())) plant.bends = true;
  }
}

PlantSlopes plant_slopes(const Loop& loop, const model::Machine& machine,
                         const SteadyMotion& steady) {
  const int n = loop.coordinates();
  const auto& positions = loop.positions();
  const Eigen::Index p = std::ssize(positions);
  model::Input input;
  input.mode = model::DriveMode::kIdealTorque;
  input.drive = steady.torque;
  const model::Linearisation about = model::linearise(machine, steady.state, input);

  PlantSlopes plant{MatrixXd::Zero(p + n, p + n), MatrixXd::Zero(p + n, model::kMaxDrives)};
  for (Eigen::Index k = 0; k < p; ++k) {
    plant.A(k, p + positions[static_cast<std::size_t>(k)]) = 1.0;
    plant.A.block(p, k, n, 1) = about.dq.col(positions[static_cast<std::size_t>(k)]).head(n);
  }
  plant.A.bottomRightCorner(n, n) = about.dv.topLeftCorner(n, n);
  plant.B.bottomRows(n) = about.torque.topRows(n);

  compare_with_differences(loop, machine, steady, input, plant);
  return plant;
}

/// One tick of plant, memory and the commands on their way.
MatrixXd one_tick(const PlantSlopes& plant, const LawSlopes& law, double tick, int delay) {
  const Eigen::Index n = plant.A.rows();
  const Eigen::Index m = law.z_z.rows();
  const Eigen::Index d = model::kMaxDrives;
  MatrixXd held = MatrixXd::Zero(n + d, n + d);
  held.topLeftCorner(n, n) = plant.A;
  held.topRightCorner(n, d) = plant.B;
  const MatrixXd moved = (held * tick).exp();
  const MatrixXd Ad = moved.topLeftCorner(n, n);
  const MatrixXd Bd = moved.topRightCorner(n, d);

  // (x, z, u of the last tick, of the one before, ...)
  const Eigen::Index size = n + m + delay * d;
  MatrixXd tick_map = MatrixXd::Zero(size, size);
  MatrixXd answer = MatrixXd::Zero(d, size);  // the law's, at the tick's beginning
  answer.leftCols(n) = law.u_x;
  answer.middleCols(n, m) = law.u_z;
  tick_map.topLeftCorner(n, n) = Ad;
  tick_map.block(n, 0, m, n) = tick * law.z_x;
  tick_map.block(n, n, m, m) = MatrixXd::Identity(m, m) + tick * law.z_z;
  if (delay == 0) {
    tick_map.topRows(n) += Bd * answer;
    return tick_map;
  }
  tick_map.block(0, size - d, n, d) = Bd;
  tick_map.middleRows(n + m, d) = answer;
  for (int k = 1; k < delay; ++k) {
    tick_map.block(n + m + k * d, n + m + (k - 1) * d, d, d).setIdentity();
  }
  return tick_map;
}

Eigen::VectorXcd fastest_growing_first(Eigen::VectorXcd values) {
  std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) {
    return a.real() != b.real() ? a.real() > b.real() : a.imag() > b.imag();
  });
  return values;
}

/// @param states how many are kept
Eigen::VectorXcd per_second(Eigen::VectorXcd of_one_tick, Eigen::Index states, double tick) {
  std::ranges::sort(of_one_tick, std::greater{}, [](const auto& mu) { return std::norm(mu); });
  const bool cuts_a_pair = states < of_one_tick.size() &&
                           of_one_tick[states - 1].imag() * of_one_tick[states].imag() < 0.0;
  std::vector<std::complex<double>> rates;
  for (const std::complex<double>& mu : of_one_tick.head(states - (cuts_a_pair ? 1 : 0))) {
    if (std::abs(mu) < kForgotten) continue;
    const std::complex<double> rate = std::log(mu) / tick;
    const bool rounding = std::abs(rate.imag()) < kRounding * std::abs(rate);
    rates.push_back(rounding ? rate.real() : rate);
  }
  return Eigen::Map<const Eigen::VectorXcd>(rates.data(), std::ssize(rates));
}

std::vector<std::string> state_names(const Loop& loop, const model::Machine& machine) {
  std::vector<std::string> names;
  for (const int i : loop.positions()) names.push_back(machine.layout.names[i]);
  for (const std::string& name : machine.layout.names) names.push_back(name + "_dot");
  for (Eigen::Index i = 0; i < loop.memory_size(); ++i) names.push_back(fmt::format("z{}", i));
  return names;
}

}  // namespace

bool Modes::sound() const { return !law_bends && !plant_bends && difference < kAgrees; }

std::optional<double> LinearModel::growth() const {
  if (!modes.sound() || steady.coasts || estimated) return std::nullopt;
  return modes.growth;
}

Modes modes_about(const Rig& rig, const model::Machine& machine, const Law* law,
                  const SteadyMotion& steady) {
  const Loop loop(machine, law);
  const PlantSlopes plant = plant_slopes(loop, machine, steady);
  const LawSlopes slopes_of_law = law_slopes(loop, steady);
  const Eigen::Index n = loop.plant_size();
  const Eigen::Index m = loop.memory_size();

  Modes modes;
  modes.states = state_names(loop, machine);
  modes.F = MatrixXd::Zero(n + m, n + m);
  modes.F.topLeftCorner(n, n) = plant.A + plant.B * slopes_of_law.u_x;
  modes.F.topRightCorner(n, m) = plant.B * slopes_of_law.u_z;
  modes.F.bottomLeftCorner(m, n) = slopes_of_law.z_x;
  modes.F.bottomRightCorner(m, m) = slopes_of_law.z_z;
  modes.difference = plant.difference;
  modes.law_bends = slopes_of_law.kink;
  modes.plant_bends = plant.bends;
  if (law == nullptr) {
    modes.eigenvalues = fastest_growing_first(model::eigenvalues(modes.F));
  } else {
    const double tick = rig.loop.tick_s();
    const MatrixXd map = one_tick(plant, slopes_of_law, tick, rig.loop.command_delay_ticks);
    modes.eigenvalues = fastest_growing_first(per_second(model::eigenvalues(map), n + m, tick));
  }
  modes.growth = modes.eigenvalues.size() > 0 ? modes.eigenvalues[0].real() : 0.0;
  return modes;
}

std::optional<LinearModel> linear_model(const Rig& rig) {
  if (rig.controller.law == LawKind::kOpenLoop) return std::nullopt;
  const model::Machine machine = rig.build_machine();
  const std::unique_ptr<Law> law = make_law(rig);
  LinearModel linear{steady_motion(rig, machine, law.get()), {}};
  linear.estimated = law != nullptr && rig.loop.state == StateSource::kEstimate;
  if (!linear.steady.found) return std::nullopt;
  linear.modes = modes_about(rig, machine, law.get(), linear.steady);
  return linear;
}

}  // namespace gyrotwin
