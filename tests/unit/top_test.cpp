// What `gyrotwin top` draws and writes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "clients/top/margins.hpp"
#include "clients/top/screen.hpp"
#include "services/runtime/observation_wire.hpp"
#include "tests/support/heard.hpp"

namespace gyrotwin {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

RigFacts facts() { return facts_of(load_rig("prototype_b")); }

state_t leaning_state() {
  state_t state{};
  state.header = owner_status().header;
  using Groups = std::initializer_list<std::int32_t>;
  for (const std::int32_t group :
       Groups{state_t::VALID_TILT, state_t::VALID_DISC, state_t::VALID_GIMBALS,
              state_t::VALID_ROTORS, state_t::VALID_DRIVES}) {
    state.valid |= group;
  }
  state.tilt_rad[0] = 24.0 * kDegree;
  state.tilt_rad[1] = -10.0 * kDegree;
  state.disc_rate_rad_s = -5.0;
  for (double& angle : state.gimbal_angle_rad) angle = 0.1;
  state.gimbal_angle_rad[2] = 0.69;  // its stop is at 0.7
  for (double& speed : state.rotor_speed_rad_s) speed = 0.5 * facts().nominal_rotor_speed[0];
  state.drive_torque_nm[0] = 11.0;
  return state;
}

truth_t leaning_truth() {
  truth_t truth{};
  truth.header = owner_status().header;
  truth.contact_lower_n[0] = 12.5;
  truth.tilt_margin_rad = facts().fall_tilt - 24.0 * kDegree;
  truth.drive_margin_nm[0] = 1.0;
  return truth;
}

/// Everybody alive, the platform leaning, a push acting.
Listening busy() {
  Listening l;
  status_t owner = owner_status();
  owner.disturbances = 2;
  owner.lateness_p99_ns = 1'250'000;
  l.hear(Channel::kIntegratorStatus, owner);
  l.hear(Channel::kControllerStatus, controller_status());
  l.hear(Channel::kState, leaning_state());
  l.hear(Channel::kTruth, leaning_truth());
  request_t request{};
  request.verb = request_t::DISTURB;
  request.kind = request_t::SINE;
  request.frequency_hz[0] = 2.0;
  request.force_n[1] = 3.0;
  l.hear(Channel::kRequest, request);
  reply_t reply{};
  reply.header.epoch = owner.header.epoch;
  reply.verb = request_t::DISTURB;
  reply.result = reply_t::APPLIED;
  reply.applied_tick = 4000;
  reply.id = 1;
  set_text(reply.text, "number 1, from tick 4000 until it is cancelled");
  l.hear(Channel::kReply, reply);
  l.bus.gaps[0] = 17;
  l.monitor.look(l.now(), l.bus);
  return l;
}

std::string all(const Lines& lines) {
  std::string text;
  for (const Line& line : lines) text += text_of(line) + '\n';
  return text;
}

std::string drawn(const Listening& l, Size size, Glyphs glyphs = {}) {
  return all(screen(l.picture(), facts(), size, glyphs));
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

void expect_parts(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts) {
    EXPECT_TRUE(contains(text, part)) << part << "\nis not in\n" << text;
  }
}

TEST(Screen, FillsEveryWindowAndNeverMore) {
  const Listening nobody, l = busy();
  for (const Size size :
       {Size{24, 80}, Size{40, 120}, Size{50, 160}, Size{24, 160}, Size{20, 120}, Size{10, 40},
        Size{5, 200}, Size{3, 3}, Size{1, 1}, Size{200, 20}, Size{300, 500}}) {
    for (const Listening* heard : {&nobody, &l}) {
      const Lines lines = screen(heard->picture(), facts(), size, {.unicode = true});
      ASSERT_EQ(lines.size(), size.rows);
      for (const Line& line : lines) ASSERT_EQ(line.width(), size.columns) << text_of(line);
    }
  }
}

TEST(Screen, SaysWhatMattersIn80x24) {
  expect_parts(drawn(busy(), {24, 80}), {"prototype_b",
                                         "RUNNING",
                                         "tick 5000, 5.000 s",
                                         "realtime, 1000 Hz, speed 1",
                                         "tilt 16.1 deg close",
                                         "gimbals 0.6 deg close",
                                         "drives 1.00 N m close",
                                         "+24.000 deg",
                                         "-10.000 deg",
                                         "-5.000 rad/s",
                                         "+39.5 (0.6)!",
                                         "628.3 (50%)",
                                         "+11.000 (1.00)!",
                                         "12.50",
                                         "lifted",
                                         "4711 on lab",
                                         "4712 on lab",
                                         "1.2m",
                                         "2 disturbances, 0 faults",
                                         "here 17",
                                         "disturb sine 2 Hz: force (0, 3, 0) N"});
}

TEST(Screen, ShowsMoreWhereThereIsRoom) {
  for (const Size size : {Size{40, 120}, Size{50, 160}, Size{60, 80}}) {
    expect_parts(drawn(busy(), size),
                 {"LIVE/SENSORS", "CONTROLLER/STATUS", "lost here", "lease", "pushed by",
                  "1: sine 2 Hz: force (0, 3, 0) N; acts until cancelled",
                  "1 not heard being asked for", "tilt 16.1 deg close", "+39.5 (0.6)!"});
  }
}

/// The same on a line to a device.
Listening real() {
  Listening l;
  status_t owner = owner_status();
  owner.service = status_t::HARDWARE;
  owner.header.source = header_t::HARDWARE;
  l.hear(Channel::kHardwareStatus, owner);
  l.hear(Channel::kControllerStatus, controller_status());
  state_t state = leaning_state();
  state.header.source = header_t::HARDWARE;
  l.hear(Channel::kState, state);
  link_t link{};
  link.header = owner.header;
  link.connected = 1;
  link.device_mode = status_t::MODE_RUNNING;
  link.round_trip_p50_ns = 70'000;
  link.round_trip_max_ns = 451'000;
  link.clock_offset_ns = -123'456'000'052'000;
  link.clock_offset_sigma_ns = 20'000;
  link.clock_drift_ppm = 12.3;
  link.samples_missed = 12;
  link.host_bad = 9;
  link.device_bad = 3;
  link.reconnects = 2;
  set_text(link.text, "/dev/ttyUSB0");
  l.hear(Channel::kLink, link);
  return l;
}

TEST(Screen, SaysThatAPlantIsRealAndHowItsLineIs) {
  expect_parts(drawn(busy(), {24, 80}), {"RUNNING (simulated)", "\nstate, bars to"});
  const std::string narrow = drawn(real(), {24, 80});
  expect_parts(narrow, {"RUNNING (real)  the plant is free", "state, as estimated on board",
                        "line        round trip 70u/451u  clock -123456.0 s  lost 12 in, 3 out"});
  for (const Size size : {Size{40, 120}, Size{60, 80}}) {
    expect_parts(drawn(real(), size),
                 {"RUNNING (real)", "line        CONNECTED  /dev/ttyUSB0", "70u/451u (p50/max)",
                  "-123456.000052 s +-20 us, +12.3", "12 samples missed, 9 damaged", "reopened",
                  "CONTROLLER/STATUS"});
  }
  Listening l = real();
  l.pass(1'500'000'000);
  expect_parts(drawn(l, {24, 80}), {"line        NOT HEARD  last 1.5 s ago"});
}

/// Without TRUTH, by motor line and limit.
TEST(Screen, KnowsWhatADriveHasLeft) {
  const RigFacts rig = facts();
  const double rate = rig.machine.drive_rate(0, rig.machine.recall(from_wire(leaning_state())));
  const double left = rig.machine.drives[0].range(rate)[1] - 11.0;
  const Margins margins = margins_of(real().picture(), rig);
  ASSERT_TRUE(margins.drive[0]);
  EXPECT_DOUBLE_EQ(margins.drive[0]->left, left);
  expect_parts(drawn(real(), {24, 80}), {fmt::format("+11.000 ({:.2f})", left).c_str()});
}

TEST(Screen, DrawsTiltWithItsSign) {
  const std::string text = drawn(busy(), {24, 80});
  // 14 cells a side stand for the fall limit of 40.1 deg.
  expect_parts(text, {"[..............|########......]", "[...........###|..............]"});
  expect_parts(drawn(busy(), {24, 80}, {.unicode = true}), {"│████████······]"});
}

TEST(Screen, MarksWhatIsStale) {
  Listening l = busy();
  EXPECT_FALSE(contains(drawn(l, {24, 80}), "?"));
  l.pass(2'500'000'000);
  const std::string text = drawn(l, {24, 80});
  expect_parts(text,
               {"owner NOT HEARD  last heard 2.5 s ago, then RUNNING", "last heard: tick 5000",
                "margins  unknown", "STALE, heard 2.5 s ago", "\n? tilt x", "\n? contact",
                "|::::::::......]", "controller  NOT HEARD  for 2.5 s; was 4712 on lab, ACTIVE",
                "controller not heard for 1 s"});
  for (const char* part : {"fine", "close", "(0.6)", "#", "acting"}) {
    EXPECT_FALSE(contains(text, part)) << part << "\nis in\n" << text;
  }
}

TEST(Screen, TellsNoMarginsOfAFault) {
  Listening l = busy();
  EXPECT_TRUE(contains(drawn(l, {24, 80}), "margins  tilt"));
  state_t state = leaning_state();
  state.mode = status_t::MODE_FAULT;
  ++state.header.sequence;
  l.hear(Channel::kState, state);
  expect_parts(drawn(l, {24, 80}), {"margins  unknown since the fault"});
}

TEST(Screen, NamesWhoMustBeStarted) {
  expect_parts(
      drawn(Listening(), {24, 80}),
      {"owner NOT HEARD  start `gyrotwin integrator --rig prototype_b`",
       "or `gyrotwin hardware`, where it is real", "start it with `gyrotwin controller --rig "});
}

TEST(Screen, ShowsReasonsInFull) {
  Listening l;
  const std::string why(80, 'y');
  l.hear(Channel::kIntegratorStatus, owner_status(status_t::MODE_SAFE_STOP, ("x " + why).c_str()));
  EXPECT_TRUE(contains(drawn(l, {24, 110}), why));
}

TEST(Screen, ShowsNoControlCharactersOfPeers) {
  Listening l;
  l.hear(Channel::kIntegratorStatus, owner_status(status_t::MODE_HELD, "\x1b[31mred\xc3\xa9"));
  const std::string text = drawn(l, {24, 80});
  EXPECT_FALSE(contains(text, "\x1b") || contains(text, "\xc3")) << text;
}

TEST(Ansi, ToneIsColourOnlyWhereColourIsWanted) {
  const Line line = Line().put("x").put("bad", Tone::kBad).put("good", Tone::kGood);
  EXPECT_EQ(ansi_of(line, true), "x\x1b[1;31mbad\x1b[0m\x1b[32mgood\x1b[0m");
  EXPECT_EQ(ansi_of(line, false), "x\x1b[7mbad\x1b[0mgood");
}

TEST(Ansi, AnUpdateWritesTheLinesThatDiffer) {
  const Lines before{Line().put("one"), Line().put("two")};
  EXPECT_EQ(ansi_update(before, before, true), "");
  EXPECT_EQ(ansi_update(before, {Line().put("one"), Line().put("TWO")}, true), "\x1b[2;1HTWO");
  EXPECT_EQ(ansi_update({}, before, true), "\x1b[1;1Hone\x1b[2;1Htwo");
}

TEST(PlainText, HasNoEscapesAndOnlyNewHappenings) {
  const Listening l = busy();
  const std::string text = plain_text(l.picture(), facts(), {}, 0);
  for (const char c : text) ASSERT_TRUE(c == '\n' || (c >= ' ' && c <= '~')) << int{c};
  expect_parts(text, {"2026-01-31", "RUNNING", "tilt x, roll       +24.000 deg",
                      "owner      heard: 4711 on lab"});
  EXPECT_FALSE(contains(plain_text(l.picture(), facts(), {}, 3), "heard: 4711"));
}

TEST(JsonText, HasEverythingWithUnits) {
  const Listening l = busy();
  const std::string text = json_text(l.picture(), facts(), 2);
  EXPECT_EQ(text.find('\n'), text.size() - 1) << "one object, one line";
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["time"], "2026-01-31T21:14:03.120Z");
  EXPECT_EQ(json["owner"]["mode"], "RUNNING");
  EXPECT_EQ(json["owner"]["alive"], true);
  EXPECT_EQ(json["owner"]["lateness_ns"]["p99"], 1'250'000);
  EXPECT_EQ(json["owner"]["disturbances"], 2);
  EXPECT_EQ(json["controller"]["pid"], 4712);
  EXPECT_EQ(json["state"]["epoch"], std::to_string(0x1122334455667788)) << "no digit is lost";
  EXPECT_DOUBLE_EQ(json["state"]["tilt_rad"][0], 24.0 * kDegree);
  EXPECT_TRUE(json["state"]["disc_tilt_rad"].is_null()) << "not valid";
  EXPECT_EQ(json["state"]["gimbal_angle_rad"].size(), 4U);
  EXPECT_EQ(json["state"]["drive_torque_nm"].size(), 1U);
  EXPECT_EQ(json["truth"]["contact_lower_n"][0], 12.5);
  EXPECT_TRUE(json["truth"]["load_cell_n"].is_null()) << "the rig has none";
  EXPECT_EQ(json["margins"]["drive_nm"][0], 1.0);
  EXPECT_NEAR(json["margins"]["gimbal_rad"][2], 0.01, 1e-12);  // measured 5.6e-17
  EXPECT_EQ(json["channels"].size(), kChannels.size());
  EXPECT_EQ(json["channels"]["LIVE/STATE"]["gaps"], 17);
  EXPECT_EQ(json["acting"][0]["what"], "sine 2 Hz: force (0, 3, 0) N");
  ASSERT_EQ(json["events"].size(), 1U) << "two were told before";
  EXPECT_EQ(json["events"][0]["who"], "reply");
}

TEST(JsonText, HasTheLineOfARealPlant) {
  const auto simulated = nlohmann::json::parse(json_text(busy().picture(), facts(), 0));
  EXPECT_EQ(simulated["owner"]["plant"], "simulated");
  EXPECT_EQ(simulated["state"]["estimated"], false);
  EXPECT_TRUE(simulated["link"].is_null());
  const auto json = nlohmann::json::parse(json_text(real().picture(), facts(), 0));
  EXPECT_EQ(json["owner"]["plant"], "real");
  EXPECT_EQ(json["state"]["estimated"], true);
  EXPECT_EQ(json["link"]["connected"], true);
  EXPECT_EQ(json["link"]["stale"], false);
  EXPECT_EQ(json["link"]["clock_offset_ns"], -123'456'000'052'000);
  EXPECT_EQ(json["link"]["samples_missed"], 12);
}

TEST(JsonText, WhatIsStaleSaysSo) {
  Listening l = busy();
  l.pass(1'500'000'000);
  const auto json = nlohmann::json::parse(json_text(l.picture(), facts(), 0));
  EXPECT_EQ(json["owner"]["alive"], false);
  EXPECT_EQ(json["state"]["stale"], true);
  EXPECT_DOUBLE_EQ(json["state"]["age_s"], 1.5);
  EXPECT_TRUE(json["margins"]["tilt_rad"].is_null());
}

TEST(JsonText, WhoIsNotHeardIsNull) {
  const auto json = nlohmann::json::parse(json_text(Listening().picture(), facts(), 0));
  for (const char* key : {"owner", "controller", "state", "truth", "measured_speed_factor"}) {
    EXPECT_TRUE(json[key].is_null()) << key;
  }
}

TEST(Facts, StopsAreThoseOfTheGimbalsWhateverTheirSign) {
  for (const std::string& name : shipped_rigs()) {
    const RigFacts rig = facts_of(load_rig(name));
    for (int j = 0; j < rig.gyros; ++j) {
      EXPECT_GT(rig.stop_margin(j, 0.0), 0.0) << name << ", gyro " << j;
    }
    EXPECT_GE(rig.drives, 1) << name;
  }
  EXPECT_NEAR(facts().stop_margin(0, 0.0), 0.6, 1e-15);
}

}  // namespace
}  // namespace gyrotwin
