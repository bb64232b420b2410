#include "clients/disturb/aftermath.hpp"

#include <spdlog/fmt/fmt.h>

#include <string_view>

#include "clients/common/tilt.hpp"
#include "services/runtime/mode.hpp"

namespace gyrotwin {

Aftermath::Aftermath(const reply_t& reply, std::int64_t tick_ns, double span_s)
    : epoch_(reply.header.epoch),
      begin_(reply.applied_tick),
      tick_ns_(tick_ns),
      span_s_(span_s),
      peak_tick_(begin_) {}

bool Aftermath::on(const state_t& state) noexcept {
  if (state.header.epoch != epoch_ || state.header.tick <= tick_) return false;
  tick_ = state.header.tick;
  mode_ = state.mode;
  if (tick_ < begin_ || (state.valid & state_t::VALID_TILT) == 0) return true;
  tilt_ = tilt_of(state);
  if (tilt_ > peak_) {
    peak_ = tilt_;
    peak_tick_ = tick_;
  }
  return true;
}

std::string Aftermath::text() const {
  if (fell()) {
    return fmt::format("{} after {:.3g} s; `gyrotwin ctl reset`, then `gyrotwin ctl arm`",
                       mode_name(mode_), time(tick_));
  }
  const std::string_view stopped =
      mode_ == status_t::MODE_SAFE_STOP ? "; SAFE_STOP, `gyrotwin ctl status` says why" : "";
  if (peak_ < 0.0) return fmt::format("STATE tells no tilt to watch{}", stopped);
  return fmt::format("peak {:.3f} deg after {:.3g} s, {:.3f} deg after {:.3g} s{}", degrees(peak_),
                     time(peak_tick_), degrees(tilt_), time(tick_), stopped);
}

}  // namespace gyrotwin
