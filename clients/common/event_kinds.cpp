#include <array>
#include <cmath>

#include "clients/common/event.hpp"

namespace gyrotwin {

namespace {

using Form = Quantity::Form;
using Need = Quantity::Need;
using Choice = EventKind::Choice;

constexpr Unit kNone{"", ""};
constexpr Unit kSecond{"s", "s"}, kHertz{"Hz", "hz"};
constexpr Unit kNewton{"N", "n"}, kNewtonSecond{"N s", "ns"};
constexpr Unit kNewtonMetre{"N m", "nm"}, kNewtonMetreSecond{"N m s", "nms"};
constexpr Unit kMetre{"m", "m"}, kMetrePerSecond{"m/s", "m_s"}, kMetrePerSecond2{"m/s^2", "m_s2"};
constexpr Unit kRadian{"rad", "rad"}, kRadianPerSecond{"rad/s", "rad_s"};
constexpr Unit kKilogram{"kg", "kg"}, kAmpere{"A", "a"}, kVolt{"V", "v"};

constexpr Range kStrength{.low = -1e9, .high = 1e9};
constexpr Range kSpan{.low = 0.0, .high = 3600.0, .above_low = true};  // [s]
constexpr Range kFrequency{.low = 0.0, .high = 1e4, .above_low = true};

std::int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

template <std::size_t... N>
constexpr auto join(const std::array<Quantity, N>&... parts) {
  std::array<Quantity, (N + ...)> all{};
  std::size_t i = 0;
  const auto take = [&](const auto& part) {
    for (const Quantity& quantity : part) all[i++] = quantity;
  };
  (take(parts), ...);
  return all;
}

// When.

constexpr Quantity kDuration{"duration", kSecond,
                             "How long it lasts, rounded to ticks; default: until cancelled", kSpan,
                             [](request_t& r, double x) { r.duration_ns = nanoseconds(x); }};
constexpr Quantity kRise{"rise", kSecond, "Grows linearly to full strength for so long", kSpan,
                         [](request_t& r, double x) { r.rise_ns = nanoseconds(x); }};
constexpr Quantity kSeed{"seed",
                         kNone,
                         "Of the random numbers; default 0; the same seed gives the same ones",
                         {.low = 0.0, .high = 1e15},
                         [](request_t& r, double x) { r.seed = std::llround(x); },
                         Form::kWhole};

constexpr Quantity required(Quantity quantity, std::string_view what) {
  quantity.need = Need::kRequired;
  quantity.what = what;
  return quantity;
}

// Loads.

constexpr std::array<Quantity, 6> loads(Unit moment, Unit force) {
  const auto load = [](std::string_view name, Unit unit, std::string_view what,
                       void (*set)(request_t&, double)) {
    return Quantity{name, unit, what, kStrength, set, Form::kNumber, Need::kChoice};
  };
  return {
      {load("roll", moment, "Moment about x, forward",
            [](request_t& r, double x) { r.moment_nm[0] = x; }),
       load("pitch", moment, "About y, left", [](request_t& r, double x) { r.moment_nm[1] = x; }),
       load("yaw", moment, "About z, up", [](request_t& r, double x) { r.moment_nm[2] = x; }),
       load("push_x", force, "Force along x, at the structure's centre of mass",
            [](request_t& r, double x) { r.force_n[0] = x; }),
       load("push_y", force, "Along y", [](request_t& r, double x) { r.force_n[1] = x; }),
       load("push_z", force, "Along z", [](request_t& r, double x) { r.force_n[2] = x; })}};
}
constexpr auto kLoads = loads(kNewtonMetre, kNewton);

constexpr Quantity kImpulseDuration{"duration", kSecond,
                                    "How long it lasts, rounded to ticks; default: the rig's "
                                    "impulse_duration_s",
                                    kSpan, kDuration.set};
constexpr auto kImpulse =
    join(loads(kNewtonMetreSecond, kNewtonSecond), std::array{kImpulseDuration});
constexpr auto kStep = join(kLoads, std::array{kDuration, kRise});
constexpr auto kRamp = join(
    kLoads, std::array{required(kRise, "Until it is at full strength, where it stays"), kDuration});

constexpr auto kSine = join(
    kLoads, std::array{Quantity{"frequency", kHertz, "Of the sine, which begins at 0", kFrequency,
                                [](request_t& r, double x) { r.frequency_hz[0] = x; },
                                Form::kNumber, Need::kRequired},
                       kDuration, kRise});

constexpr auto kChirp = join(
    kLoads, std::array{Quantity{"from", kHertz, "Frequency at the beginning", kFrequency,
                                [](request_t& r, double x) { r.frequency_hz[0] = x; },
                                Form::kNumber, Need::kRequired},
                       Quantity{"to", kHertz, "At the end", kFrequency,
                                [](request_t& r, double x) { r.frequency_hz[1] = x; },
                                Form::kNumber, Need::kRequired},
                       required(kDuration, "How long it takes from the one to the other"), kRise});

constexpr auto kGust =
    join(kLoads, std::array{Quantity{"correlation", kSecond, "Correlation time", kSpan,
                                     [](request_t& r, double x) { r.correlation_s = x; },
                                     Form::kNumber, Need::kOptional, 1.0},
                            kSeed, kDuration, kRise});

// What drives into it and what rides on it.

constexpr auto kWind =
    join(std::array{Quantity{"speed",
                             kMetrePerSecond,
                             "Mean air speed",
                             {.low = 0.0, .high = 1e3},
                             [](request_t& r, double x) { r.speed_m_s = x; },
                             Form::kNumber,
                             Need::kRequired},
                    Quantity{"direction", kRadian, "Where it blows to, about z from x; default 0",
                             kStrength, [](request_t& r, double x) { r.direction_rad = x; }},
                    Quantity{"turbulence",
                             kMetrePerSecond,
                             "Root mean square of the Dryden turbulence",
                             {.low = 0.0, .high = 1e3},
                             [](request_t& r, double x) { r.turbulence_m_s = x; }},
                    Quantity{"length", kMetre, "Scale length of the turbulence, which needs one",
                             kPositive, [](request_t& r, double x) { r.length_m = x; }},
                    kSeed, kDuration, kRise});

constexpr auto kTurn = join(std::array{
    Quantity{"speed",
             kMetrePerSecond,
             "Ground speed along x",
             {.low = 0.0, .high = 1e3},
             [](request_t& r, double x) { r.speed_m_s = x; },
             Form::kNumber,
             Need::kRequired},
    Quantity{"yaw_rate", kRadianPerSecond, "Of the support, > 0 to the left", kStrength,
             [](request_t& r, double x) { r.yaw_rate_rad_s = x; }, Form::kNumber, Need::kRequired},
    kDuration, kRise});

constexpr auto kBrake =
    join(std::array{Quantity{"deceleration", kMetrePerSecond2, "Along x; < 0 accelerates",
                             kStrength, [](request_t& r, double x) { r.deceleration_m_s2 = x; },
                             Form::kNumber, Need::kRequired},
                    kDuration, kRise});

constexpr auto kMass = join(std::array{
    Quantity{"mass", kKilogram, "Point mass fixed to the structure", kPositive,
             [](request_t& r, double x) { r.mass_kg = x; }, Form::kNumber, Need::kRequired},
    Quantity{"x", kMetre, "Where, structure axes, from the ground pivot", kStrength,
             [](request_t& r, double x) { r.position_m[0] = x; }},
    Quantity{"y", kMetre, "Likewise", kStrength,
             [](request_t& r, double x) { r.position_m[1] = x; }},
    Quantity{"z", kMetre, "Likewise", kStrength,
             [](request_t& r, double x) { r.position_m[2] = x; }},
    kDuration});

// Faults.

constexpr auto kSensor = join(
    std::array{Quantity{"stuck", kNone, "Says what it said last", kAnyNumber,
                        [](request_t& r, double) { r.kind = request_t::SENSOR_STUCK; }, Form::kFlag,
                        Need::kChoice},
               Quantity{"bias", kTargetsUnit, "Is off by so much", kStrength,
                        [](request_t& r, double x) {
                          r.kind = request_t::SENSOR_BIASED;
                          r.level = x;
                        },
                        Form::kNumber, Need::kChoice},
               Quantity{"noise", kTargetsUnit, "Standard deviation of what is added to each sample",
                        kNotNegative,
                        [](request_t& r, double x) {
                          r.kind = request_t::SENSOR_NOISY;
                          r.level = x;
                        },
                        Form::kNumber, Need::kChoice},
               Quantity{"drop", kNone, "Is not heard", kAnyNumber,
                        [](request_t& r, double) { r.kind = request_t::SENSOR_DROPPED; },
                        Form::kFlag, Need::kChoice},
               Quantity{"delay", kSecond, "Says what it said so long ago, rounded to ticks", kSpan,
                        [](request_t& r, double x) {
                          r.kind = request_t::SENSOR_DELAYED;
                          r.delay_ns = nanoseconds(x);
                        },
                        Form::kNumber, Need::kChoice},
               kSeed, kDuration});

constexpr auto kDrive = std::array{Quantity{"strength",
                                            kNone,
                                            "Share of the torque that is left; 0: dead",
                                            {.low = 0.0, .high = 1.0},
                                            [](request_t& r, double x) { r.level = x; },
                                            Form::kNumber,
                                            Need::kRequired},
                                   kDuration};

constexpr auto kRotor =
    std::array{Quantity{"drag", kNewtonMetre, "Brakes the unpowered rotor so much more",
                        kNotNegative, [](request_t& r, double x) { r.level = x; }},
               kDuration};

constexpr auto kLink = std::array{kDuration};

constexpr std::array kSensors{
    Target{"gyro", sensors_t::VALID_GYRO, kRadianPerSecond},
    Target{"acceleration", sensors_t::VALID_ACCELEROMETER, kMetrePerSecond2},
    Target{"disc", sensors_t::VALID_DISC, kRadian},
    Target{"gimbals", sensors_t::VALID_GIMBALS, kRadian},
    Target{"rotors", sensors_t::VALID_ROTORS, kRadianPerSecond},
    Target{"currents", sensors_t::VALID_CURRENTS, kAmpere},
    Target{"voltage", sensors_t::VALID_BUS_VOLTAGE, kVolt},
    Target{"load_cell", sensors_t::VALID_LOAD_CELL, kNewton},
};
constexpr std::array kNumbered{Target{"0", 0}, Target{"1", 1}, Target{"2", 2}, Target{"3", 3},
                               Target{"all", -1}};

constexpr std::array kKinds{
    EventKind{"impulse", "A short push; without a direction the rig's reference push about x",
              request_t::DISTURB, request_t::LOAD, kImpulse},
    EventKind{"step", "A constant load", request_t::DISTURB, request_t::LOAD, kStep, Choice::kAny},
    EventKind{"ramp", "A load that grows and stays", request_t::DISTURB, request_t::LOAD, kRamp,
              Choice::kAny},
    EventKind{"sine", "A load that swings; its numbers are the amplitude", request_t::DISTURB,
              request_t::SINE, kSine, Choice::kAny},
    EventKind{"chirp", "A sine whose frequency runs", request_t::DISTURB, request_t::CHIRP, kChirp,
              Choice::kAny},
    EventKind{"gust", "A random load with Dryden's spectrum; its numbers are the root mean square",
              request_t::DISTURB, request_t::GUST, kGust, Choice::kAny},
    EventKind{"wind", "Air that presses on the structure, for a rig with [wind]",
              request_t::DISTURB, request_t::WIND, kWind},
    EventKind{"turn", "The support drives a bend: centrifugal force, and the frame turns",
              request_t::DISTURB, request_t::TURN, kTurn},
    EventKind{"brake", "The support slows down", request_t::DISTURB, request_t::DECELERATION,
              kBrake},
    EventKind{"mass", "A mass is put on the structure", request_t::DISTURB, request_t::ADDED_MASS,
              kMass},
    EventKind{"sensor", "A sensor of the rig fails", request_t::FAULT, 0, kSensor, Choice::kOne,
              kSensors},
    EventKind{"drive", "A drive is weak or dead", request_t::FAULT, request_t::DRIVE_WEAK, kDrive,
              Choice::kNone, kNumbered},
    EventKind{"rotor", "A rotor loses its power and coasts down", request_t::FAULT,
              request_t::ROTOR_LOSS, kRotor, Choice::kNone, kNumbered},
    EventKind{"link", "The controller's commands are lost on their way", request_t::FAULT,
              request_t::COMMAND_LOST, kLink},
};

}  // namespace

std::span<const EventKind> event_kinds() { return kKinds; }

}  // namespace gyrotwin
