// What a rig cannot show, or what cannot be meant, is refused with the reason, and nothing of it
// acts.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "tests/support/schedule_bench.hpp"

namespace gyrotwin {
namespace {

using support::disturbance;
using support::fault;
using support::ScheduleBench;

constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
const double kNan = std::nan("");

request_t good_disturbance(std::int32_t kind) {
  request_t r = disturbance(kind);
  r.duration_ns = 1'000'000'000;
  switch (kind) {
    case request_t::WIND:
      r.speed_m_s = 10.0;
      r.direction_rad = 1.0;
      r.turbulence_m_s = 1.0;
      r.length_m = 50.0;
      break;
    case request_t::TURN:
      r.speed_m_s = 5.0;
      r.yaw_rate_rad_s = 0.2;
      break;
    case request_t::DECELERATION:
      r.deceleration_m_s2 = 1.0;
      break;
    case request_t::ADDED_MASS:
      r.mass_kg = 1.0;
      r.position_m[2] = 0.5;
      break;
    default:
      r.moment_nm[0] = 1.0;
  }
  if (kind == request_t::SINE || kind == request_t::CHIRP) r.frequency_hz[0] = 3.0;
  if (kind == request_t::CHIRP) r.frequency_hz[1] = 30.0;
  if (kind == request_t::GUST) r.correlation_s = 0.3;
  return r;
}

request_t good_fault(std::int32_t kind) {
  request_t r = fault(kind);
  if (kind <= request_t::SENSOR_DELAYED) r.target = sensors_t::VALID_GYRO;
  if (kind == request_t::SENSOR_BIASED || kind == request_t::SENSOR_NOISY) r.level = 0.1;
  if (kind == request_t::SENSOR_DELAYED) r.delay_ns = 5'000'000;
  return r;
}

using Spoil = std::function<void(request_t&)>;

void expect_refused(const std::string& name, request_t request, const Spoil& spoil,
                    const std::string& says,
                    const Rig& rig = load_rig("prototype_b", support::with_everything())) {
  ScheduleBench bench(rig);
  spoil(request);
  EXPECT_EQ(bench.add(request, 10), 0) << name;
  EXPECT_EQ(bench.reply.result, reply_t::REFUSED) << name;
  EXPECT_NE(get_text(bench.reply.text).find(says), std::string::npos)
      << name << ": " << get_text(bench.reply.text);
  EXPECT_EQ(bench.schedule.disturbances() + bench.schedule.faults(), 0) << name;
  EXPECT_LT(get_text(bench.reply.text).size(), sizeof bench.reply.text - 1) << "cut";
}

TEST(Refusals, TheGoodOnesAreTaken) {
  ScheduleBench bench;
  for (int kind = request_t::LOAD; kind <= request_t::ADDED_MASS; ++kind) {
    EXPECT_NE(bench.add(good_disturbance(kind)), 0) << kind << get_text(bench.reply.text);
  }
  for (int kind = request_t::SENSOR_STUCK; kind <= request_t::COMMAND_LOST; ++kind) {
    EXPECT_NE(bench.add(good_fault(kind)), 0) << kind << get_text(bench.reply.text);
  }
}

TEST(Refusals, KindsAndTimesThatCannotBeMeant) {
  for (const int verb : {+request_t::DISTURB, +request_t::FAULT}) {
    const request_t good = verb == request_t::DISTURB ? good_disturbance(request_t::LOAD)
                                                      : good_fault(request_t::DRIVE_WEAK);
    for (const int kind : {-1, 0, 9, 1 << 30, -(1 << 30)}) {
      expect_refused(
          "kind", good, [kind](request_t& r) { r.kind = kind; }, "not known");
    }
    const auto refused = [&](const Spoil& spoil, const std::string& says) {
      expect_refused(says, good, spoil, says);
    };
    refused([](request_t& r) { r.duration_ns = -1; }, "duration_ns");
    refused([](request_t& r) { r.duration_ns = kLast; }, "duration_ns");
    refused([](request_t& r) { r.start_tick = -1; }, "start_tick");
    refused([](request_t& r) { r.start_tick = 9; }, "tick 9 is over");
    refused([](request_t& r) { r.start_tick = kLast; }, "start ticks end");
  }
  const request_t load = good_disturbance(request_t::LOAD);
  expect_refused(
      "rise", load, [](request_t& r) { r.rise_ns = -1; }, "rise_ns");
  expect_refused(
      "rise", load, [](request_t& r) { r.rise_ns = kLast; }, "rise_ns");
  expect_refused(
      "rise", load, [](request_t& r) { r.rise_ns = r.duration_ns + 1; }, "rise_ns");
  expect_refused(
      "the readings of tick 10 are out", good_fault(request_t::SENSOR_STUCK),
      [](request_t& r) { r.start_tick = 10; }, "tick 10 is over");
}

TEST(Refusals, NumbersThatCannotBeMeant) {
  const auto at = [](auto member) {
    return [member](double x) { return [member, x](request_t& r) { r.*member = x; }; };
  };
  const auto in = [](auto member, int i) {
    return [member, i](double x) { return [member, i, x](request_t& r) { (r.*member)[i] = x; }; };
  };
  const auto refused = [](std::int32_t kind, const char* field, auto set,
                          std::initializer_list<double> bad) {
    for (const double x : bad) {
      expect_refused(std::string(field) + " " + std::to_string(x), good_disturbance(kind), set(x),
                     field);
    }
  };
  for (int kind = request_t::LOAD; kind <= request_t::GUST; ++kind) {
    refused(kind, "force_n", in(&request_t::force_n, 2), {kNan, HUGE_VAL, -1e10});
    refused(kind, "moment_nm", in(&request_t::moment_nm, 2), {kNan, HUGE_VAL, -1e10});
    refused(kind, "needs a force_n or a moment_nm", in(&request_t::moment_nm, 0), {0.0});
  }
  refused(request_t::SINE, "frequency_hz[0]", in(&request_t::frequency_hz, 0),
          {kNan, 0.0, -1.0, 500.1});
  refused(request_t::CHIRP, "frequency_hz[0]", in(&request_t::frequency_hz, 0),
          {kNan, -1.0, 500.1});
  refused(request_t::CHIRP, "frequency_hz[1]", in(&request_t::frequency_hz, 1),
          {kNan, -1.0, 500.1});
  refused(request_t::GUST, "correlation_s", at(&request_t::correlation_s),
          {kNan, 0.0, -1.0, 1e4, HUGE_VAL});
  refused(request_t::WIND, "speed_m_s", at(&request_t::speed_m_s), {kNan, 0.0, -1.0, 1e4});
  refused(request_t::WIND, "direction_rad", at(&request_t::direction_rad), {kNan, HUGE_VAL});
  refused(request_t::WIND, "turbulence_m_s", at(&request_t::turbulence_m_s), {kNan, -1.0, 1e4});
  refused(request_t::WIND, "length_m", at(&request_t::length_m), {kNan, -1.0, 1e9});
  refused(request_t::WIND, "turbulence needs both", at(&request_t::length_m), {0.0});
  refused(request_t::WIND, "turbulence needs both", at(&request_t::turbulence_m_s), {0.0});
  refused(request_t::TURN, "speed_m_s", at(&request_t::speed_m_s), {kNan, 1e4});
  refused(request_t::TURN, "yaw_rate_rad_s", at(&request_t::yaw_rate_rad_s), {kNan, 0.0, 1e4});
  refused(request_t::DECELERATION, "deceleration_m_s2", at(&request_t::deceleration_m_s2),
          {kNan, 0.0, 1e4, -1e4});
  refused(request_t::ADDED_MASS, "mass_kg", at(&request_t::mass_kg), {kNan, 0.0, -1.0, 1e9});
  refused(request_t::ADDED_MASS, "position_m", in(&request_t::position_m, 1), {kNan, 1e9});
  expect_refused(
      "chirp for ever", good_disturbance(request_t::CHIRP), [](request_t& r) { r.duration_ns = 0; },
      "duration_ns");
}

TEST(Refusals, FieldsThatTheKindDoesNotHave) {
  const auto refused = [](const request_t& good, const char* field, const Spoil& spoil) {
    expect_refused(field, good, spoil, std::string("has no ") + field);
  };
  const request_t load = good_disturbance(request_t::LOAD);
  refused(load, "seed", [](request_t& r) { r.seed = 1; });
  refused(load, "frequency_hz[0]", [](request_t& r) { r.frequency_hz[0] = 1; });
  refused(load, "speed_m_s", [](request_t& r) { r.speed_m_s = kNan; });
  refused(load, "direction_rad", [](request_t& r) { r.direction_rad = 1; });
  refused(load, "turbulence_m_s", [](request_t& r) { r.turbulence_m_s = 1; });
  refused(load, "length_m", [](request_t& r) { r.length_m = 1; });
  refused(load, "correlation_s", [](request_t& r) { r.correlation_s = 1; });
  refused(load, "yaw_rate_rad_s", [](request_t& r) { r.yaw_rate_rad_s = 1; });
  refused(load, "deceleration_m_s2", [](request_t& r) { r.deceleration_m_s2 = 1; });
  refused(load, "mass_kg", [](request_t& r) { r.mass_kg = 1; });
  refused(load, "position_m", [](request_t& r) { r.position_m[2] = 1; });
  refused(load, "level", [](request_t& r) { r.level = 1; });
  refused(load, "delay_ns", [](request_t& r) { r.delay_ns = 1; });
  refused(load, "target", [](request_t& r) { r.target = -1; });
  refused(good_disturbance(request_t::SINE), "frequency_hz[1]",
          [](request_t& r) { r.frequency_hz[1] = 1; });
  refused(good_disturbance(request_t::WIND), "force_n", [](request_t& r) { r.force_n[0] = 1; });
  refused(good_disturbance(request_t::ADDED_MASS), "rise_ns", [](request_t& r) { r.rise_ns = 1; });
  refused(good_fault(request_t::COMMAND_LOST), "target", [](request_t& r) { r.target = 1; });
  refused(good_fault(request_t::DRIVE_WEAK), "rise_ns", [](request_t& r) { r.rise_ns = 1; });
  refused(good_fault(request_t::SENSOR_STUCK), "level", [](request_t& r) { r.level = 1; });
  refused(good_fault(request_t::ROTOR_LOSS), "moment_nm", [](request_t& r) { r.moment_nm[0] = 1; });
}

TEST(Refusals, WhatTheRigDoesNotHave) {
  Rig bare = load_rig("prototype_b");
  bare.wind.reset();
  bare.rotor_drive.reset();
  bare.sensors.reset();
  const Spoil as_it_is = [](request_t&) {};
  expect_refused("wind", good_disturbance(request_t::WIND), as_it_is, "no [wind]", bare);
  expect_refused("rotor", good_fault(request_t::ROTOR_LOSS), as_it_is, "[rotor_drive]", bare);
  for (int kind = request_t::SENSOR_STUCK; kind <= request_t::SENSOR_DELAYED; ++kind) {
    expect_refused("sensor", good_fault(kind), as_it_is, "no [sensors]", bare);
  }
  for (const std::int32_t target : {1, -2, 1 << 30}) {
    const Spoil other = [target](request_t& r) { r.target = target; };
    expect_refused("drive", good_fault(request_t::DRIVE_WEAK), other, "1 drives");
  }
  for (const std::int32_t target : {4, -2, 1 << 30}) {
    const Spoil other = [target](request_t& r) { r.target = target; };
    expect_refused("rotor", good_fault(request_t::ROTOR_LOSS), other, "4 rotors");
  }
  for (const double brake : {-1.0, kNan, HUGE_VAL}) {
    const Spoil spoil = [brake](request_t& r) { r.level = brake; };
    expect_refused("brake", good_fault(request_t::ROTOR_LOSS), spoil, "level");
  }
  for (const double share : {-0.1, 1.0, kNan}) {
    const Spoil spoil = [share](request_t& r) { r.level = share; };
    expect_refused("share", good_fault(request_t::DRIVE_WEAK), spoil, "level");
  }
}

TEST(Refusals, SensorsThatAreNotThere) {
  const Rig platform = load_rig("prototype_b"), car = load_rig("double_brennan");
  for (int kind = request_t::SENSOR_STUCK; kind <= request_t::SENSOR_DELAYED; ++kind) {
    const auto refused = [&](std::int32_t target, const std::string& says, const Rig& rig) {
      const Spoil other = [target](request_t& r) { r.target = target; };
      expect_refused("sensor " + std::to_string(target), good_fault(kind), other, says, rig);
    };
    for (const std::int32_t target : {0, -1, 3, 512, 1 << 30, std::numeric_limits<int>::min()}) {
      refused(target, "one VALID_*", platform);
    }
    refused(sensors_t::VALID_LOAD_CELL, "no such sensor", platform);
    refused(sensors_t::VALID_CURRENTS, "no such sensor", car);
    refused(sensors_t::VALID_DISC, "no such sensor", car);
  }
}

TEST(Refusals, SensorFaultsThatCannotBeMeant) {
  for (const double level : {0.0, kNan, HUGE_VAL}) {
    const Spoil spoil = [level](request_t& r) { r.level = level; };
    expect_refused("bias", good_fault(request_t::SENSOR_BIASED), spoil, "level");
    expect_refused("noise", good_fault(request_t::SENSOR_NOISY), spoil, "level");
  }
  for (const std::int64_t delay : {std::int64_t{0}, std::int64_t{-1}, kLast}) {
    const Spoil spoil = [delay](request_t& r) { r.delay_ns = delay; };
    expect_refused("delay", good_fault(request_t::SENSOR_DELAYED), spoil, "delay_ns");
  }
  for (const int kind : {+request_t::SENSOR_BIASED, +request_t::SENSOR_NOISY}) {
    const Spoil on_estop = [](request_t& r) { r.target = sensors_t::VALID_ESTOP; };
    expect_refused("E-stop", good_fault(kind), on_estop, "no number");
  }
}

// A car on one rail rolls and does nothing else.
TEST(Refusals, WhatNothingOnTheMachineFeels) {
  const Rig car = load_rig("brennan_monorail", support::with_everything());
  const Spoil as_it_is = [](request_t&) {};
  const auto refused = [&](const request_t& request, const std::string& says) {
    expect_refused(says, request, as_it_is, says, car);
  };
  for (int kind = request_t::LOAD; kind <= request_t::GUST; ++kind) {
    request_t load = good_disturbance(kind);
    load.moment_nm[1] = 1.0;
    refused(load, "moment about y");
    load = good_disturbance(kind);
    load.force_n[0] = 1e-3;
    refused(load, "force along x");
    load = good_disturbance(kind);
    load.force_n[1] = 1e-3;
    ScheduleBench bench("brennan_monorail");
    EXPECT_NE(bench.add(load), 0) << get_text(bench.reply.text);
  }
  request_t wind = good_disturbance(request_t::WIND);
  wind.direction_rad = 0.0;
  wind.turbulence_m_s = wind.length_m = 0.0;
  refused(wind, "direction_rad");
  refused(good_disturbance(request_t::DECELERATION), "deceleration along x");
  request_t mass = good_disturbance(request_t::ADDED_MASS);
  mass.position_m[2] = 0.0;
  mass.position_m[0] = 3.0;
  refused(mass, "off the pivot");

  ScheduleBench bench("brennan_monorail");
  wind.turbulence_m_s = 1.0;
  wind.length_m = 50.0;
  EXPECT_NE(bench.add(wind), 0) << "its gusts come from the side";
  EXPECT_NE(bench.add(good_disturbance(request_t::TURN)), 0) << get_text(bench.reply.text);
}

TEST(Refusals, TooMany) {
  ScheduleBench bench;
  const request_t load = good_disturbance(request_t::LOAD);
  for (int i = 0; i < Schedule::kCapacity; ++i) EXPECT_EQ(bench.add(load), i + 1);
  EXPECT_EQ(bench.add(load), 0);
  EXPECT_EQ(bench.add(good_fault(request_t::COMMAND_LOST)), 0);
  EXPECT_TRUE(bench.schedule.cancel(7, bench.reply));
  EXPECT_EQ(bench.add(load), Schedule::kCapacity + 1);
}

}  // namespace
}  // namespace gyrotwin
