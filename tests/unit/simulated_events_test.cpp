// simulate with a scenario against owner and controller themselves: the same bits, tick by tick.
#include <gtest/gtest.h>

#include "clients/common/scenario.hpp"
#include "clients/simulate/simulation.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/closed_loop.hpp"

namespace gyrotwin {
namespace {

using support::ClosedLoop;

/// Every kind of disturbance, and what drives and rotors can suffer.
constexpr const char* kEverything = R"(
[[event]]
kind = "impulse"
at_s = 0.1
roll_nms = 0.1
[[event]]
kind = "ramp"
at_s = 0.2
roll_nm = 0.2
rise_s = 0.1
duration_s = 0.3
[[event]]
kind = "sine"
at_s = 0.0
push_y_n = 0.5
frequency_hz = 3.0
[[event]]
kind = "chirp"
at_s = 0.3
roll_nm = 0.1
from_hz = 1.0
to_hz = 20.0
duration_s = 0.5
[[event]]
kind = "gust"
at_s = 0.2
roll_nm = 0.2
seed = 5
[[event]]
kind = "wind"
at_s = 0.4
speed_m_s = 2.0
direction_rad = 1.2
turbulence_m_s = 0.5
length_m = 10.0
[[event]]
kind = "turn"
at_s = 0.3
speed_m_s = 1.0
yaw_rate_rad_s = 0.05
duration_s = 0.4
[[event]]
kind = "brake"
at_s = 0.6
deceleration_m_s2 = 0.1
rise_s = 0.1
[[event]]
kind = "mass"
at_s = 0.7
mass_kg = 0.05
x_m = 0.05
y_m = 0.02
z_m = 0.3
[[event]]
kind = "drive"
at_s = 0.5
drive = 0
strength = 0.8
duration_s = 0.2
[[event]]
kind = "rotor"
at_s = 0.3
rotor = 1
drag_nm = 0.01
)";

constexpr const char* kSensors = R"(
[[event]]
kind = "sensor"
sensor = "gyro"
at_s = 0.1
bias_rad_s = 0.02
[[event]]
kind = "sensor"
sensor = "acceleration"
at_s = 0.2
noise_m_s2 = 0.3
seed = 3
duration_s = 0.4
[[event]]
kind = "sensor"
sensor = "gimbals"
at_s = 0.3
delay_s = 0.002
duration_s = 0.2
[[event]]
kind = "sensor"
sensor = "rotors"
at_s = 0.3
stuck = true
[[event]]
kind = "sensor"
sensor = "acceleration"
at_s = 0.7
drop = true
[[event]]
kind = "impulse"
at_s = 0.5
roll_nms = 0.1
)";

/// Once for less than the timeout, once for good.
constexpr const char* kLink = R"(
[[event]]
kind = "link"
at_s = 0.1
duration_s = 0.005
[[event]]
kind = "impulse"
at_s = 0.15
roll_nms = 0.05
[[event]]
kind = "link"
at_s = 0.5
)";

struct Case {
  const char* name;
  const char* rig;
  std::vector<std::string> overrides;
  const char* scenario;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

Scenario scenario_of(const Rig& rig, const model::Machine& machine, const char* text,
                     double duration) {
  Scenario scenario;
  scenario.start = rig.initial_state(machine);
  scenario.duration = duration;
  scenario.sample = rig.loop.tick_s();
  scenario.stepping.substeps = rig.loop.substeps;
  for (const PlannedEvent& planned : read_scenario(text, "s.toml")) {
    scenario.events.push_back({request_of(planned, rig, rig.loop.tick_ns(), 0), planned.place});
  }
  return scenario;
}

/// Runs the live cores beside the simulation and compares what both show.
class Beside : public Spectator {
 public:
  explicit Beside(ClosedLoop& loop) : loop_(loop) {}

  void sample(const Sample& sample) override {
    if (samples_++ > 0) loop_.run_ticks(1);
    const model::State& live = loop_.integrator.plant().state();
    same_ = same_ && live.q == sample.state.q && live.v == sample.state.v &&
            live.rotor_speed == sample.state.rotor_speed;
    state_t said;
    loop_.integrator.fill(said);
    if (sample.estimate != nullptr) {
      same_ = same_ && said.tilt_rad[0] == sample.estimate->tilt[0] &&
              said.tilt_rate_rad_s[0] == sample.estimate->tilt_rate[0] &&
              said.gimbal_rate_rad_s[0] == sample.estimate->gimbal_rate[0];
    }
    if (same_) last_same_ = sample.t;
  }
  bool go_on(const Outcome&) override { return same_; }

  int samples() const { return samples_; }
  bool same() const { return same_; }
  double last_same() const { return last_same_; }

 private:
  ClosedLoop& loop_;
  int samples_ = 0;
  bool same_ = true;
  double last_same_ = -1.0;
};

class SimulatedEvents : public testing::TestWithParam<Case> {};

TEST_P(SimulatedEvents, AreThoseOfTheLiveOwner) {
  const Case& c = GetParam();
  ClosedLoop loop(c.rig, c.overrides);
  const model::Machine machine = loop.rig.build_machine();
  const Scenario scenario = scenario_of(loop.rig, machine, c.scenario, 1.0);
  for (const Scenario::Event& event : scenario.events) {
    const reply_t reply = loop.ask(event.request.verb, event.request);
    ASSERT_EQ(reply.result, reply_t::APPLIED) << event.place << ": " << reply.text;
  }
  loop.arm();
  Beside beside(loop);
  const Outcome outcome = simulate(loop.rig, machine, scenario, beside);
  EXPECT_TRUE(beside.same()) << "until " << beside.last_same() << " s";
  EXPECT_EQ(beside.samples(), std::lround(1.0 / loop.rig.loop.tick_s()) + 1);
  const bool stopped = loop.integrator.mode() == Mode::kSafeStop;
  EXPECT_EQ(outcome.safe_stop_at.has_value(), stopped);
  EXPECT_EQ(stopped, c.scenario == kLink);
}

const std::vector<std::string> kEstimate{"loop.state=estimate"};
INSTANTIATE_TEST_SUITE_P(
    Rigs, SimulatedEvents,
    testing::Values(Case{"umbrella", "prototype_b", {}, kEverything},
                    Case{
                        "gimballed", "double_brennan", {"loop.command_delay_ticks=2"}, kEverything},
                    Case{"estimate", "prototype_b", kEstimate, kSensors},
                    Case{"gimballed_estimate", "double_brennan", kEstimate, kSensors},
                    Case{"everything_estimated", "double_brennan", kEstimate, kEverything},
                    Case{"zero_torque", "double_brennan", {"loop.command_delay_ticks=2"}, kLink},
                    Case{"brake",
                         "double_brennan",
                         {"safety.safe_stop=brake", "safety.safe_stop_gain_nms_per_rad=0.5"},
                         kLink},
                    Case{"hold_speed",
                         "prototype_b",
                         {"safety.safe_stop=hold_speed", "safety.safe_stop_gain_nms_per_rad=2"},
                         kLink}),
    [](const auto& test) { return std::string(test.param.name); });

std::string refusal(const char* text, bool sampled = true) {
  const Rig rig = load_rig("double_brennan");
  const model::Machine machine = rig.build_machine();
  Scenario scenario = scenario_of(rig, machine, text, 0.01);
  scenario.sampled = sampled;
  if (!sampled) scenario.stepping.kind = StepPolicy::Kind::kAdaptive;
  struct : Spectator {
    void sample(const Sample&) override {}
    bool go_on(const Outcome&) override { return true; }
  } nobody;
  try {
    simulate(rig, machine, scenario, nobody);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(SimulatedRefusals, NameTheEventAndTheReason) {
  const char* sensor = "[[event]]\nkind = \"sensor\"\nsensor = \"gyro\"\nat_s = 0\nstuck = true\n";
  EXPECT_NE(refusal(sensor).find("s.toml:1: the law does not hear the sensors here"),
            std::string::npos)
      << refusal(sensor);
  const char* drive = "\n[[event]]\nkind = \"drive\"\ndrive = 3\nat_s = 0\nstrength = 0\n";
  EXPECT_NE(refusal(drive).find("s.toml:2: refused: "), std::string::npos) << refusal(drive);
  const char* load = "[[event]]\nkind = \"step\"\nat_s = 0\nroll_nm = 1\n";
  EXPECT_EQ(refusal(load), "none");
  EXPECT_NE(refusal(load, false).find("need sampled feedback"), std::string::npos);
}

}  // namespace
}  // namespace gyrotwin
