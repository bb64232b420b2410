#include "clients/ctl/report.hpp"

#include <algorithm>

#include "clients/common/status_words.hpp"
#include "clients/common/tilt.hpp"
#include "clients/common/time_text.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

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

std::string bus(const status_t& s) {
  const std::string bad = counts_text({{sum(s.gaps), "never came"},
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

/// "2.310 deg".
std::string tilt_text(const Sighting& sighting) {
  const std::optional<double> angle = tilt(sighting);
  return angle ? fmt::format("{:.3f} deg", degrees(*angle)) : "not told by STATE";
}

/// "at 100 % of their speed", or of each where they differ.
std::string rotors_text(const Sighting& sighting) {
  const std::vector<double> shares = rotor_shares(sighting);
  if (shares.empty()) return "not told by STATE";
  const auto [low, high] = std::ranges::minmax(shares);
  if (high - low < 0.005) return fmt::format("at {:.0f} % of their speed", 100.0 * low);
  std::string text = "at";
  for (const double share : shares) text += fmt::format(" {:.0f}", 100.0 * share);
  return text + " % of their speed";
}

/// A real plant's line to its device.
std::string link_text(const link_t& link) {
  const std::string device =
      link.connected != 0
          ? fmt::format("heard on {}, it is {}", get_text(link.text), mode_name(link.device_mode))
          : fmt::format("not heard on {}", get_text(link.text));
  return line("device", device) + line("its clock", clock_text(link)) +
         line("line", fmt::format("round trip p50 {}, max {}", time_text_ns(link.round_trip_p50_ns),
                                  time_text_ns(link.round_trip_max_ns))) +
         line("lost", line_losses_text(link));
}

/// "2 disturbances, 1 fault act or are to come".
std::string events_text(const status_t& s) {
  const int count = s.disturbances + s.faults;
  return counts_text({{s.disturbances, s.disturbances == 1 ? "disturbance" : "disturbances"},
                      {s.faults, s.faults == 1 ? "fault" : "faults"}},
                     "none") +
         (count == 0   ? ""
          : count == 1 ? " acts or is to come"
                       : " act or are to come");
}

std::string owner_text(const Sighting& sighting) {
  const status_t& s = *sighting.owner;
  const double rate = s.tick_period_ns > 0 ? 1e9 / static_cast<double>(s.tick_period_ns) : 0.0;
  std::string text = headline("owner", s);
  text += line("process", process_text(s));
  text += line("plant", plant_name(s));
  if (sighting.link) text += link_text(*sighting.link);
  text += line("clock",
               fmt::format("{}, {:g} Hz, speed {:g}", pace_name(s.clock), rate, s.speed_factor));
  text += line("tilt", tilt_text(sighting));
  text += line("rotors", rotors_text(sighting));
  text += line("events", events_text(s));
  text += line("late", distribution_text(s.lateness_p50_ns, s.lateness_p99_ns, s.lateness_max_ns));
  text += line("computes",
               distribution_text(s.compute_p50_ns, s.compute_p99_ns, s.compute_max_ns) +
                   fmt::format("; at most {} right-hand sides a tick", s.rhs_evaluations_max));
  text += line("overruns", overruns_text(s));
  text += line("lease", "held by " + lease_holder(sighting));
  text += line("refused", refusals_text(s));
  return text + line("bus", bus(s));
}

/// One that listens.
std::string listener_text(std::string_view peer, const status_t& s) {
  std::string text = headline(peer, s);
  text += line("process", process_text(s));
  text += line("computes", distribution_text(s.compute_p50_ns, s.compute_p99_ns, s.compute_max_ns));
  return text + line("bus", bus(s));
}

std::string not_heard(std::string_view peer, std::string_view program, const std::string& rig,
                      std::string_view or_else = "") {
  return fmt::format("{:<12}not heard; start it with `gyrotwin {} --rig {}`{}\n", peer, program,
                     rig, or_else);
}

}  // namespace

std::optional<double> tilt(const Sighting& sighting) {
  const auto& state = sighting.state;
  if (!state || (state->valid & state_t::VALID_TILT) == 0) return std::nullopt;
  return tilt_of(*state);
}

std::vector<double> rotor_shares(const Sighting& sighting) {
  const auto& state = sighting.state;
  std::vector<double> shares;
  if (!state || (state->valid & state_t::VALID_ROTORS) == 0) return shares;
  for (std::size_t j = 0; j < sighting.nominal_rotor_speed.size(); ++j) {
    shares.push_back(state->rotor_speed_rad_s[j] / sighting.nominal_rotor_speed[j]);
  }
  return shares;
}

std::string lease_holder(const Sighting& sighting) {
  return lease_holder(*sighting.owner, sighting.controller, sighting.command);
}

std::string report(const Sighting& sighting) {
  std::string text = fmt::format("rig {} on {}\n\n", sighting.rig, sighting.reach);
  text += sighting.owner
              ? owner_text(sighting)
              : not_heard("owner", "integrator", sighting.rig, ", or `gyrotwin hardware`");
  text += '\n';
  text += sighting.controller ? listener_text("controller", *sighting.controller)
                              : not_heard("controller", "controller", sighting.rig);
  if (sighting.mirror) text += '\n' + listener_text("mirror", *sighting.mirror);
  return text;
}

}  // namespace gyrotwin
