#include "services/controller/law.hpp"

#include <algorithm>
#include <cmath>

#include "services/controller/constant_speed.hpp"
#include "services/controller/momentum_manager.hpp"
#include "services/controller/open_loop.hpp"
#include "services/controller/precession.hpp"
#include "services/controller/precession_lqr.hpp"
#include "services/controller/reduced_lqr.hpp"
#include "services/controller/shelf.hpp"
#include "services/controller/tilt_to_speed.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/law_keys.hpp"

namespace gyrotwin {

namespace {

/// Whoever reads a rig file is told there; a rig made in a program, here.
void check(const Rig& rig) {
  const std::string why_not = misfit(rig);
  if (!why_not.empty()) throw Error(rig.file.string() + ": " + why_not);
  std::string keys;
  for (const MissingNumber& missing : missing_numbers(rig.controller)) {
    keys += (keys.empty() ? "`controller." : ", `controller.") + std::string(missing.key) + '`';
  }
  if (keys.empty()) return;
  throw Error(rig.file.string() + ": law " + std::string(name_of(rig.controller.law)) + " needs " +
              keys);
}

bool finite(const model::Observation& seen) noexcept {
  const auto all = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
  };
  return all(seen.tilt) && all(seen.tilt_rate) && all(seen.disc_tilt) && all(seen.disc_tilt_rate) &&
         std::isfinite(seen.disc_angle) && std::isfinite(seen.disc_rate) &&
         all(seen.gimbal_angle) && all(seen.gimbal_rate) && all(seen.rotor_speed);
}

}  // namespace

DriveTorques within_limits(const model::Machine& machine, const model::Observation& seen,
                           const DriveTorques& wanted) noexcept {
  const model::State state = machine.recall(seen);
  DriveTorques given{};
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    const double rate = machine.drive_rate(static_cast<int>(i), state);
    const auto [low, high] = machine.drives[i].range(rate);
    given[i] = std::clamp(wanted[i], low, high);
  }
  return given;
}

std::unique_ptr<Law> make_law(const Rig& rig) {
  check(rig);
  switch (rig.controller.law) {
    case LawKind::kNone:
      return nullptr;
    case LawKind::kOpenLoop:
      return std::make_unique<OpenLoop>(rig);
    case LawKind::kConstantSpeed:
      return std::make_unique<ConstantSpeed>(rig);
    case LawKind::kTiltToSpeed:
      return std::make_unique<TiltToSpeed>(rig);
    case LawKind::kMomentumManager:
      return std::make_unique<MomentumManager>(rig);
    case LawKind::kReducedLqr:
      return std::make_unique<ReducedLqr>(rig);
    case LawKind::kPrecession:
      return std::make_unique<Precession>(rig);
    case LawKind::kShelf:
      return std::make_unique<Shelf>(rig);
    case LawKind::kPrecessionLqr:
      return std::make_unique<PrecessionLqr>(rig);
  }
  return nullptr;
}

SampledLaw::SampledLaw(const Rig& rig, const model::Machine& machine)
    : law_(make_law(rig)), machine_(machine), tick_s_(rig.loop.tick_s()) {}

void SampledLaw::reset(const model::Observation& seen) noexcept {
  z_ = law_ ? law_->start(seen) : LawState::Zero();
}

DriveTorques SampledLaw::step(const model::Observation& seen) noexcept {
  if (!law_ || !finite(seen)) return {};
  const DriveTorques wanted = law_->torque(seen, z_);
  const DriveTorques given = within_limits(machine_, seen, wanted);
  z_ += tick_s_ * law_->rates(seen, z_, wanted, given);
  return given;
}

}  // namespace gyrotwin
