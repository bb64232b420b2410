#include "clients/ctl/balance.hpp"

#include "clients/common/tilt.hpp"

namespace gyrotwin {

bool BalanceWatch::on(const state_t& state) noexcept {
  if ((state.valid & state_t::VALID_TILT) == 0) return false;
  tilt_ = tilt_of(state);
  const bool good = state.mode == status_t::MODE_RUNNING && tilt_ <= limit_;
  const bool goes_on = within_ && state.header.epoch == epoch_;
  if (good && !goes_on) {
    epoch_ = state.header.epoch;
    since_ns_ = state.header.sim_time_ns;
  }
  within_ = good;
  return good && state.header.sim_time_ns - since_ns_ >= span_ns_;
}

}  // namespace gyrotwin
