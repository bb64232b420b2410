#include "services/runtime/observation_wire.hpp"

#include <algorithm>
#include <iterator>

namespace gyrotwin {

namespace {

template <std::size_t N>
void copy(const std::array<double, N>& from, double (&to)[N], bool valid) {
  for (std::size_t i = 0; i < N; ++i) to[i] = valid ? from[i] : 0.0;
}

template <std::size_t N>
void copy(const double (&from)[N], std::array<double, N>& to) {
  std::copy(std::begin(from), std::end(from), to.begin());
}

}  // namespace

std::int32_t valid_groups(const model::Machine& machine) noexcept {
  const model::Layout& layout = machine.layout;
  const auto if_any = [](bool has, std::int32_t group) { return has ? group : 0; };
  return if_any(layout.tilts() > 0, state_t::VALID_TILT) |
         if_any(machine.disc_body != model::kFixed, state_t::VALID_DISC_TILT) |
         if_any(layout.disc != model::kFixed, state_t::VALID_DISC) |
         if_any(!layout.gimbals.empty(), state_t::VALID_GIMBALS) |
         if_any(machine.rotors > 0, state_t::VALID_ROTORS) |
         if_any(!machine.drives.empty(), state_t::VALID_DRIVES);
}

std::int32_t groups_for_laws(const model::Machine& machine) noexcept {
  std::int32_t looked_at = state_t::VALID_TILT;
  looked_at |= state_t::VALID_DISC;
  looked_at |= state_t::VALID_GIMBALS;
  return looked_at & valid_groups(machine);
}

void to_wire(const model::Observation& seen, std::int32_t valid, state_t& state) noexcept {
  state.valid = valid;
  copy(seen.tilt, state.tilt_rad, valid & state_t::VALID_TILT);
  copy(seen.tilt_rate, state.tilt_rate_rad_s, valid & state_t::VALID_TILT);
  copy(seen.disc_tilt, state.disc_tilt_rad, valid & state_t::VALID_DISC_TILT);
  copy(seen.disc_tilt_rate, state.disc_tilt_rate_rad_s, valid & state_t::VALID_DISC_TILT);
  state.disc_angle_rad = valid & state_t::VALID_DISC ? seen.disc_angle : 0.0;
  state.disc_rate_rad_s = valid & state_t::VALID_DISC ? seen.disc_rate : 0.0;
  copy(seen.gimbal_angle, state.gimbal_angle_rad, valid & state_t::VALID_GIMBALS);
  copy(seen.gimbal_rate, state.gimbal_rate_rad_s, valid & state_t::VALID_GIMBALS);
  copy(seen.rotor_speed, state.rotor_speed_rad_s, valid & state_t::VALID_ROTORS);
}

model::Observation from_wire(const state_t& state) noexcept {
  model::Observation seen;
  copy(state.tilt_rad, seen.tilt);
  copy(state.tilt_rate_rad_s, seen.tilt_rate);
  copy(state.disc_tilt_rad, seen.disc_tilt);
  copy(state.disc_tilt_rate_rad_s, seen.disc_tilt_rate);
  seen.disc_angle = state.disc_angle_rad;
  seen.disc_rate = state.disc_rate_rad_s;
  copy(state.gimbal_angle_rad, seen.gimbal_angle);
  copy(state.gimbal_rate_rad_s, seen.gimbal_rate);
  copy(state.rotor_speed_rad_s, seen.rotor_speed);
  return seen;
}

void from_wire(const command_t& command, model::Input& input) noexcept {
  input.mode =
      command.mode == command_t::VOLTAGE_V ? model::DriveMode::kVoltage : model::DriveMode::kTorque;
  copy(command.value, input.drive);
}

}  // namespace gyrotwin
