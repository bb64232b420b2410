#include "clients/top/margins.hpp"

#include <cmath>

#include "clients/common/tilt.hpp"

namespace gyrotwin {

namespace {

// Less than this share of the whole is close.
constexpr double kCloseTilt = 0.5;
constexpr double kCloseStop = 0.1;
constexpr double kCloseDrive = 0.2;
constexpr double kGone = 1e-3;

Margin margin(double left, double whole, double close) {
  const double share = whole > 0.0 ? left / whole : 0.0;
  if (share <= kGone) return {left, Margin::Room::kGone};
  return {left, share < close ? Margin::Room::kClose : Margin::Room::kFine};
}

}  // namespace

Margins margins_of(const Picture& picture, const RigFacts& facts) {
  Margins margins;
  if (!picture.state || !picture.state->live()) return margins;
  const state_t& state = picture.state->message;
  if (state.mode == status_t::MODE_FAULT) return margins;
  const truth_t* truth = picture.truth && picture.truth->live() ? &picture.truth->message : nullptr;

  if ((state.valid & state_t::VALID_TILT) != 0) {
    const double left =
        truth != nullptr ? truth->tilt_margin_rad : facts.fall_tilt - tilt_of(state);
    margins.tilt = margin(left, facts.fall_tilt, kCloseTilt);
  }
  for (int j = 0; j < facts.gyros && (state.valid & state_t::VALID_GIMBALS) != 0; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double left = facts.stop_margin(j, state.gimbal_angle_rad[i]);
    if (!std::isfinite(left)) continue;
    margins.gimbal[i] = margin(left, facts.upper_stop[i] - facts.lower_stop[i], kCloseStop);
  }
  for (int i = 0; i < facts.drives && (state.valid & state_t::VALID_DRIVES) != 0; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double left = truth != nullptr ? truth->drive_margin_nm[k] : facts.drive_margin(i, state);
    if (!std::isfinite(left)) continue;
    margins.drive[k] = margin(left, left + std::abs(state.drive_torque_nm[k]), kCloseDrive);
  }
  return margins;
}

}  // namespace gyrotwin
