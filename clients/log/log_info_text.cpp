#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>

#include "clients/common/run_name.hpp"
#include "clients/log/log_info.hpp"

namespace gyrotwin {

namespace {

using Json = nlohmann::ordered_json;

/// "2026-11-22 23:39:00.123 UTC"
std::string date_text(std::int64_t time_us) {
  const std::time_t seconds = time_us / 1'000'000;
  std::tm utc{};
  if (::gmtime_r(&seconds, &utc) == nullptr) return "an unknown time";
  char text[64];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &utc);
  return fmt::format("{}.{:03} UTC", text, std::abs(time_us / 1000 % 1000));
}

std::string list(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string channel_lines(const LogInfo& info) {
  std::size_t width = 7;
  for (const auto& [name, channel] : info.channels) width = std::max(width, name.size());
  std::string text = fmt::format("\n{:<{}}  {:>9} {:>9} {:>7} {:>7} {:>9}  type\n", "channel",
                                 width, "messages", "rate/s", "gaps", "repeats", "reordered");
  for (const auto& [name, c] : info.channels) {
    text += fmt::format("{:<{}}  {:>9} {:>9.1f} {:>7} {:>7} {:>9}  {}\n", name, width, c.messages,
                        c.rate_hz(), c.gaps, c.repeats, c.reordered,
                        c.type.empty() ? "unknown" : c.type);
  }
  return text;
}

std::string run_lines(const RunInfo& run) {
  std::string text =
      fmt::format("\nrun {}: {:.3f} to {:.3f} s, ticks {} to {}, {}\n", run_name(run.epoch),
                  run.first_s, run.last_s, run.first_tick, run.last_tick,
                  run.modes.empty() ? "no mode seen" : list(run.modes));
  for (const RequestInfo& request : run.requests) {
    text += fmt::format("{:>12.3f} s  {}: {}", request.seconds, request.verb, request.result);
    if (request.result == "APPLIED") text += fmt::format(" at tick {}", request.tick);
    text += (request.text.empty() ? "" : ", ") + request.text + "\n";
  }
  return text;
}

Json run_json(const RunInfo& run) {
  Json requests = Json::array();
  for (const RequestInfo& r : run.requests) {
    requests.push_back({{"seconds", r.seconds},
                        {"verb", r.verb},
                        {"result", r.result},
                        {"tick", r.tick},
                        {"text", r.text}});
  }
  return {{"epoch", std::to_string(run.epoch)},
          {"from_s", run.first_s},
          {"to_s", run.last_s},
          {"first_tick", run.first_tick},
          {"last_tick", run.last_tick},
          {"modes", run.modes},
          {"requests", requests}};
}

Json damage_json(const Log& log) {
  const Damage& d = log.damage();
  return {{"bytes_lost", d.bytes_lost},
          {"events_lost", d.events_lost},
          {"wrong_shape", d.wrong_shape},
          {"wrong_signature", d.wrong_signature},
          {"times_repaired", d.times_repaired},
          {"signatures_checked", log.catalog().checks_signatures()}};
}

}  // namespace

std::string info_text(const std::string& file, const Log& log, const LogInfo& info) {
  std::string text =
      fmt::format("{}: {:.3f} MB, {} messages, {:.3f} s", file,
                  1e-6 * static_cast<double>(log.size()), info.messages, info.duration_s());
  if (info.messages > 0) text += " from " + date_text(info.first_us);
  text += '\n';
  if (const auto& about = log.catalog().about()) {
    text += fmt::format(
        "rig {} (prefix {}, id {}), part {}, recorded by {} on {}; its rig file: `gyrotwin log cat "
        "--channel log/rig {}`\n",
        about->rig, about->prefix, about->rig_id, about->part, about->program, about->host, file);
    const bool checked = log.catalog().checks_signatures();
    text += fmt::format("signatures: {}\n",
                        about->key.empty() ? "none on this rig"
                        : checked          ? "checked with key " + about->key
                                           : "not checked: key " + about->key + " is not here");
  } else {
    text +=
        "no opening events: not recorded by gyrotwin, or its start is lost; types of this "
        "program\n";
  }
  text += "damage: " + log.damage_text() + "\n" + channel_lines(info);
  for (const RunInfo& run : info.runs) text += run_lines(run);
  return text;
}

std::string info_json(const std::string& file, const Log& log, const LogInfo& info) {
  Json channels = Json::object();
  for (const auto& [name, c] : info.channels) {
    channels[name] = {{"type", c.type.empty() ? Json(nullptr) : Json(c.type)},
                      {"messages", c.messages},
                      {"bytes", c.bytes},
                      {"rate_hz", c.rate_hz()},
                      {"gaps", c.gaps},
                      {"repeats", c.repeats},
                      {"reordered", c.reordered}};
  }
  Json runs = Json::array();
  for (const RunInfo& run : info.runs) runs.push_back(run_json(run));
  Json json{{"file", file},
            {"bytes", log.size()},
            {"messages", info.messages},
            {"first_us", info.first_us},
            {"duration_s", info.duration_s()},
            {"recorded", nullptr},
            {"damage", damage_json(log)},
            {"channels", channels},
            {"runs", runs}};
  if (const auto& about = log.catalog().about()) {
    json["recorded"] = {{"program", about->program}, {"host", about->host},
                        {"part", about->part},       {"rig", about->rig},
                        {"prefix", about->prefix},   {"rig_id", about->rig_id},
                        {"key", about->key}};
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gyrotwin
