// What acts, what happened, and what all blocks draw with.
#include <algorithm>
#include <ctime>
#include <span>
#include <string>

#include "clients/top/blocks.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

Tone tone_of(Level level) {
  switch (level) {
    case Level::kGood:
      return Tone::kGood;
    case Level::kWarning:
      return Tone::kWarning;
    case Level::kBad:
      return Tone::kBad;
    case Level::kInfo:
      break;
  }
  return Tone::kPlain;
}

/// "21:14:03.1" where the user lives.
std::string time_of_day(std::int64_t utc_ns) {
  const std::time_t seconds = utc_ns / 1'000'000'000;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  return fmt::format("{:02}:{:02}:{:02}.{}", local.tm_hour, local.tm_min, local.tm_sec,
                     utc_ns / 100'000'000 % 10);
}

/// "acts, 1.2 s left", "from tick 5000".
std::string phase(const Acting& acting, const Picture& picture) {
  const std::int64_t tick = picture.latest ? picture.latest->tick : 0;
  if (acting.begin > tick) return fmt::format("from tick {}", acting.begin);
  if (!acting.end || !picture.owner) return "acts until cancelled";
  const double left = 1e-9 * static_cast<double>(*acting.end - tick) *
                      static_cast<double>(picture.owner->message.tick_period_ns);
  return fmt::format("acts, {:.2f} s left", left);
}

}  // namespace

Lines acting_block(const View& view, std::size_t most) {
  const Picture& picture = view.picture;
  if (!picture.owner_live()) return {};
  const status_t& owner = picture.owner->message;
  const std::int64_t told = std::int64_t{owner.disturbances} + owner.faults;
  if (told == 0) return {};
  Lines lines{rule(view, {{0, fmt::format("acting or to come: {} disturbance{}, {} fault{}",
                                          owner.disturbances, owner.disturbances == 1 ? "" : "s",
                                          owner.faults, owner.faults == 1 ? "" : "s")}})};
  for (const Acting& acting :
       std::span(picture.acting).first(std::min(most, picture.acting.size()))) {
    lines.emplace_back()
        .put(acting.fault ? "  fault  " : "  push   ", Tone::kWarning)
        .put(fmt::format("{}: {}; {}", acting.id, acting.what, phase(acting, picture)));
  }
  const std::int64_t unknown = told - static_cast<std::int64_t>(picture.acting.size());
  if (unknown > 0 && most > picture.acting.size()) {
    lines.emplace_back().put(fmt::format("  {} not heard being asked for", unknown), Tone::kFaint);
  }
  return lines;
}

Lines happenings_block(const View& view, std::int64_t after) {
  constexpr std::size_t kWho = 11, kWhat = 22, kNarrowest = 20;
  Lines lines;
  for (const Happening& happening : view.picture.happenings) {
    if (happening.number <= after) continue;
    const Tone tone = tone_of(happening.level);
    Line line;
    line.put(time_of_day(happening.utc_ns), Tone::kFaint).tab(kWho).put(happening.who);
    const std::size_t room = std::max(view.columns, kWhat + kNarrowest) - kWhat;
    for (const std::string& part : wrap(happening.what, room)) {
      lines.push_back(line.tab(kWhat).put(part, tone));
      line = Line();
    }
  }
  return lines;
}

Line rule(const View& view, const std::vector<Heading>& headings) {
  const Cell dash{view.glyphs.rule(), Tone::kFaint};
  Line line;
  for (const Heading& heading : headings) {
    if (line.width() < heading.column) line.fit(heading.column, dash.glyph, dash);
    line.put(heading.text, Tone::kTitle);
    if (line.width() < view.columns) line.put(" ");
  }
  if (line.width() < view.columns) line.fit(view.columns, dash.glyph, dash);
  return line;
}

std::string ago(std::int64_t age_ns) {
  return fmt::format("{:.1f} s ago", 1e-9 * static_cast<double>(age_ns));
}

}  // namespace gyrotwin
