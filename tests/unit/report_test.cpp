#include "clients/ctl/report.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "services/runtime/text.hpp"

namespace gyrotwin {
namespace {

status_t owner() {
  status_t s{};
  s.header.epoch = std::numeric_limits<std::int64_t>::max();
  s.header.tick = 5210;
  s.header.sim_time_ns = 5'210'000'000;
  s.service = status_t::INTEGRATOR;
  s.mode = status_t::MODE_SAFE_STOP;
  s.clock = status_t::PACE_REALTIME;
  s.pid = 4711;
  set_text(s.host, "lab");
  set_text(s.text, "no valid command in time");
  s.speed_factor = 0.5;
  s.tick_period_ns = 1'000'000;
  s.disturbances = 2;
  s.faults = 1;
  s.overruns = 3;
  s.lateness_p50_ns = 70'000;
  s.lateness_p99_ns = 1'250'000;
  s.lateness_max_ns = 2'000'000'000;
  s.command_writer = 99;
  s.refused_expired = 7;
  s.gaps[1] = 2;
  s.gaps[2] = 1;
  s.unauthentic = 4;
  return s;
}

status_t controller() {
  status_t s{};
  s.header.epoch = 12;
  s.service = status_t::CONTROLLER;
  s.mode = status_t::MODE_ACTIVE;
  return s;
}

Sighting everything() {
  command_t command{};
  command.writer = 99;
  command.header.epoch = 12;
  state_t state{};
  state.valid = +state_t::VALID_TILT | +state_t::VALID_ROTORS;
  state.tilt_rad[1] = -0.05;
  state.rotor_speed_rad_s[0] = state.rotor_speed_rad_s[1] = 600.0;
  return {.rig = "prototype_b",
          .reach = "this host only (lo)",
          .owner = owner(),
          .controller = controller(),
          .command = command,
          .state = state,
          .nominal_rotor_speed = {800.0, 800.0},
          .mirror = {},
          .link = {}};
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

TEST(Report, NamesAMirrorWhereThereIsOne) {
  Sighting seen = everything();
  EXPECT_FALSE(contains(report(seen), "mirror"));
  seen.mirror = controller();
  EXPECT_TRUE(contains(report(seen), "mirror      ACTIVE")) << report(seen);
}

TEST(Report, TellsARealPlantAndItsLine) {
  Sighting seen = everything();
  EXPECT_TRUE(contains(report(seen), "  plant     simulated\n")) << report(seen);
  seen.owner->service = status_t::HARDWARE;
  link_t& link = seen.link.emplace();
  link.connected = 1;
  link.device_mode = status_t::MODE_HELD;
  link.round_trip_p50_ns = 70'000;
  link.round_trip_max_ns = 1'250'000;
  link.clock_offset_ns = 5'000'001'000;
  link.clock_offset_sigma_ns = 20'000;
  link.clock_drift_ppm = -3.0;
  link.samples_missed = 7;
  set_text(link.text, "/dev/ttyUSB0");
  const std::string text = report(seen);
  for (const char* part :
       {"  plant     real\n", "  device    heard on /dev/ttyUSB0, it is HELD\n",
        "  its clock +5.000001 s +-20 us, -3.0 ppm\n",
        "  line      round trip p50 70 us, max 1.25 ms\n", "  lost      7 samples missed\n"}) {
    EXPECT_TRUE(contains(text, part)) << part << "\nis not in\n" << text;
  }
  const auto json = nlohmann::json::parse(report_json(seen));
  EXPECT_EQ(json["owner"]["plant"], "real");
  EXPECT_EQ(json["link"]["device_mode"], "HELD");
  link.connected = 0;
  EXPECT_TRUE(contains(report(seen), "  device    not heard on /dev/ttyUSB0\n")) << report(seen);
}

TEST(Report, SaysWhatMatters) {
  const std::string text = report(everything());
  for (const char* part :
       {"rig prototype_b on this host only (lo)\n",
        "SAFE_STOP at tick 5210, 5.210 s: no valid command in time\n", "4711 on lab\n",
        "realtime, 1000 Hz, speed 0.5\n", "2.865 deg\n", "at 75 % of their speed\n",
        "2 disturbances, 1 fault act or are to come\n", "p50 70 us, p99 1.25 ms, max 2 s\n",
        "3 ticks too late\n", "held by the controller\n", "7 expired\n",
        "3 never came, 4 without the right signature\n", "controller  ACTIVE"}) {
    EXPECT_TRUE(contains(text, part)) << part << "\nis not in\n" << text;
  }
  EXPECT_FALSE(contains(text, "malformed")) << "what did not happen is not listed";
}

TEST(Report, TellsTheRotorsApart) {
  Sighting seen = everything();
  seen.state->rotor_speed_rad_s[1] = 80.0;
  EXPECT_TRUE(contains(report(seen), "at 75 10 % of their speed\n")) << report(seen);
  seen.owner->disturbances = seen.owner->faults = 0;
  EXPECT_TRUE(contains(report(seen), "  events    none\n")) << report(seen);
}

TEST(Report, SaysWhatStateDoesNotTell) {
  Sighting seen = everything();
  seen.state->valid = 0;
  EXPECT_TRUE(contains(report(seen), "  tilt      not told by STATE\n")) << report(seen);
  EXPECT_TRUE(contains(report(seen), "  rotors    not told by STATE\n"));
  EXPECT_TRUE(nlohmann::json::parse(report_json(seen))["tilt_rad"].is_null());
}

TEST(Report, NamesThePeerThatIsNotHeardAndTheFix) {
  Sighting seen = everything();
  seen.controller.reset();
  EXPECT_TRUE(contains(report(seen), "`gyrotwin controller --rig prototype_b`")) << report(seen);
  seen = everything();
  seen.owner.reset();
  EXPECT_TRUE(contains(report(seen), "`gyrotwin integrator --rig prototype_b`")) << report(seen);
}

TEST(Report, TellsWhoHoldsTheLease) {
  Sighting seen = everything();
  EXPECT_EQ(lease_holder(seen), "the controller");
  seen.command->writer = 98;
  EXPECT_EQ(lease_holder(seen), "writer 99") << "somebody else speaks";
  seen.command->writer = 99;
  seen.command->header.epoch = 13;
  EXPECT_EQ(lease_holder(seen), "writer 99") << "not the controller that is heard";
  seen.command.reset();
  EXPECT_EQ(lease_holder(seen), "writer 99");
  seen.owner->command_writer = 0;
  EXPECT_EQ(lease_holder(seen), "nobody");
}

TEST(ReportJson, HasEveryCounterUnderItsName) {
  const auto json = nlohmann::json::parse(report_json(everything()));
  EXPECT_EQ(json["rig"], "prototype_b");
  const auto& o = json["owner"];
  EXPECT_EQ(o["mode"], "SAFE_STOP");
  EXPECT_EQ(o["text"], "no valid command in time");
  EXPECT_EQ(o["epoch"], "9223372036854775807") << "no digit is lost";
  EXPECT_EQ(o["tick"], 5210);
  EXPECT_EQ(o["lateness_ns"]["p99"], 1'250'000);
  EXPECT_EQ(o["lease"], "the controller");
  EXPECT_EQ(o["last_command"]["writer"], "99");
  EXPECT_TRUE(o["last_request"].is_null());
  EXPECT_EQ(o["refused"]["expired"], 7);
  EXPECT_EQ(o["bus"]["unauthentic"], 4);
  EXPECT_EQ(o["bus"]["channels"]["LIVE/COMMAND"]["gaps"], 2);
  EXPECT_EQ(o["bus"]["channels"].size(), kChannels.size());
  EXPECT_EQ(json["controller"]["mode"], "ACTIVE");
  EXPECT_EQ(o["disturbances"], 2);
  EXPECT_EQ(o["faults"], 1);
  EXPECT_DOUBLE_EQ(json["tilt_rad"], 0.05);
  EXPECT_EQ(json["rotor_shares"], (nlohmann::json{0.75, 0.75}));
}

TEST(ReportJson, WhoIsNotHeardIsNull) {
  const auto json = nlohmann::json::parse(report_json(
      {.rig = "r", .reach = "", .owner = {}, .controller = {}, .command = {}, .state = {}}));
  EXPECT_TRUE(json["owner"].is_null());
  EXPECT_TRUE(json["controller"].is_null());
}

}  // namespace
}  // namespace gyrotwin
