#include "clients/ctl/report.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

/// "70 us", "1.25 ms", "2 s".
std::string time_text(std::int64_t ns) {
  const double value = static_cast<double>(ns);
  if (ns >= 1'000'000'000) return fmt::format("{:.3g} s", 1e-9 * value);
  if (ns >= 1'000'000) return fmt::format("{:.3g} ms", 1e-6 * value);
  return fmt::format("{:.3g} us", 1e-3 * value);
}

std::string distribution(std::int64_t p50, std::int64_t p99, std::int64_t max) {
  return fmt::format("p50 {}, p99 {}, max {}", time_text(p50), time_text(p99), time_text(max));
}

std::string line(std::string_view label, std::string_view text) {
  return fmt::format("  {:<10}{}\n", label, text);
}

/// "RUNNING at tick 5210, 5.21 s" and why.
std::string headline(std::string_view peer, const status_t& s) {
  const std::string why = get_text(s.text);
  return fmt::format("{:<12}{} at tick {}, {:.3f} s{}{}\n", peer, mode_name(s.mode), s.header.tick,
                     1e-9 * static_cast<double>(s.header.sim_time_ns), why.empty() ? "" : ": ",
                     why);
}

/// Counts that are not 0, "3 late, 1 lost", or `none`.
struct Count {
  std::int64_t count;
  std::string_view what;
};
std::string counts(std::initializer_list<Count> all, std::string_view none) {
  std::string text;
  for (const Count& c : all) {
    if (c.count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", c.count, c.what);
  }
  return text.empty() ? std::string(none) : text;
}

std::int64_t sum(const std::int64_t (&slots)[kChannelSlots]) {
  return std::accumulate(std::begin(slots), std::end(slots), std::int64_t{0});
}

std::string bus(const status_t& s) {
  const std::string bad = counts({{sum(s.gaps), "never came"},
                                  {sum(s.reordered), "came too late"},
                                  {s.kernel_dropped, "lost to a full buffer"},
                                  {s.send_failed, "not sent"},
                                  {s.malformed, "malformed"},
                                  {s.unauthentic, "without the right signature"},
                                  {s.other_rig, "of other rigs"},
                                  {s.foreign, "on foreign channels"}},
                                 "nothing lost or dropped");
  return fmt::format("{} sent, {} received; {}", sum(s.sent), sum(s.received), bad);
}

std::string process(const status_t& s) { return fmt::format("{} on {}", s.pid, get_text(s.host)); }

std::string owner_text(const Sighting& sighting) {
  const status_t& s = *sighting.owner;
  const double rate = s.tick_period_ns > 0 ? 1e9 / static_cast<double>(s.tick_period_ns) : 0.0;
  std::string text = headline("owner", s);
  text += line("process", process(s));
  text += line("clock",
               fmt::format("{}, {:g} Hz, speed {:g}", pace_name(s.clock), rate, s.speed_factor));
  text += line("late", distribution(s.lateness_p50_ns, s.lateness_p99_ns, s.lateness_max_ns));
  text += line("computes",
               distribution(s.compute_p50_ns, s.compute_p99_ns, s.compute_max_ns) +
                   fmt::format("; at most {} right-hand sides a tick", s.rhs_evaluations_max));
  text += line("overruns",
               counts({{s.overruns, "ticks too late"}, {s.skipped_ticks, "skipped"}}, "none"));
  text += line("lease", "held by " + lease_holder(sighting));
  text += line("refused", counts({{s.refused_not_finite, "not finite"},
                                  {s.refused_epoch, "for another run"},
                                  {s.refused_expired, "expired"},
                                  {s.refused_counter, "with a used counter"},
                                  {s.refused_writer, "without the lease"}},
                                 "no commands"));
  return text + line("bus", bus(s));
}

std::string controller_text(const status_t& s) {
  std::string text = headline("controller", s);
  text += line("process", process(s));
  text += line("computes", distribution(s.compute_p50_ns, s.compute_p99_ns, s.compute_max_ns));
  return text + line("bus", bus(s));
}

std::string not_heard(std::string_view peer, std::string_view program, const std::string& rig) {
  return fmt::format("{:<12}not heard; start it with `gyrotwin {} --rig {}`\n", peer, program, rig);
}

}  // namespace

std::string_view pace_name(std::int32_t clock) {
  switch (clock) {
    case status_t::PACE_REALTIME:
      return "realtime";
    case status_t::PACE_LOCKSTEP:
      return "lockstep";
    case status_t::PACE_FREE:
      return "free";
    default:
      return "unknown";
  }
}

std::string lease_holder(const Sighting& sighting) {
  const std::int64_t writer = sighting.owner->command_writer;
  if (writer == 0) return "nobody";
  const auto& command = sighting.command;
  const bool known = command && command->writer == writer && sighting.controller &&
                     command->header.epoch == sighting.controller->header.epoch;
  return known ? "the controller" : fmt::format("writer {}", writer);
}

std::string report(const Sighting& sighting) {
  std::string text = fmt::format("rig {} on {}\n\n", sighting.rig, sighting.reach);
  text += sighting.owner ? owner_text(sighting) : not_heard("owner", "integrator", sighting.rig);
  text += '\n';
  text += sighting.controller ? controller_text(*sighting.controller)
                              : not_heard("controller", "controller", sighting.rig);
  return text;
}

}  // namespace gyrotwin
