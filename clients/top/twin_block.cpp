#include <algorithm>

#include "clients/common/status_words.hpp"
#include "clients/common/tilt.hpp"
#include "clients/top/blocks.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kLabels = 20;  // columns, as of the state

Line row(std::string_view label, bool live) {
  Line line;
  line.put(live ? "  " : "? ", live ? Tone::kPlain : Tone::kWarning);
  line.put(label, live ? Tone::kPlain : Tone::kFaint).tab(kLabels);
  return line;
}

Line health_row(const Heard<health_t>& heard) {
  const health_t& health = heard.message;
  Line line = row("twin", heard.live());
  Tone tone = Tone::kPlain;
  if (health.verdict == health_t::AGREES) tone = Tone::kGood;
  if (health.verdict == health_t::DISAGREES) tone = Tone::kBad;
  if (!heard.live()) tone = Tone::kFaint;
  return line.put(verdict_text(health), tone);
}

Line forecast_row(const Heard<forecast_t>& heard) {
  const forecast_t& forecast = heard.message;
  Line line = row("forecast", heard.live());
  const bool falls = forecast.outcome == forecast_t::FALLS;
  Tone tone = falls ? Tone::kBad : Tone::kGood;
  if (!heard.live()) tone = Tone::kFaint;
  const auto seconds = [](std::int64_t ns) { return 1e-9 * static_cast<double>(ns); };
  if (falls) {
    line.put(fmt::format("FALLS in {:.2f} s", seconds(forecast.falls_in_ns)), tone);
  } else {
    line.put("stands", tone);
  }
  line.put(fmt::format(" ({:.0f} %)  tilt at most {:.2f} deg, then {:.2f}, in {:.1f} s",
                       100.0 * forecast.fall_probability, degrees(forecast.peak_tilt_rad),
                       degrees(forecast.final_tilt_rad), seconds(forecast.horizon_ns)));
  if (forecast.law == 0) line.put("  drives stopped", Tone::kWarning);
  return line;
}

}  // namespace

Lines twin_block(const View& view) {
  Lines lines;
  if (view.picture.health) lines.push_back(health_row(*view.picture.health));
  if (view.picture.forecast) lines.push_back(forecast_row(*view.picture.forecast));
  return lines;
}

}  // namespace gyrotwin
