#include "clients/top/screen.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ctime>
#include <iterator>

#include "clients/top/blocks.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kTwoColumns = 120;      // of a screen with state and bus side by side
constexpr std::size_t kTwoColumnRows = 16;    // below the head, or it is no use
constexpr std::size_t kStateColumns = 75;     // that state needs
constexpr std::size_t kBusColumns = 64;       // that who and bus can use
constexpr std::size_t kMostActing = 12;       // disturbances and faults that are named
constexpr std::size_t kPlainColumns = 100;    // of bars and rules where there is no screen
constexpr std::size_t kFewestHappenings = 5;  // rows, with their heading

void append(Lines& lines, Lines more) {
  std::move(more.begin(), more.end(), std::back_inserter(lines));
}

/// @param keys stand behind `right` where there is room
Line title(const View& view, std::string right, std::string_view keys = "") {
  Line line;
  line.put("gyrotwin top  " + view.facts.name, Tone::kTitle);
  line.put("  " + view.facts.reach, Tone::kFaint);
  if (line.width() + 2 + right.size() + keys.size() <= view.columns) right += keys;
  const std::size_t rest = view.columns - std::min(view.columns, right.size() + 2);
  if (line.width() > rest) line.fit(rest, view.glyphs.more());
  return line.tab(view.columns - std::min(view.columns, right.size())).put(right, Tone::kFaint);
}

std::string local_time(std::int64_t utc_ns) {
  const std::time_t seconds = utc_ns / 1'000'000'000;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  char text[32];
  std::strftime(text, sizeof text, "%F %T", &local);
  return text;
}

/// The last ones under their heading, in so many rows.
Lines happenings(const View& view, std::size_t rows) {
  if (rows < 2) return {};
  Lines all = happenings_block(view);
  const std::size_t left_out = all.size() - std::min(all.size(), rows - 1);
  Lines lines{rule(view, {{0, "what happened"}})};
  lines.insert(lines.end(), all.begin() + static_cast<std::ptrdiff_t>(left_out), all.end());
  return lines;
}

Lines stacked(const View& view, Detail detail, std::size_t most_acting) {
  Lines lines = state_block(view, detail);
  append(lines, twin_block(view));
  append(lines, acting_block(view, most_acting));
  append(lines, peers_block(view, detail));
  append(lines, traffic_block(view, detail));
  return lines;
}

Lines one_column(const View& view, std::size_t rows) {
  Lines lines = stacked(view, Detail::kFull, kMostActing);
  const auto fits = [&] { return lines.size() + kFewestHappenings <= rows; };
  for (std::size_t most = kMostActing; !fits() && most > 0; --most) {
    lines = stacked(view, Detail::kShort, most - 1);
  }
  append(lines, happenings(view, rows - std::min(rows, lines.size())));
  return lines;
}

Lines two_columns(const View& view, std::size_t rows) {
  View left = view, right = view;
  right.columns = std::min(view.columns - kStateColumns - 1, kBusColumns);
  left.columns = view.columns - right.columns - 1;

  Lines lines = state_block(left, Detail::kFull);
  append(lines, twin_block(left));
  append(lines, acting_block(left, kMostActing));
  append(lines, happenings(left, rows - std::min(rows, lines.size())));
  lines.resize(rows);

  Lines bus = peers_block(right, Detail::kFull);
  Lines traffic = traffic_block(right, Detail::kFull);
  const bool fits = bus.size() + traffic.size() <= rows;
  append(bus, fits ? std::move(traffic) : traffic_block(right, Detail::kShort));
  bus.resize(rows);

  for (std::size_t i = 0; i < rows; ++i) {
    lines[i].fit(left.columns, view.glyphs.more()).put(" ").put(bus[i]);
  }
  return lines;
}

}  // namespace

Lines screen(const Picture& picture, const RigFacts& facts, Size size, Glyphs glyphs) {
  const View view{picture, facts, glyphs, size.columns};
  const std::string time = local_time(picture.utc_ns).substr(11);
  Lines lines{title(view, time, "  q quits")};
  append(lines, head_block(view));
  const std::size_t rows = size.rows - std::min(size.rows, lines.size());
  const bool wide = size.columns >= kTwoColumns && rows >= kTwoColumnRows;
  append(lines, wide ? two_columns(view, rows) : one_column(view, rows));
  lines.resize(size.rows);
  for (Line& line : lines) line.fit(size.columns, glyphs.more());
  return lines;
}

std::string plain_text(const Picture& picture, const RigFacts& facts, Glyphs glyphs,
                       std::int64_t after) {
  const View view{picture, facts, glyphs, kPlainColumns};
  Lines lines{title(view, local_time(picture.utc_ns))};
  append(lines, head_block(view));
  append(lines, stacked(view, Detail::kShort, kMostActing));
  append(lines, happenings_block(view, after));
  std::string text;
  for (const Line& line : lines) text += text_of(line) + '\n';
  return text + '\n';
}

}  // namespace gyrotwin
