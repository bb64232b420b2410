// The parts of the screen, each some lines about one thing. Lines are as wide as they need to be;
// the screen cuts them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "clients/common/wrap.hpp"
#include "clients/top/line.hpp"
#include "clients/top/margins.hpp"
#include "clients/top/picture.hpp"
#include "clients/top/rig_facts.hpp"

namespace gyrotwin {

/// What is drawn, how, and how wide bars and headings may be.
struct View {
  const Picture& picture;
  const RigFacts& facts;
  Glyphs glyphs;
  std::size_t columns;
};

enum class Detail { kShort, kFull };

/// Which rig, the owner's mode and why, its clock, the margins in words.
Lines head_block(const View& view);
/// Tilt, disc, gyros, drives, contacts; what was not heard lately is marked.
Lines state_block(const View& view, Detail detail);
/// What the twin says: whether rig and model agree, and what comes next; empty when none was heard.
Lines twin_block(const View& view);
/// Disturbances and faults, `most` by name; empty when nothing acts.
Lines acting_block(const View& view, std::size_t most);
/// Who is alive, and how their loops do.
Lines peers_block(const View& view, Detail detail);
/// Messages a second and what was lost, channel by channel.
Lines traffic_block(const View& view, Detail detail);
/// What happened, newest last.
/// @param after number of the last happening that is left out
Lines happenings_block(const View& view, std::int64_t after = 0);

Tone tone_of(Margin::Room room);

/// "-- state ------": texts at columns, a rule between and behind them.
struct Heading {
  std::size_t column;
  std::string text;
};
Line rule(const View& view, const std::vector<Heading>& headings);

/// "0.1 s ago".
std::string ago(std::int64_t age_ns);

}  // namespace gyrotwin
