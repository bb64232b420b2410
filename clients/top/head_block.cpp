#include <algorithm>
#include <string>

#include "clients/common/run_name.hpp"
#include "clients/common/status_words.hpp"
#include "clients/common/tilt.hpp"
#include "clients/top/blocks.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kNarrowestText = 20;

Tone tone_of(std::int32_t mode) {
  switch (mode) {
    case status_t::MODE_RUNNING:
      return Tone::kGood;
    case status_t::MODE_PAUSED:
    case status_t::MODE_SAFE_STOP:
      return Tone::kWarning;
    case status_t::MODE_FALLEN:
    case status_t::MODE_FAULT:
      return Tone::kBad;
    default:
      return Tone::kTitle;
  }
}

/// What a mode means, where the owner gives no reason for it.
std::string_view meaning(const status_t& owner) {
  const bool real = owner.service == status_t::HARDWARE;
  switch (owner.mode) {
    case status_t::MODE_HELD:
      return real ? "propped up by hand; `gyrotwin ctl arm` lets it go"
                  : "held at its initial state; `gyrotwin ctl arm` lets it go";
    case status_t::MODE_RUNNING:
      return real ? "the plant is free, commands are obeyed"
                  : "the physics runs, commands are obeyed";
    case status_t::MODE_PAUSED:
      return "time stands still; `gyrotwin ctl resume` lets it go on";
    default:
      return "`gyrotwin ctl reset` leads back to HELD";
  }
}

Lines mode_lines(const View& view) {
  const Peer& owner = view.picture.owner;
  if (!owner) {
    Line line;
    line.put("owner NOT HEARD", Tone::kBad);
    line.put("  start `gyrotwin integrator --rig " + view.facts.name + "`");
    return {line, Line().put("                 or `gyrotwin hardware`, where it is real")};
  }
  const status_t& status = owner->message;
  const std::string mode(mode_name(status.mode));
  Lines lines;
  std::string why = get_text(status.text);
  if (owner->live()) {
    lines.emplace_back().put(mode, tone_of(status.mode));
    lines.back().put(fmt::format(" ({})  ", plant_name(status)));
  } else {
    lines.emplace_back().put("owner NOT HEARD", Tone::kBad).put("  ");
    why = fmt::format("last heard {}, then {}{}{}", ago(owner->age_ns), mode,
                      why.empty() ? "" : ": ", why);
  }
  const std::size_t indent = lines.front().width();
  const Tone tone = why.empty() ? Tone::kFaint : Tone::kPlain;
  if (why.empty()) why = meaning(status);
  const std::size_t room = std::max(view.columns, indent + kNarrowestText) - indent;
  for (const std::string& part : wrap(why, room)) {
    if (lines.back().width() > indent) lines.emplace_back().tab(indent);
    lines.back().put(part, tone);
  }
  return lines;
}

Line clock_line(const View& view) {
  Line line;
  const Peer& owner = view.picture.owner;
  if (!view.picture.latest) return line.put("nothing heard yet", Tone::kFaint);
  const Tone tone = view.picture.owner_live() ? Tone::kPlain : Tone::kFaint;
  const header_t& latest = *view.picture.latest;
  if (!view.picture.owner_live()) line.put("last heard: ", tone);
  line.put(
      fmt::format("tick {}, {:.3f} s", latest.tick, 1e-9 * static_cast<double>(latest.sim_time_ns)),
      tone);
  if (!owner) return line;
  const status_t& status = owner->message;
  const double rate =
      status.tick_period_ns > 0 ? 1e9 / static_cast<double>(status.tick_period_ns) : 0.0;
  line.put(
      fmt::format("   {}, {:g} Hz, speed {:g}", pace_name(status.clock), rate, status.speed_factor),
      tone);
  if (view.picture.speed && ticks(static_cast<Mode>(status.mode))) {
    line.put(fmt::format(" (measured {:.2f})", *view.picture.speed), tone);
  }
  return line.put("   run " + run_name(latest.epoch), Tone::kFaint);
}

/// "tilt 38.9 deg fine".
void put_margin(Line& line, const std::string& what, const Margin& margin, std::string_view gone) {
  const std::string_view words[] = {"fine", "close", gone};
  const std::string_view word = words[static_cast<std::size_t>(margin.room)];
  line.put("  " + what + " ").put(word, tone_of(margin.room));
}

Line margins_line(const View& view) {
  const auto& state = view.picture.state;
  Line line;
  line.put("margins");
  if (!state || !state->live()) {
    return line.put("  unknown, STATE is not heard", Tone::kBad);
  }
  if (state->message.mode == status_t::MODE_FAULT) return line.put("  unknown since the fault");
  const Margins margins = margins_of(view.picture, view.facts);
  if (const auto& tilt = margins.tilt) {
    put_margin(line, fmt::format("tilt {:.1f} deg", degrees(tilt->left)), *tilt,
               "BEYOND THE LIMIT");
  }
  if (const auto gimbal = worst(margins.gimbal)) {
    put_margin(line, fmt::format("gimbals {:.1f} deg", degrees(gimbal->left)), *gimbal,
               "IN THE STOP");
  }
  if (const auto drive = worst(margins.drive)) {
    put_margin(line, fmt::format("drives {:.2f} N m", drive->left), *drive, "SATURATED");
  }
  return line;
}

}  // namespace

Tone tone_of(Margin::Room room) {
  switch (room) {
    case Margin::Room::kFine:
      return Tone::kGood;
    case Margin::Room::kClose:
      return Tone::kWarning;
    case Margin::Room::kGone:
      break;
  }
  return Tone::kBad;
}

Lines head_block(const View& view) {
  Lines lines = mode_lines(view);
  lines.push_back(clock_line(view));
  lines.push_back(margins_line(view));
  return lines;
}

}  // namespace gyrotwin
