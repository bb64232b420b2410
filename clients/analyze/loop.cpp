#include "clients/analyze/loop.hpp"

namespace gyrotwin {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd slopes(const std::function<VectorXd(const VectorXd&)>& f, const VectorXd& x) {
  MatrixXd J(f(x).size(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    VectorXd above = x, below = x;
    above[i] += Loop::kStep;
    below[i] -= Loop::kStep;
    J.col(i) = (f(above) - f(below)) / (2.0 * Loop::kStep);
  }
  return J;
}

Loop::Loop(const model::Machine& machine, const Law* law) : machine_(machine), law_(law) {
  for (int i = 0; i < machine.coordinates(); ++i) {
    if (i != cyclic()) positions_.push_back(i);
  }
}

VectorXd Loop::pack(const model::State& state) const {
  VectorXd x(plant_size());
  Eigen::Index k = 0;
  for (const int i : positions_) x[k++] = state.q[i];
  for (int i = 0; i < coordinates(); ++i) x[k++] = state.v[i];
  return x;
}

model::State Loop::unpack(const VectorXd& x, const model::State& like) const {
  model::State state = like;
  Eigen::Index k = 0;
  for (const int i : positions_) state.q[i] = x[k++];
  for (int i = 0; i < coordinates(); ++i) state.v[i] = x[k++];
  return state;
}

DriveTorques Loop::torque(const model::State& state, const LawState& z) const {
  if (law_ == nullptr) return {};
  const model::Observation seen = machine_.observe(state);
  return within_limits(machine_, seen, law_->torque(seen, z));
}

LawState Loop::memory_rate(const model::State& state, const LawState& z) const {
  if (law_ == nullptr) return LawState::Zero();
  const model::Observation seen = machine_.observe(state);
  const DriveTorques wanted = law_->torque(seen, z);
  return law_->rates(seen, z, wanted, within_limits(machine_, seen, wanted));
}

model::Coordinates Loop::acceleration(const model::State& state, const LawState& z) const {
  model::Input input;
  input.mode = model::DriveMode::kIdealTorque;
  input.drive = torque(state, z);
  return machine_.acceleration(state, input);
}

}  // namespace gyrotwin
