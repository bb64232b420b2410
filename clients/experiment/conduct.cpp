#include "clients/experiment/conduct.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdio>

#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kLook = 100'000'000;      // between looks at go_on [ns]
constexpr std::int64_t kSilent = 2'000'000'000;  // without a tick [ns]
constexpr double kAtRest = 0.01;                 // share of the nominal speed
constexpr double kLongestSpinDown = 1800.0;      // [s]

request_t of_verb(std::int32_t verb, std::int32_t kind = 0) {
  request_t request{};
  request.verb = verb;
  request.kind = kind;
  return request;
}

/// Asks for the drives to be off when it goes, unless that was done.
class Guard {
 public:
  explicit Guard(Asker& asker) : asker_(asker) {}
  ~Guard() {
    if (!armed_) return;
    try {
      asker_.ask(of_verb(request_t::DISARM));  // refused where it has stopped by itself
      std::puts("disarmed");
    } catch (const std::exception& error) {
      std::fprintf(stderr, "NOT DISARMED: %s; press the E-stop\n", error.what());
    }
  }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  void arm() {
    armed_ = true;  // an answer that is lost may have been yes
    const reply_t reply = ask_or_throw(asker_, of_verb(request_t::ARM), "arm");
    std::printf("armed: %s\n", get_text(reply.text).c_str());
    std::fflush(stdout);
  }
  void disarm() {
    ask_or_throw(asker_, of_verb(request_t::DISARM), "disarm");
    armed_ = false;
  }

 private:
  Asker& asker_;
  bool armed_ = false;
};

/// Listens to STATE until `done`.
/// @throws NotDone when the owner falls silent, or may not go on
template <class Done>
void follow(Asker& asker, const std::function<bool()>& go_on, Done&& done) {
  std::int64_t heard_ns = asker.now_ns();
  for (bool over = false; !over;) {
    asker.listen(kLook, [&](const Reception& reception) {
      if (reception.channel != Channel::kState) return false;
      state_t state;
      Bus::decode(reception, state);
      heard_ns = asker.now_ns();
      over = done(state);
      return over;
    });
    if (!go_on()) throw NotDone("stopped");
    if (asker.now_ns() - heard_ns > kSilent) throw NotDone("no STATE is heard any more");
  }
}

/// Lets so much of the owner's time go by.
void let_pass(Asker& asker, const Rig& rig, double seconds, const std::function<bool()>& go_on) {
  std::int64_t end = -1;
  std::int64_t tick = -1;
  std::int64_t moved_ns = asker.now_ns();
  follow(asker, go_on, [&](const state_t& state) {
    if (state.header.tick != tick) moved_ns = asker.now_ns();
    if (asker.now_ns() - moved_ns > kSilent) throw NotDone("time stands still");
    tick = state.header.tick;
    if (end < 0) end = tick + std::llround(seconds / rig.loop.tick_s());
    if (state.mode == status_t::MODE_FALLEN || state.mode == status_t::MODE_FAULT) {
      throw NotDone(fmt::format("{} after {:.3g} s: what was recorded until then can be used",
                                state.mode == status_t::MODE_FAULT ? "FAULT" : "FALLEN",
                                rig.loop.tick_s() * static_cast<double>(tick)));
    }
    return tick >= end;
  });
}

/// Waits in HELD until the rotors stand.
void stop_rotors(Asker& asker, const Rig& rig, const std::function<bool()>& go_on) {
  if (!rig.rotor_drive) return;
  const reply_t reply =
      ask_or_throw(asker, of_verb(request_t::ROTORS, request_t::SPIN_DOWN), "rotors spin-down");
  std::printf("rotors: %s\n", get_text(reply.text).c_str());
  std::fflush(stdout);
  const model::Machine machine = rig.build_machine();
  const std::int64_t begin = asker.now_ns();
  follow(asker, go_on, [&](const state_t& state) {
    if (1e-9 * static_cast<double>(asker.now_ns() - begin) > kLongestSpinDown) {
      throw NotDone("the rotors do not come to rest");
    }
    bool at_rest = (state.valid & state_t::VALID_ROTORS) != 0;  // unknown is not at rest
    for (int j = 0; j < machine.rotors; ++j) {
      const double nominal = machine.nominal_rotor_speed[static_cast<std::size_t>(j)];
      at_rest &= std::abs(state.rotor_speed_rad_s[j]) <= kAtRest * std::abs(nominal);
    }
    return at_rest;
  });
}

request_t counterweight(const ExperimentPlan& plan) {
  request_t request = of_verb(request_t::DISTURB, request_t::ADDED_MASS);
  request.mass_kg = plan.mass_kg;
  request.position_m[2] = plan.mass_height_m;
  request.start_tick = 1;
  return request;
}

}  // namespace

std::optional<request_t> start_of(const ExperimentPlan& plan) {
  const bool swings = is_named(plan, "swing");
  if (!swings && !plan.kind->disc_pinned) return std::nullopt;
  request_t request = of_verb(request_t::RESET);
  request.initial_given = 1;  // upright and at rest
  if (swings) request.initial_q[0] = plan.tilt_rad;
  return request;
}

void conduct(const ExperimentPlan& plan, const Rig& rig, Asker& asker,
             const std::function<bool()>& go_on) {
  Guard guard(asker);
  const bool simulated = asker.owner().service == status_t::INTEGRATOR;
  if (simulated) {
    ask_or_throw(asker, start_of(plan).value_or(of_verb(request_t::RESET)), "reset");
  }
  if (plan.kind->rotors_at_rest) stop_rotors(asker, rig, go_on);
  if (simulated && is_named(plan, "swing")) {
    ask_or_throw(asker, counterweight(plan), "counterweight");
  }
  if (!go_on()) throw NotDone("stopped");
  guard.arm();
  if (is_named(plan, "run-down")) {
    ask_or_throw(asker, of_verb(request_t::ROTORS, request_t::SPIN_DOWN), "rotors spin-down");
  }
  if (is_named(plan, "coast-down")) let_pass(asker, rig, plan.driven_s, go_on);
  if (!is_named(plan, "free-run")) guard.disarm();
  let_pass(asker, rig, plan.watched_s, go_on);
}

}  // namespace gyrotwin
