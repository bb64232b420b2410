#include "clients/common/status_json.hpp"

#include "clients/common/status_words.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

Json distribution(std::int64_t p50, std::int64_t p99, std::int64_t max) {
  return {{"p50", p50}, {"p99", p99}, {"max", max}};
}

Json accepted(std::int64_t writer, std::int64_t counter) {
  if (writer == 0) return nullptr;
  return {{"writer", std::to_string(writer)}, {"counter", counter}};
}

Json bus(const status_t& s) {
  Json channels = Json::object();
  for (const ChannelSpec& row : kChannels) {
    const auto i = static_cast<std::size_t>(row.channel);
    channels[std::string(row.suffix)] = {{"sent", s.sent[i]},
                                         {"received", s.received[i]},
                                         {"gaps", s.gaps[i]},
                                         {"repeats", s.repeats[i]},
                                         {"reordered", s.reordered[i]}};
  }
  return {{"malformed", s.malformed},
          {"foreign", s.foreign},
          {"other_rig", s.other_rig},
          {"unauthentic", s.unauthentic},
          {"kernel_dropped", s.kernel_dropped},
          {"send_failed", s.send_failed},
          {"channels", channels}};
}

}  // namespace

Json daemon_json(const status_t& s) {
  return {{"mode", mode_name(s.mode)},
          {"text", get_text(s.text)},
          {"pid", s.pid},
          {"host", get_text(s.host)},
          {"epoch", std::to_string(s.header.epoch)},
          {"tick", s.header.tick},
          {"sim_time_ns", s.header.sim_time_ns},
          {"compute_ns", distribution(s.compute_p50_ns, s.compute_p99_ns, s.compute_max_ns)},
          {"bus", bus(s)}};
}

Json link_json(const link_t& l) {
  return {
      {"connected", l.connected != 0},
      {"text", get_text(l.text)},
      {"device_mode", l.device_mode < 0 ? Json(nullptr) : Json(mode_name(l.device_mode))},
      {"device_epoch", std::to_string(l.device_epoch)},
      {"round_trip_ns", {{"p50", l.round_trip_p50_ns}, {"max", l.round_trip_max_ns}}},
      {"clock_offset_ns", l.clock_offset_ns},
      {"clock_offset_sigma_ns", l.clock_offset_sigma_ns},
      {"clock_drift_ppm", l.clock_drift_ppm},
      {"reconnects", l.reconnects},
      {"host", {{"received", l.host_received}, {"bad", l.host_bad}, {"dropped", l.host_dropped}}},
      {"device",
       {{"received", l.device_received}, {"bad", l.device_bad}, {"dropped", l.device_dropped}}},
      {"samples_missed", l.samples_missed},
      {"commands_obeyed", l.commands_obeyed},
      {"safe_stops", l.safe_stops}};
}

Json owner_json(const status_t& s, const std::string& lease) {
  Json json = daemon_json(s);
  json["plant"] = plant_name(s);
  json["clock"] = pace_name(s.clock);
  json["speed_factor"] = s.speed_factor;
  json["tick_period_ns"] = s.tick_period_ns;
  json["disturbances"] = s.disturbances;
  json["faults"] = s.faults;
  json["lateness_ns"] = distribution(s.lateness_p50_ns, s.lateness_p99_ns, s.lateness_max_ns);
  json["overruns"] = s.overruns;
  json["skipped_ticks"] = s.skipped_ticks;
  json["rhs_evaluations_max"] = s.rhs_evaluations_max;
  json["lease"] = lease;
  json["last_command"] = accepted(s.command_writer, s.command_counter);
  json["last_request"] = accepted(s.request_writer, s.request_counter);
  json["refused"] = {{"not_finite", s.refused_not_finite},
                     {"epoch", s.refused_epoch},
                     {"expired", s.refused_expired},
                     {"counter", s.refused_counter},
                     {"writer", s.refused_writer}};
  return json;
}

}  // namespace gyrotwin
