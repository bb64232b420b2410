// Who is alive, what the bus carries, and what happened.
#include <algorithm>
#include <string>

#include "clients/common/status_words.hpp"
#include "clients/top/blocks.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kMode = 12;  // column behind the name of a peer

/// "70u", "1.2m", "12s".
std::string brief(std::int64_t ns) {
  const double value = static_cast<double>(ns);
  if (ns < 1'000'000) return fmt::format("{:.0f}u", 1e-3 * value);
  if (ns < 10'000'000) return fmt::format("{:.1f}m", 1e-6 * value);
  if (ns < 1'000'000'000) return fmt::format("{:.0f}m", 1e-6 * value);
  return fmt::format("{:.0f}s", 1e-9 * value);
}

std::string brief(std::int64_t p50, std::int64_t p99, std::int64_t max) {
  return fmt::format("{}/{}/{}", brief(p50), brief(p99), brief(max));
}

/// Name, and mode of one who is heard, or what to do; for the owner the head says it.
Line peer_line(const View& view, std::string_view name, std::string_view program,
               const Peer& peer) {
  Line line;
  line.put(name).tab(kMode);
  if (!peer) {
    line.put("NOT HEARD", Tone::kBad);
    if (program.empty()) return line;
    return line.put(
        fmt::format("  start it with `gyrotwin {} --rig {}`", program, view.facts.name));
  }
  if (peer->live()) return line.put(mode_name(peer->message.mode), Tone::kGood);
  return line.put("NOT HEARD", Tone::kBad)
      .put(fmt::format("  for {:.1f} s; was {}, {}", 1e-9 * static_cast<double>(peer->age_ns),
                       process_text(peer->message), mode_name(peer->message.mode)));
}

bool live(const Peer& peer) { return peer && peer->live(); }

/// Of a real plant to its device: connected, or why not.
Line line_line(const Heard<link_t>& heard) {
  const link_t& link = heard.message;
  Line line;
  line.put("line").tab(kMode);
  if (!heard.live()) {
    return line.put("NOT HEARD", Tone::kBad).put("  last " + ago(heard.age_ns));
  }
  if (link.connected != 0) return line;
  return line.put("NOT CONNECTED", Tone::kBad).put("  " + get_text(link.text));
}

bool connected(const Heard<link_t>& heard) { return heard.live() && heard.message.connected != 0; }

Line line_short(const Heard<link_t>& heard) {
  const link_t& link = heard.message;
  Line line = line_line(heard);
  if (!connected(heard)) return line;
  line.put(fmt::format("round trip {}/{}", brief(link.round_trip_p50_ns),
                       brief(link.round_trip_max_ns)));
  line.put(fmt::format("  clock {:+.1f} s", 1e-9 * static_cast<double>(link.clock_offset_ns)));
  const std::int64_t to_device = link.device_bad + link.host_dropped;
  line.put(fmt::format("  lost {} in, {} out", link.samples_missed, to_device),
           link.samples_missed + to_device != 0 ? Tone::kWarning : Tone::kPlain);
  if (link.reconnects != 0) line.put(fmt::format("  reopened {}", link.reconnects), Tone::kWarning);
  return line;
}

Lines peers_short(const View& view) {
  constexpr std::size_t kProcess = 22, kHeard = 41, kLate = 47, kComputes = 64;
  const Picture& picture = view.picture;
  Lines lines{rule(view, {{0, "who"},
                          {kProcess, "process"},
                          {kHeard, "age"},
                          {kLate, "late p50/p99/max"},
                          {kComputes, "computes"}})};
  const auto row = [&](std::string_view name, std::string_view program, const Peer& peer,
                       bool paced) {
    Line& line = lines.emplace_back(peer_line(view, name, program, peer));
    if (!live(peer)) return;
    const status_t& s = peer->message;
    line.tab(kProcess).put(process_text(s).substr(0, kHeard - kProcess - 1));
    line.tab(kHeard).put(fmt::format("{:.1f}s", 1e-9 * static_cast<double>(peer->age_ns)));
    line.tab(kLate);
    if (paced) line.put(brief(s.lateness_p50_ns, s.lateness_p99_ns, s.lateness_max_ns));
    line.tab(kComputes).put(brief(s.compute_p50_ns, s.compute_p99_ns, s.compute_max_ns));
  };
  row("owner", "", picture.owner, true);
  row("controller", "controller", picture.controller, false);
  if (picture.mirror) row("mirror", "mirror", picture.mirror, false);
  if (picture.link) lines.push_back(line_short(*picture.link));
  return lines;
}

void detail(const View& view, Lines& lines, std::string_view label, const std::string& text,
            Tone tone = Tone::kPlain) {
  Line line;
  line.put("  ").put(label, Tone::kFaint);
  for (const std::string& part : wrap(text, std::max(view.columns, 2 * kMode) - kMode)) {
    lines.push_back(line.tab(kMode).put(part, tone));
    line = Line();
  }
}

/// "70u/1.2m/12m (p50/p99/max)".
std::string legend(std::int64_t p50, std::int64_t p99, std::int64_t max) {
  return brief(p50, p99, max) + " (p50/p99/max)";
}

void process_details(const View& view, const Heard<status_t>& peer, Lines& lines) {
  const status_t& s = peer.message;
  const std::string why = get_text(s.text);
  if (!why.empty()) detail(view, lines, "why", why);
  detail(view, lines, "process", fmt::format("{}, heard {}", process_text(s), ago(peer.age_ns)));
  detail(view, lines, "computes", legend(s.compute_p50_ns, s.compute_p99_ns, s.compute_max_ns));
}

void line_details(const View& view, const Heard<link_t>& heard, Lines& lines) {
  const link_t& link = heard.message;
  lines.push_back(line_line(heard));
  if (!connected(heard)) return;
  lines.back().put("CONNECTED", Tone::kGood).put("  " + get_text(link.text));
  detail(view, lines, "device", std::string(mode_name(link.device_mode)));
  detail(view, lines, "round trip",
         brief(link.round_trip_p50_ns) + "/" + brief(link.round_trip_max_ns) + " (p50/max)");
  detail(view, lines, "clock", clock_text(link));
  const std::string lost = line_losses_text(link);
  detail(view, lines, "lost", lost, lost == "nothing" ? Tone::kPlain : Tone::kWarning);
}

Lines peers_full(const View& view) {
  const auto& [owner, controller] = std::tie(view.picture.owner, view.picture.controller);
  Lines lines{rule(view, {{0, "who"}})};
  lines.push_back(peer_line(view, "owner", "", owner));
  if (live(owner)) {
    const status_t& s = owner->message;
    process_details(view, *owner, lines);
    detail(view, lines, "late", legend(s.lateness_p50_ns, s.lateness_p99_ns, s.lateness_max_ns));
    detail(view, lines, "overruns", overruns_text(s),
           s.overruns != 0 ? Tone::kWarning : Tone::kPlain);
    const auto said = controller ? std::optional(controller->message) : std::nullopt;
    detail(view, lines, "lease", "held by " + lease_holder(s, said, view.picture.command));
    detail(view, lines, "refused", refusals_text(s));
  }
  lines.push_back(peer_line(view, "controller", "controller", controller));
  if (live(controller)) process_details(view, *controller, lines);
  const Peer& mirror = view.picture.mirror;
  if (mirror) lines.push_back(peer_line(view, "mirror", "mirror", mirror));
  if (live(mirror)) process_details(view, *mirror, lines);
  if (view.picture.link) line_details(view, *view.picture.link, lines);
  return lines;
}

/// "STATE" of LIVE/STATE.
std::string_view plain_name(Channel channel) {
  const std::string_view suffix = spec(channel).suffix;
  return suffix.substr(suffix.find('/') + 1);
}

std::int64_t lost_here(const Picture& picture) {
  std::int64_t lost = 0;
  for (const ChannelTraffic& channel : picture.channels) lost += channel.gaps;
  return lost;
}

/// What this listener did not take.
std::string dropped_here(const BusCounters& bus) {
  return counts_text({{bus.kernel_dropped, "lost to a full buffer"},
                      {bus.malformed, "malformed"},
                      {bus.unauthentic, "without the right signature"},
                      {bus.other_rig, "of other rigs"},
                      {bus.foreign, "on foreign channels"}},
                     "");
}

Tone tone_of_loss(std::int64_t lost) { return lost != 0 ? Tone::kWarning : Tone::kPlain; }

Lines traffic_short(const View& view) {
  Lines lines(2);
  Line &rates = lines[0], &lost = lines[1];
  const auto per_second = [&view](Channel channel) {
    return view.picture.channels[static_cast<std::size_t>(channel)].per_second;
  };
  rates.put("per second");
  for (const Channel channel :
       {Channel::kState, Channel::kCommand, Channel::kTruth, Channel::kSensors}) {
    rates.put(fmt::format("  {} {:.0f}", plain_name(channel), per_second(channel)));
  }
  rates.put(
      fmt::format("  STATUS {:.0f}+{:.0f}",
                  per_second(Channel::kIntegratorStatus) + per_second(Channel::kHardwareStatus),
                  per_second(Channel::kControllerStatus)));
  lost.put("never came");
  const auto count = [&lost](std::string_view who, std::int64_t gaps) {
    lost.put(fmt::format("  {} {}", who, gaps), tone_of_loss(gaps));
  };
  count("here", lost_here(view.picture));
  if (view.picture.owner) count("owner", sum(view.picture.owner->message.gaps));
  if (view.picture.controller) count("controller", sum(view.picture.controller->message.gaps));
  if (view.picture.owner) {
    const std::int64_t overruns = view.picture.owner->message.overruns;
    lost.put(fmt::format("   overruns {}", overruns), tone_of_loss(overruns));
  }
  const std::string dropped = dropped_here(view.picture.bus);
  if (!dropped.empty()) lost.put("   " + dropped, Tone::kWarning);
  return lines;
}

Lines traffic_full(const View& view) {
  constexpr std::size_t kRate = 18, kHere = 24, kOwner = 34, kController = 40, kAge = 46,
                        kAgeWidth = 6;
  const bool roomy = view.columns >= kAge + kAgeWidth;
  std::vector<Heading> headings{
      {0, "bus"}, {kRate, "per s"}, {kHere, "lost here"}, {kOwner, "owner"}, {kController, "ctrl"}};
  if (roomy) headings.push_back({kAge, "  age"});
  Lines lines{rule(view, headings)};
  for (const ChannelSpec& row : kChannels) {
    const auto i = static_cast<std::size_t>(row.channel);
    const ChannelTraffic& heard = view.picture.channels[i];
    Line& line = lines.emplace_back();
    line.put(row.suffix).tab(kRate).put(fmt::format("{:5.0f}", heard.per_second));
    line.tab(kHere).put(fmt::format("{:9}", heard.gaps), tone_of_loss(heard.gaps));
    const auto told = [&](const Peer& peer, std::size_t column, std::size_t width) {
      // Who does not listen to a channel has lost nothing on it.
      const bool listens = peer && peer->message.received[i] > 0;
      const std::int64_t gaps = listens ? peer->message.gaps[i] : 0;
      const std::string text = listens ? std::to_string(gaps) : "-";
      line.tab(column).put(fmt::format("{:>{}}", text, width), tone_of_loss(gaps));
    };
    told(view.picture.owner, kOwner, 5);
    told(view.picture.controller, kController, 4);
    if (roomy && heard.age_ns) line.tab(kAge).put(fmt::format("{:>5}", brief(*heard.age_ns)));
  }
  const std::string dropped = dropped_here(view.picture.bus);
  if (!dropped.empty()) detail(view, lines, "dropped", dropped, Tone::kWarning);
  return lines;
}

}  // namespace

Lines peers_block(const View& view, Detail detail) {
  return detail == Detail::kShort ? peers_short(view) : peers_full(view);
}

Lines traffic_block(const View& view, Detail detail) {
  return detail == Detail::kShort ? traffic_short(view) : traffic_full(view);
}

}  // namespace gyrotwin
