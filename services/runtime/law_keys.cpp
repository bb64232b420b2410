#include "services/runtime/law_keys.hpp"

#include <algorithm>
#include <array>

#include "services/runtime/rig_reader.hpp"

namespace gyrotwin {

namespace {

using C = Rig::Controller;
using Number = std::optional<double> C::*;

constexpr LawNumber kNumbers[]{
    {"disc_speed_rad_s", &C::disc_speed, kAnyNumber},
    {"kp_nms_per_rad", &C::kp, kNotNegative},
    {"ki_nm_per_rad", &C::ki, kNotNegative},
    {"integral_limit_nm", &C::integral_limit, kNotNegative},
    {"momentum_rate_per_s", &C::momentum_rate, kPositive},
    {"elevation_gain_nm_per_rad", &C::elevation_gain, kNotNegative},
    {"tilt_max_rad", &C::tilt_max, kPositive},
    {"speed_max_rad_s", &C::speed_max, kPositive},
    {"gimbal_max_rad", &C::gimbal_max, kPositive},
    {"torque_max_nm", &C::torque_max, kPositive},
    {"amplitude_nm", &C::amplitude, kAnyNumber},
    {"frequency_hz", &C::frequency, kPositive},
    {"phase_rad", &C::phase, kAnyNumber},
    {"tilt_speed_gain_per_s", &C::tilt_speed_gain, kNotNegative},
    {"rate_speed_gain", &C::rate_speed_gain, kNotNegative},
    {"speed_limit_rad_s", &C::speed_limit, kPositive},
    {"tilt_gain_nm_per_rad", &C::tilt_gain, kNotNegative},
    {"gimbal_gain_nm_per_rad", &C::gimbal_gain, kNotNegative},
    {"gimbal_damping_nms_per_rad", &C::gimbal_damping, kNotNegative},
    {"shelf_torque_nm", &C::shelf_torque, kPositive},
    {"shelf_tilt_rad", &C::shelf_tilt, kPositive},
};

// One bit for each alternative of Rig::machine.
constexpr unsigned kUmbrella = 1, kGimballed = 2, kGyroscope = 4;
constexpr std::array kMachineNames{"an umbrella platform", "a machine with driven gimbals",
                                   "a gyroscope on a post"};

/// What a law cannot do without; unused places are null.
struct Row {
  LawKind law;
  unsigned machines;
  std::array<Number, 7> needs;
  std::array<Number, 3> weights{};  // needed unless `gain` is given
};

constexpr Row kRows[]{
    {LawKind::kNone, kUmbrella | kGimballed | kGyroscope, {}},
    {LawKind::kOpenLoop, kUmbrella | kGimballed | kGyroscope, {&C::amplitude, &C::frequency}},
    {LawKind::kConstantSpeed,
     kUmbrella | kGyroscope,
     {&C::disc_speed, &C::kp, &C::ki, &C::integral_limit}},
    {LawKind::kTiltToSpeed,
     kUmbrella,
     {&C::disc_speed, &C::tilt_speed_gain, &C::rate_speed_gain, &C::speed_limit, &C::kp, &C::ki,
      &C::integral_limit}},
    {LawKind::kMomentumManager, kUmbrella, {&C::disc_speed, &C::momentum_rate}},
    {LawKind::kReducedLqr,
     kUmbrella,
     {&C::disc_speed},
     {&C::tilt_max, &C::speed_max, &C::torque_max}},
    {LawKind::kPrecession, kGimballed, {&C::tilt_gain, &C::gimbal_damping, &C::gimbal_gain}},
    {LawKind::kShelf,
     kGimballed,
     {&C::shelf_torque, &C::shelf_tilt, &C::gimbal_damping, &C::gimbal_gain}},
    {LawKind::kPrecessionLqr, kGimballed, {}, {&C::tilt_max, &C::gimbal_max, &C::torque_max}},
};
static_assert(std::size(kRows) == kLawWords.size());

const Row& row_of(LawKind law) { return *std::ranges::find(kRows, law, &Row::law); }

}  // namespace

std::span<const LawNumber> law_numbers() { return kNumbers; }

std::vector<MissingNumber> missing_numbers(const Rig::Controller& controller) {
  std::vector<MissingNumber> missing;
  const auto look = [&](Number number, bool unless_gain) {
    if (!number || controller.*number) return;
    const LawNumber& known = *std::ranges::find(kNumbers, number, &LawNumber::value);
    missing.push_back({known.key, unless_gain});
  };
  const Row& row = row_of(controller.law);
  for (const Number number : row.needs) look(number, false);
  if (controller.gain.empty()) {
    for (const Number number : row.weights) look(number, true);
  }
  return missing;
}

std::string misfit(const Rig& rig) {
  const unsigned machine = 1U << rig.machine.index();
  if (row_of(rig.controller.law).machines & machine) return {};
  std::string fitting;
  for (const Row& row : kRows) {
    if (!(row.machines & machine)) continue;
    fitting += (fitting.empty() ? "" : ", ") + std::string(name_of(row.law));
  }
  return "law " + std::string(name_of(rig.controller.law)) + " does not fit " +
         kMachineNames[rig.machine.index()] + "; laws that fit: " + fitting;
}

}  // namespace gyrotwin
