#include <nlohmann/json.hpp>

#include "clients/netcheck/report.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin::netcheck {
namespace {

using Json = nlohmann::ordered_json;

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

Json host_json(const HostFacts& f, const std::string& address) {
  return {{"host", get_text(f.host)},
          {"address", address},
          {"interface", get_text(f.interface)},
          {"mtu", f.mtu},
          {"ttl", f.ttl},
          {"receive_buffer_wanted", f.buffer_wanted},
          {"receive_buffer_granted", f.buffer_granted},
          {"realtime_priority", f.priority_error == 0},
          {"locked_memory", f.memory_error == 0},
          {"clock_synchronised", f.clock_synchronised != 0},
          {"clock_max_error_s", seconds(f.clock_max_error_ns)},
          {"saves_power", f.saves_power != 0},
          {"wireless", f.wireless != 0}};
}

Json way_json(const std::optional<Way>& way) {
  if (!way) return nullptr;
  return {{"sent", way->sent},
          {"lost", way->lost},
          {"overtaken", way->late},
          {"repeats", way->repeats},
          {"kernel_dropped", way->kernel_dropped},
          {"ttl_sent", way->ttl_sent},
          {"ttl_arrived_min", way->ttl_min},
          {"ttl_arrived_max", way->ttl_max}};
}

Json spread_json(const Spread& s) {
  return {{"p50", seconds(s.p50)},
          {"p99", seconds(s.p99)},
          {"p99_9", seconds(s.p999)},
          {"max", seconds(s.max)}};
}

Json fit_json(const Fit& fit, int timeout_ticks) {
  Json json{
      {"rate_hz", fit.rate_hz},       {"good", fit.good()},   {"budget_s", seconds(fit.budget_ns)},
      {"unanswered", fit.unanswered}, {"missed", fit.missed}, {"age_ticks", fit.age_ticks}};
  json["limit"] = fit.good() ? Json(nullptr) : Json(limit_text(fit, timeout_ticks));
  return json;
}

Json part_json(Part part) {
  switch (part) {
    case Part::kNone:
      break;
    case Part::kWakeHere:
      return "wake_here";
    case Part::kNetwork:
      return "network";
    case Part::kWakeThere:
      return "wake_there";
  }
  return nullptr;
}

Json line_json(const Netcheck& check, const CheckedLine& line) {
  const Figures& f = line.figures;
  const int timeout = check.rig.safety.command_timeout_ticks;
  Json rates = Json::array();
  for (const Fit& fit : line.verdict.rates) rates.push_back(fit_json(fit, timeout));
  return {{"there", host_json(line.peer.facts, line.peer.address)},
          {"measured_hz", line.rate_hz},
          {"ticks", f.ticks},
          {"slept_through", f.missed},
          {"unanswered", f.unanswered},
          {"over_rate", line.over_rate},
          {"unauthentic_there", line.unauthentic},
          {"came_in_on", line.came_in_on},
          {"out", way_json(f.out)},
          {"back", way_json(f.back)},
          {"wake_here_s", spread_json(f.wake_here)},
          {"network_s", spread_json(f.network)},
          {"jitter_s", spread_json(f.jitter)},
          {"wake_there_s", spread_json(f.wake_there)},
          {"response_s", spread_json(f.response)},
          {"clock_offset_s", seconds(f.clock_offset)},
          {"clock_uncertainty_s", seconds(f.clock_uncertainty)},
          {"clock_step_s", seconds(line.clock_step_ns)},
          {"good", line.verdict.rig.good()},
          {"good_for_hz", line.verdict.good_for_hz},
          {"slowest", part_json(line.verdict.slowest)},
          {"rates", rates}};
}

}  // namespace

std::string report_json(const Netcheck& check) {
  const ProbeCounters& c = check.counters;
  Json json{{"rig", check.rig.name},
            {"rate_hz", check.rig.loop.rate_hz},
            {"command_timeout_ticks", check.rig.safety.command_timeout_ticks},
            {"group", check.rig.network.group},
            {"port", check.port},
            {"signed", check.rig.network.sign},
            {"alone", check.alone},
            {"complete", check.complete()},
            {"good", check.good()}};
  json["broken"] = check.broken.empty() ? Json(nullptr) : Json(check.broken);
  json["here"] = host_json(check.here, check.address);
  json["counters"] = {{"malformed", c.malformed},           {"foreign", c.foreign},
                      {"other_rig", c.other_rig},           {"unauthentic", c.unauthentic},
                      {"kernel_dropped", c.kernel_dropped}, {"send_failed", c.send_failed}};
  json["lines"] = Json::array();
  for (const CheckedLine& line : check.lines) json["lines"].push_back(line_json(check, line));
  json["advice"] = Json::array();
  for (const Advice& a : advice(check)) {
    json["advice"].push_back({{"text", a.text}, {"commands", a.commands}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gyrotwin::netcheck
