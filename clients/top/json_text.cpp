#include <cmath>
#include <ctime>
#include <iterator>
#include <vector>

#include "clients/common/status_json.hpp"
#include "clients/common/status_words.hpp"
#include "clients/top/margins.hpp"
#include "clients/top/screen.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

/// "2026-01-31T21:14:03.120Z".
std::string iso_time(std::int64_t utc_ns) {
  const std::time_t seconds = utc_ns / 1'000'000'000;
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%FT%T", &utc);
  return fmt::format("{}.{:03}Z", text, utc_ns / 1'000'000 % 1000);
}

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

Json peer_json(const Heard<status_t>& peer, Json said) {
  said["age_s"] = seconds(peer.age_ns);
  said["alive"] = peer.live();
  return said;
}

/// What every message of the owner's begins with.
template <class Message>
Json heard_json(const Heard<Message>& heard) {
  const header_t& header = heard.message.header;
  return {{"age_s", seconds(heard.age_ns)},
          {"stale", !heard.live()},
          {"epoch", std::to_string(header.epoch)},
          {"tick", header.tick},
          {"sim_time_ns", header.sim_time_ns}};
}

Json line_json(const Heard<link_t>& heard) {
  Json json = heard_json(heard);
  json.update(link_json(heard.message));
  return json;
}

/// The first `n` entries, null when they mean nothing.
template <std::size_t N>
Json some(const double (&values)[N], int n, bool valid) {
  if (!valid) return nullptr;
  return std::vector<double>(values, values + n);
}

Json state_json(const Heard<state_t>& heard, const RigFacts& facts) {
  const state_t& s = heard.message;
  const auto valid = [&s](std::int32_t group) { return (s.valid & group) != 0; };
  const bool tilt = valid(state_t::VALID_TILT), disc_tilt = valid(state_t::VALID_DISC_TILT);
  const bool disc = valid(state_t::VALID_DISC), gimbals = valid(state_t::VALID_GIMBALS);
  Json json = heard_json(heard);
  json["mode"] = mode_name(s.mode);
  json["estimated"] = facts.is_estimate(s);
  json["tilt_rad"] = some(s.tilt_rad, 2, tilt);
  json["tilt_rate_rad_s"] = some(s.tilt_rate_rad_s, 2, tilt);
  json["disc_tilt_rad"] = some(s.disc_tilt_rad, 2, disc_tilt);
  json["disc_tilt_rate_rad_s"] = some(s.disc_tilt_rate_rad_s, 2, disc_tilt);
  json["disc_angle_rad"] = disc ? Json(s.disc_angle_rad) : Json(nullptr);
  json["disc_rate_rad_s"] = disc ? Json(s.disc_rate_rad_s) : Json(nullptr);
  json["gimbal_angle_rad"] = some(s.gimbal_angle_rad, facts.gyros, gimbals);
  json["gimbal_rate_rad_s"] = some(s.gimbal_rate_rad_s, facts.gyros, gimbals);
  json["rotor_speed_rad_s"] = some(s.rotor_speed_rad_s, facts.gyros, valid(state_t::VALID_ROTORS));
  json["drive_torque_nm"] = some(s.drive_torque_nm, facts.drives, valid(state_t::VALID_DRIVES));
  return json;
}

Json truth_json(const Heard<truth_t>& heard, const RigFacts& facts) {
  const truth_t& t = heard.message;
  Json json = heard_json(heard);
  json["contact_lower_n"] = some(t.contact_lower_n, facts.gyros, facts.lower_track);
  json["contact_upper_n"] = some(t.contact_upper_n, facts.gyros, facts.upper_track);
  json["load_cell_n"] = facts.load_cell ? Json(t.load_cell_n) : Json(nullptr);
  json["external_force_n"] = t.external_force_n;
  json["external_moment_nm"] = t.external_moment_nm;
  json["kinetic_energy_j"] = t.kinetic_energy_j;
  json["potential_energy_j"] = t.potential_energy_j;
  return json;
}

/// What the twin says, null where it has said nothing.
Json twin_json(const Picture& picture) {
  Json json = {{"health", nullptr}, {"forecast", nullptr}};
  if (picture.health) {
    const health_t& h = picture.health->message;
    json["health"] = heard_json(*picture.health);
    json["health"]["verdict"] = h.verdict;
    json["health"]["blame"] = h.blame;
    json["health"]["text"] = get_text(h.text);
    json["health"]["nis_total"] = h.nis_total;
    json["health"]["external_moment_nm"] = h.external_moment_nm;
  }
  if (picture.forecast) {
    const forecast_t& f = picture.forecast->message;
    const bool falls = f.outcome == forecast_t::FALLS;
    json["forecast"] = heard_json(*picture.forecast);
    json["forecast"]["falls"] = falls;
    json["forecast"]["falls_in_s"] = falls ? Json(seconds(f.falls_in_ns)) : Json(nullptr);
    json["forecast"]["fall_probability"] = f.fall_probability;
    json["forecast"]["peak_tilt_rad"] = f.peak_tilt_rad;
    json["forecast"]["final_tilt_rad"] = f.final_tilt_rad;
    json["forecast"]["horizon_s"] = seconds(f.horizon_ns);
  }
  return json;
}

Json left_json(const std::optional<Margin>& margin) {
  return margin ? Json(margin->left) : Json(nullptr);
}

template <std::size_t N>
Json left_json(const std::array<std::optional<Margin>, N>& margins, int n) {
  Json json = Json::array();
  for (int i = 0; i < n; ++i) json.push_back(left_json(margins[static_cast<std::size_t>(i)]));
  return json;
}

Json channels_json(const Picture& picture) {
  Json json = Json::object();
  for (const ChannelSpec& row : kChannels) {
    const ChannelTraffic& heard = picture.channels[static_cast<std::size_t>(row.channel)];
    json[std::string(row.suffix)] = {
        {"per_s", heard.per_second},
        {"received", heard.received},
        {"gaps", heard.gaps},
        {"repeats", heard.repeats},
        {"reordered", heard.reordered},
        {"age_s", heard.age_ns ? Json(seconds(*heard.age_ns)) : Json(nullptr)}};
  }
  return json;
}

Json acting_json(const Picture& picture) {
  Json json = Json::array();
  for (const Acting& acting : picture.acting) {
    json.push_back({{"id", acting.id},
                    {"fault", acting.fault},
                    {"what", acting.what},
                    {"begin_tick", acting.begin},
                    {"end_tick", acting.end ? Json(*acting.end) : Json(nullptr)}});
  }
  return json;
}

std::string_view level_name(Level level) {
  constexpr std::string_view kNames[] = {"info", "good", "warning", "bad"};
  return kNames[static_cast<std::size_t>(level)];
}

Json happenings_json(const Picture& picture, std::int64_t after) {
  Json json = Json::array();
  for (const Happening& happening : picture.happenings) {
    if (happening.number <= after) continue;
    json.push_back({{"time", iso_time(happening.utc_ns)},
                    {"level", level_name(happening.level)},
                    {"who", happening.who},
                    {"what", happening.what}});
  }
  return json;
}

Json owner_of(const Picture& picture) {
  const auto controller =
      picture.controller ? std::optional(picture.controller->message) : std::nullopt;
  const status_t& status = picture.owner->message;
  return owner_json(status, lease_holder(status, controller, picture.command));
}

}  // namespace

std::string json_text(const Picture& picture, const RigFacts& facts, std::int64_t after) {
  const auto& [owner, controller] = std::tie(picture.owner, picture.controller);
  const Margins margins = margins_of(picture, facts);
  const BusCounters& bus = picture.bus;
  Json json;
  json["time"] = iso_time(picture.utc_ns);
  json["rig"] = facts.name;
  json["reach"] = facts.reach;
  json["owner"] = owner ? peer_json(*owner, owner_of(picture)) : Json(nullptr);
  json["controller"] =
      controller ? peer_json(*controller, daemon_json(controller->message)) : Json(nullptr);
  const Peer& mirror = picture.mirror;
  json["mirror"] = mirror ? peer_json(*mirror, daemon_json(mirror->message)) : Json(nullptr);
  json["twin"] = twin_json(picture);
  json["link"] = picture.link ? line_json(*picture.link) : Json(nullptr);
  json["measured_speed_factor"] = picture.speed ? Json(*picture.speed) : Json(nullptr);
  json["state"] = picture.state ? state_json(*picture.state, facts) : Json(nullptr);
  json["truth"] = picture.truth ? truth_json(*picture.truth, facts) : Json(nullptr);
  json["margins"] = {{"tilt_rad", left_json(margins.tilt)},
                     {"gimbal_rad", left_json(margins.gimbal, facts.gyros)},
                     {"drive_nm", left_json(margins.drive, facts.drives)}};
  json["channels"] = channels_json(picture);
  json["listener"] = {{"malformed", bus.malformed},
                      {"foreign", bus.foreign},
                      {"other_rig", bus.other_rig},
                      {"unauthentic", bus.unauthentic},
                      {"kernel_dropped", bus.kernel_dropped}};
  json["acting"] = acting_json(picture);
  json["events"] = happenings_json(picture, after);
  return json.dump() + '\n';
}

}  // namespace gyrotwin
