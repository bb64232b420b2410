// Requests from what operators say of disturbances and faults.
#include "clients/common/event.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace gyrotwin {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

Rig rig() {
  Rig rig;
  rig.reference_impulse_nms = 2.5;
  rig.impulse_duration_s = 0.02;
  return rig;
}

const Quantity& quantity(const EventKind& kind, std::string_view name) {
  const auto found = std::ranges::find(kind.quantities, name, &Quantity::name);
  EXPECT_NE(found, kind.quantities.end()) << kind.name << " has no " << name;
  return *found;
}

using Said = std::vector<std::pair<std::string_view, double>>;

AskedEvent event(std::string_view kind, const Said& said, std::string_view target = "") {
  AskedEvent event{.kind = event_kind(kind)};
  for (const auto& [name, value] : said) {
    event.values.emplace_back(&quantity(*event.kind, name), value);
  }
  if (!target.empty()) {
    event.target = &*std::ranges::find(event.kind->targets, target, &Target::name);
  }
  return event;
}

request_t request(std::string_view kind, const Said& said, std::string_view target = "") {
  const AskedEvent what = event(kind, said, target);
  EXPECT_EQ(shortcoming(what, option_of), "");
  return request_of(what, rig(), kMillisecond);
}

struct Rounded {
  double asked_s;
  std::int64_t tick_ns;
  std::int64_t ticks;
};

class Impulse : public ::testing::TestWithParam<Rounded> {};
INSTANTIATE_TEST_SUITE_P(
    , Impulse,
    ::testing::Values(Rounded{0.02, kMillisecond, 20}, Rounded{0.0204, kMillisecond, 20},
                      Rounded{0.0206, kMillisecond, 21}, Rounded{0.0001, kMillisecond, 1},
                      Rounded{0.02, 3 * kMillisecond, 7}, Rounded{0.001, 1'234'567, 1}));

TEST_P(Impulse, IsExactHoweverTheDurationIsRounded) {
  const auto [asked_s, tick_ns, ticks] = GetParam();
  const double moment[] = {1.7, -0.3, 0.9}, force[] = {0.1, 20.0, -3.0};
  const AskedEvent impulse = event("impulse", {{"roll", moment[0]},
                                               {"pitch", moment[1]},
                                               {"yaw", moment[2]},
                                               {"push_x", force[0]},
                                               {"push_y", force[1]},
                                               {"push_z", force[2]},
                                               {"duration", asked_s}});
  const request_t r = request_of(impulse, rig(), tick_ns);
  EXPECT_EQ(r.verb, request_t::DISTURB);
  EXPECT_EQ(r.kind, request_t::LOAD);
  EXPECT_EQ(r.duration_ns, ticks * tick_ns);
  const double duration = 1e-9 * static_cast<double>(r.duration_ns);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(r.moment_nm[i] * duration, moment[i]);
    EXPECT_DOUBLE_EQ(r.force_n[i] * duration, force[i]);
  }
}

TEST(ImpulseAlone, IsTheRigsReferencePush) {
  const request_t r = request("impulse", {});
  EXPECT_EQ(r.duration_ns, 20 * kMillisecond);
  EXPECT_DOUBLE_EQ(r.moment_nm[0] * 0.02, 2.5);
  EXPECT_EQ(r.moment_nm[1], 0.0);
}

TEST(Loads, ComeToTheirFields) {
  request_t r = request("step", {{"roll", 0.5}, {"push_y", 2.0}});
  EXPECT_EQ(r.kind, request_t::LOAD);
  EXPECT_EQ(r.duration_ns, 0) << "until it is cancelled";
  EXPECT_EQ(r.moment_nm[0], 0.5);
  EXPECT_EQ(r.force_n[1], 2.0);

  r = request("ramp", {{"pitch", 0.5}, {"rise", 1.5}, {"duration", 4.0}});
  EXPECT_EQ(r.kind, request_t::LOAD);
  EXPECT_EQ(r.rise_ns, 1500 * kMillisecond);
  EXPECT_EQ(r.duration_ns, 4000 * kMillisecond);

  r = request("sine", {{"yaw", 0.5}, {"frequency", 2.0}});
  EXPECT_EQ(r.kind, request_t::SINE);
  EXPECT_EQ(r.frequency_hz[0], 2.0);

  r = request("chirp", {{"push_z", 3.0}, {"from", 1.0}, {"to", 8.0}, {"duration", 4.0}});
  EXPECT_EQ(r.kind, request_t::CHIRP);
  EXPECT_EQ(r.force_n[2], 3.0);
  EXPECT_EQ(r.frequency_hz[0], 1.0);
  EXPECT_EQ(r.frequency_hz[1], 8.0);

  r = request("gust", {{"push_x", 3.0}, {"seed", 9}});
  EXPECT_EQ(r.kind, request_t::GUST);
  EXPECT_EQ(r.correlation_s, 1.0) << "by default";
  EXPECT_EQ(r.seed, 9);
}

TEST(Surroundings, ComeToTheirFields) {
  request_t r =
      request("wind", {{"speed", 8.0}, {"direction", 0.5}, {"turbulence", 2.0}, {"length", 30.0}});
  EXPECT_EQ(r.kind, request_t::WIND);
  EXPECT_EQ(r.speed_m_s, 8.0);
  EXPECT_EQ(r.direction_rad, 0.5);
  EXPECT_EQ(r.turbulence_m_s, 2.0);
  EXPECT_EQ(r.length_m, 30.0);

  r = request("turn", {{"speed", 8.0}, {"yaw_rate", -0.5}});
  EXPECT_EQ(r.kind, request_t::TURN);
  EXPECT_EQ(r.speed_m_s, 8.0);
  EXPECT_EQ(r.yaw_rate_rad_s, -0.5);

  r = request("brake", {{"deceleration", 3.0}});
  EXPECT_EQ(r.kind, request_t::DECELERATION);
  EXPECT_EQ(r.deceleration_m_s2, 3.0);

  r = request("mass", {{"mass", 0.5}, {"x", 0.1}, {"y", -0.2}, {"z", 0.3}});
  EXPECT_EQ(r.kind, request_t::ADDED_MASS);
  EXPECT_EQ(r.mass_kg, 0.5);
  EXPECT_EQ(r.position_m[0], 0.1);
  EXPECT_EQ(r.position_m[1], -0.2);
  EXPECT_EQ(r.position_m[2], 0.3);
}

TEST(Faults, ComeToTheirFields) {
  const auto sensor = [](std::string_view effect, double value) {
    const request_t r = request("sensor", {{effect, value}}, "gimbals");
    EXPECT_EQ(r.verb, request_t::FAULT);
    EXPECT_EQ(r.target, sensors_t::VALID_GIMBALS);
    return r;
  };
  EXPECT_EQ(sensor("stuck", 1.0).kind, request_t::SENSOR_STUCK);
  EXPECT_EQ(sensor("drop", 1.0).kind, request_t::SENSOR_DROPPED);
  EXPECT_EQ(sensor("bias", -0.1).kind, request_t::SENSOR_BIASED);
  EXPECT_EQ(sensor("bias", -0.1).level, -0.1);
  EXPECT_EQ(sensor("noise", 0.1).kind, request_t::SENSOR_NOISY);
  EXPECT_EQ(sensor("noise", 0.1).level, 0.1);
  EXPECT_EQ(sensor("delay", 0.25).kind, request_t::SENSOR_DELAYED);
  EXPECT_EQ(sensor("delay", 0.25).delay_ns, 250 * kMillisecond);
  EXPECT_EQ(sensor("delay", 0.25).level, 0.0);
  EXPECT_EQ(sensor("delay", 0.25).seed, 0) << "an owner refuses what a fault has no use for";

  request_t r = request("drive", {{"strength", 0.25}, {"duration", 2.0}}, "1");
  EXPECT_EQ(r.kind, request_t::DRIVE_WEAK);
  EXPECT_EQ(r.target, 1);
  EXPECT_EQ(r.level, 0.25);
  EXPECT_EQ(r.duration_ns, 2000 * kMillisecond);

  r = request("rotor", {{"drag", 0.01}}, "all");
  EXPECT_EQ(r.kind, request_t::ROTOR_LOSS);
  EXPECT_EQ(r.target, -1);
  EXPECT_EQ(r.level, 0.01);

  r = request("link", {});
  EXPECT_EQ(r.kind, request_t::COMMAND_LOST);
  EXPECT_EQ(r.target, 0);
}

TEST(Shortcomings, NameWhatIsMissing) {
  const auto told = [](std::string_view kind, const Said& said, std::string_view target = "") {
    return shortcoming(event(kind, said, target), option_of);
  };
  EXPECT_EQ(told("step", {}),
            "step: nothing was named; give at least one of --roll, --pitch, --yaw, --push-x, "
            "--push-y, --push-z");
  EXPECT_EQ(told("step", {{"roll", 0.0}}), told("step", {})) << "a load of 0 is none";
  EXPECT_EQ(told("ramp", {{"roll", 1.0}}), "ramp: --rise is missing");
  EXPECT_EQ(told("chirp", {{"roll", 1.0}, {"from", 1.0}}), "chirp: --to is missing");
  EXPECT_EQ(told("sensor", {}, "gyro"),
            "sensor: give exactly one of --stuck, --bias, --noise, --drop, --delay");
  EXPECT_EQ(told("sensor", {{"stuck", 1.0}, {"bias", 1.0}}, "gyro"), told("sensor", {}, "gyro"));
  EXPECT_EQ(told("sensor", {{"bias", 0.0}}, "gyro"), "") << "the owner says what it makes of 0";
}

TEST(Names, AreOneSetForCommandLineAndFile) {
  for (const EventKind& kind : event_kinds()) {
    EXPECT_EQ(event_kind(kind.name), &kind);
    std::set<std::string> options, keys{"kind", "at_s", std::string(kind.name)};
    const Target* target = kind.targets.empty() ? nullptr : &kind.targets.front();
    for (const Quantity& q : kind.quantities) {
      EXPECT_TRUE(options.insert(option_of(q)).second) << kind.name << " " << q.name;
      EXPECT_TRUE(keys.insert(key_of(q, target)).second) << kind.name << " " << q.name;
    }
  }
  EXPECT_EQ(event_kind("no such"), nullptr);
  const EventKind& sensor = *event_kind("sensor");
  EXPECT_EQ(option_of(quantity(*event_kind("turn"), "yaw_rate")), "--yaw-rate");
  EXPECT_EQ(key_of(quantity(*event_kind("turn"), "yaw_rate"), nullptr), "yaw_rate_rad_s");
  EXPECT_EQ(key_of(quantity(sensor, "bias"), &sensor.targets[1]), "bias_m_s2");
  EXPECT_EQ(key_of(quantity(sensor, "stuck"), &sensor.targets[1]), "stuck");
}

}  // namespace
}  // namespace gyrotwin
