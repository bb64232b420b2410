#include <algorithm>
#include <cmath>
#include <string>

#include "clients/common/tilt.hpp"
#include "clients/top/blocks.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kLabels = 20;                   // columns of marks and labels
constexpr std::size_t kNarrowest = 14, kWidest = 20;  // columns of one gyro
constexpr std::size_t kLongestBar = 61;
constexpr double kPercent = 100.0;

/// What a margin looks like where there are no colours.
std::string_view mark_of(Margin::Room room) {
  switch (room) {
    case Margin::Room::kFine:
      return "";
    case Margin::Room::kClose:
      return "!";
    case Margin::Room::kGone:
      break;
  }
  return "!!";
}

/// Rows of what one message tells: live, or marked as old.
class Rows {
 public:
  Rows(const View& view, bool live) : view_(view), live_(live) {}

  Tone tone(Tone live = Tone::kPlain) const { return live_ ? live : Tone::kFaint; }

  Line& row(Lines& lines, std::string_view label) const {
    Line& line = lines.emplace_back();
    line.put(live_ ? "  " : "? ", live_ ? Tone::kPlain : Tone::kWarning).put(label, tone());
    return line.tab(kLabels);
  }

  /// A bar with a sign from the middle of it.
  void bar(Line& line, double value, double limit) const {
    const std::size_t taken = line.width() + 4;  // with brackets and middle
    const std::size_t columns = std::max(view_.columns, taken) - taken;
    const std::size_t half = std::min(columns, kLongestBar) / 2;
    if (half < 5 || !(limit > 0.0)) return;
    const Glyphs& glyphs = view_.glyphs;
    const double share = std::clamp(value / limit, -1.0, 1.0);
    // nan draws nothing.
    const auto filled = static_cast<std::size_t>(
        std::abs(std::isnan(share) ? 0.0 : std::round(share * static_cast<double>(half))));
    const char32_t full = live_ ? glyphs.full() : glyphs.stale();
    const Tone bar_tone = tone(std::abs(value) >= limit        ? Tone::kBad
                               : std::abs(value) > 0.5 * limit ? Tone::kWarning
                                                               : Tone::kGood);
    const std::size_t left = value < 0.0 ? filled : 0, right = value < 0.0 ? 0 : filled;
    line.put(" [");
    line.put(glyphs.empty(), half - left, Tone::kFaint).put(full, left, bar_tone);
    line.put(glyphs.middle(), 1, tone());
    line.put(full, right, bar_tone).put(glyphs.empty(), half - right, Tone::kFaint);
    line.put("]");
  }

 private:
  const View& view_;
  bool live_;
};

void tilt_rows(const View& view, const Rows& rows, const state_t& state, Lines& lines) {
  if ((state.valid & state_t::VALID_TILT) != 0) {
    constexpr std::string_view kNames[] = {"tilt x, roll", "tilt y, pitch"};
    for (std::size_t i = 0; i < 2; ++i) {
      Line& line = rows.row(lines, kNames[i]);
      line.put(fmt::format("{:+8.3f} deg {:+8.2f} deg/s", degrees(state.tilt_rad[i]),
                           degrees(state.tilt_rate_rad_s[i])),
               rows.tone());
      rows.bar(line, state.tilt_rad[i], view.facts.fall_tilt);
    }
  }
  if ((state.valid & state_t::VALID_DISC) != 0) {
    Line& line = rows.row(lines, "disc");
    line.put(
        fmt::format("{:+8.3f} rad/s, at {:+.2f} rad", state.disc_rate_rad_s, state.disc_angle_rad),
        rows.tone());
    if ((state.valid & state_t::VALID_DISC_TILT) != 0) {
      line.put(fmt::format(", tilt {:+.2f} {:+.2f} deg", degrees(state.disc_tilt_rad[0]),
                           degrees(state.disc_tilt_rad[1])),
               rows.tone());
    }
  }
}

/// Gyros and drives side by side, one row a quantity.
class Table {
 public:
  Table(const View& view, Lines& lines)
      : width_(std::clamp((std::max(view.columns, kLabels) - kLabels) / 4, kNarrowest, kWidest)),
        lines_(lines) {}

  /// @param text of entry i @param tone of entry i
  template <class Text, class ToneOf>
  void row(const Rows& rows, std::string_view label, int entries, Text&& text, ToneOf&& tone) {
    if (entries == 0) return;
    Line& line = rows.row(lines_, label);
    for (int i = 0; i < entries; ++i) {
      const auto k = static_cast<std::size_t>(i);
      line.put(text(k), rows.tone(tone(k)));
      if (i + 1 < entries) line.tab(kLabels + (k + 1) * width_);
    }
  }

 private:
  std::size_t width_;
  Lines& lines_;
};

template <class Entries>
auto tones_of(const Entries& entries) {
  return [&entries](std::size_t i) {
    return entries[i] && entries[i]->room != Margin::Room::kFine ? tone_of(entries[i]->room)
                                                                 : Tone::kPlain;
  };
}

void gyro_rows(const View& view, Detail detail, const Rows& rows, const state_t& state,
               Lines& lines) {
  const Margins margins = margins_of(view.picture, view.facts);
  const int gyros = view.facts.gyros;
  Table table(view, lines);
  const auto number = [](std::size_t i) { return fmt::format("{:6}", i); };
  const auto faint = [](std::size_t) { return Tone::kFaint; };
  if (detail == Detail::kFull) {
    table.row(rows, "gyro, drive", std::max(gyros, view.facts.drives), number, faint);
  }
  if ((state.valid & state_t::VALID_GIMBALS) != 0) {
    const auto text = [&](std::size_t j) {
      const auto& margin = margins.gimbal[j];
      const std::string left =
          margin ? fmt::format(" ({:.1f}){}", degrees(margin->left), mark_of(margin->room)) : "";
      return fmt::format("{:+5.1f}{}", degrees(state.gimbal_angle_rad[j]), left);
    };
    table.row(rows, "gimbal deg (left)", gyros, text, tones_of(margins.gimbal));
  }
  if ((state.valid & state_t::VALID_ROTORS) != 0) {
    const auto share = [&](std::size_t j) {
      return state.rotor_speed_rad_s[j] / view.facts.nominal_rotor_speed[j];
    };
    const auto text = [&](std::size_t j) {
      const std::string of_nominal =
          std::isfinite(share(j)) ? fmt::format(" ({:.0f}%)", kPercent * share(j)) : "";
      return fmt::format("{:6.1f}{}", state.rotor_speed_rad_s[j], of_nominal);
    };
    const auto slow = [&](std::size_t j) {
      return share(j) < 0.5 ? Tone::kBad : share(j) < 0.95 ? Tone::kWarning : Tone::kPlain;
    };
    table.row(rows, "rotor rad/s (nom)", gyros, text, slow);
  }
  if ((state.valid & state_t::VALID_DRIVES) != 0) {
    const auto text = [&](std::size_t i) {
      const auto& margin = margins.drive[i];
      const std::string left =
          margin ? fmt::format(" ({:.2f}){}", margin->left, mark_of(margin->room)) : "";
      const double torque = state.drive_torque_nm[i];
      return fmt::format("{:+6.{}f}{}", torque, std::abs(torque) < 100.0 ? 3 : 0, left);
    };
    table.row(rows, "drive N m (left)", view.facts.drives, text, tones_of(margins.drive));
  }
}

void truth_rows(const View& view, Detail detail, Lines& lines) {
  const auto& heard = view.picture.truth;
  if (!heard) return;
  const truth_t& truth = heard->message;
  const Rows rows(view, heard->live());
  const bool tracked = view.facts.lower_track || view.facts.upper_track;
  const auto contact = [&](std::size_t j) {
    const double lower = truth.contact_lower_n[j], upper = truth.contact_upper_n[j];
    if (lower == 0.0 && upper == 0.0) return std::string("lifted");
    return view.facts.upper_track ? fmt::format("{:6.2f} {:6.2f}", lower, upper)
                                  : fmt::format("{:6.2f}", lower);
  };
  const auto lifted = [&](std::size_t j) {
    return truth.contact_lower_n[j] == 0.0 && truth.contact_upper_n[j] == 0.0 ? Tone::kWarning
                                                                              : Tone::kPlain;
  };
  Table(view, lines)
      .row(rows, view.facts.upper_track ? "contact N low, up" : "contact N",
           tracked ? view.facts.gyros : 0, contact, lifted);
  if (view.facts.load_cell) {
    rows.row(lines, "load cell").put(fmt::format("{:8.3f} N", truth.load_cell_n), rows.tone());
  }
  if (detail == Detail::kShort) return;
  const auto& f = truth.external_force_n;
  const auto& m = truth.external_moment_nm;
  rows.row(lines, "pushed by")
      .put(fmt::format("moment {:+.2f} {:+.2f} {:+.2f} N m, force {:+.2f} {:+.2f} {:+.2f} N", m[0],
                       m[1], m[2], f[0], f[1], f[2]),
           rows.tone());
  rows.row(lines, "energy")
      .put(fmt::format("{:.3f} J kinetic, {:.3f} J potential", truth.kinetic_energy_j,
                       truth.potential_energy_j),
           rows.tone());
}

}  // namespace

Lines state_block(const View& view, Detail detail) {
  const auto& heard = view.picture.state;
  if (!heard) {
    return {rule(view, {{0, "state"}}), Line().put("  STATE was not heard yet", Tone::kFaint)};
  }
  std::string title =
      view.facts.is_estimate(heard->message) ? "state, as estimated on board" : "state";
  if (!heard->live()) title += ": STALE, heard " + ago(heard->age_ns) + ", marked ?";
  if ((heard->message.valid & state_t::VALID_TILT) != 0) {
    title += fmt::format(", bars to +-{:.1f} deg", degrees(view.facts.fall_tilt));
  }
  Lines lines{rule(view, {{0, title}})};
  const Rows rows(view, heard->live());
  tilt_rows(view, rows, heard->message, lines);
  gyro_rows(view, detail, rows, heard->message, lines);
  truth_rows(view, detail, lines);
  return lines;
}

}  // namespace gyrotwin
