// The integrator's answers to operators: refuse with a reason and a fix, or apply and say when.
#include <algorithm>
#include <cmath>

#include "services/integrator/integrator.hpp"
#include "services/runtime/refuse.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kMostSteps = 1'000'000;  // [tick]
// Shares of their nominal speed at which rotors count as up, and as down.
constexpr double kUp = 0.99, kDown = 0.01;

}  // namespace

bool Integrator::act(const request_t& request, const Surroundings& surroundings,
                     reply_t& reply) noexcept {
  switch (request.verb) {
    case request_t::RESET:
      reset(request, surroundings.fresh_epoch, reply);
      break;
    case request_t::SPEED:
      set_speed(request, reply);
      break;
    case request_t::DISTURB:
    case request_t::FAULT:
      schedule(request, reply);
      break;
    case request_t::CANCEL:
      schedule_.cancel(request.id, reply);
      break;
    case request_t::CLEAR:
      set_text(reply.text, "{} disturbances and {} faults ended", schedule_.disturbances(),
               schedule_.faults());
      schedule_.clear();
      break;
    case request_t::ROTORS:
      set_rotors(request, reply);
      break;
    case request_t::STEP:
      step(request, surroundings, reply);
      break;
    default:
      if (change_mode(request, surroundings, reply) && request.verb == request_t::ARM &&
          rotor_share() < kUp) {
        set_text(reply.text, "{}, rotors at {:.0f} % of their nominal speed", name_of(mode()),
                 100.0 * rotor_share());
      }
  }
  return true;
}

bool Integrator::step(const request_t& request, const Surroundings& surroundings,
                      reply_t& reply) noexcept {
  const bool possible = next(mode(), Event::kStep).has_value();
  if (possible && (request.step_ticks < 1 || request.step_ticks > kMostSteps)) {
    return refuse(reply, "step takes 1 to {} ticks", kMostSteps);
  }
  if (!change_mode(request, surroundings, reply)) return false;
  steps_left_ = request.step_ticks;
  return true;
}

bool Integrator::set_speed(const request_t& request, reply_t& reply) noexcept {
  if (rig_.loop.clock == ClockMode::kLockstep) {
    return refuse(reply, "lockstep has no speed: it steps when the controller answers");
  }
  if (!(request.speed_factor >= kSlowestSpeed && request.speed_factor <= kFastestSpeed)) {
    return refuse(reply, "speed must be {} to {}", kSlowestSpeed, kFastestSpeed);
  }
  speed_ = request.speed_factor;
  set_text(reply.text, "speed {}", speed_);
  return true;
}

bool Integrator::reset(const request_t& request, std::int64_t fresh_epoch,
                       reply_t& reply) noexcept {
  model::State initial = rig_.initial_state(machine_);
  if (request.initial_given != 0) {
    const int n = machine_.coordinates();
    std::copy_n(request.initial_q, n, initial.q.data());
    std::copy_n(request.initial_v, n, initial.v.data());
    if (!initial.finite()) return refuse(reply, "the initial state must be finite");
    if (machine_.tilt(initial) > rig_.safety.fall_tilt_rad) {
      return refuse(reply, "the initial tilt is beyond safety.fall_tilt_rad = {}",
                    rig_.safety.fall_tilt_rad);
    }
  }
  begin_run(fresh_epoch);
  recorded_ = 0;
  unobeyed_tick_ = -1;
  rotors_asked_.reset();
  schedule_.reset();
  stand(initial);
  reply.applied_tick = 0;
  set_text(reply.text, "HELD at the {} initial state",
           request.initial_given != 0 ? "requested" : "rig file's");
  return true;
}

bool Integrator::schedule(const request_t& request, reply_t& reply) noexcept {
  if (mode() == Mode::kFallen || mode() == Mode::kFault) {
    return refuse(reply, "{}: nothing to disturb; ctl reset first", name_of(mode()));
  }
  if (mode() == Mode::kHeld && request.start_tick <= 0) {
    return refuse(reply, "HELD: the plant is held; ctl arm first, or name a start tick");
  }
  return schedule_.add(request, tick_, reply);
}

bool Integrator::set_rotors(const request_t& request, reply_t& reply) noexcept {
  if (!machine_.rotor_drive) {
    return refuse(reply, "rotors of this rig keep their speed; give its file [rotor_drive]");
  }
  if (request.kind != request_t::SPIN_UP && request.kind != request_t::SPIN_DOWN) {
    return refuse(reply, "kind of ROTORS must be SPIN_UP or SPIN_DOWN");
  }
  if (mode() == Mode::kFault) return refuse(reply, "FAULT: nothing runs; ctl reset first");
  const bool up = request.kind == request_t::SPIN_UP;
  rotors_asked_ = up;
  const std::string_view what = up ? "spin up" : "coast down";
  const double goal = 100.0 * (up ? kUp : kDown);
  const double seconds = rotor_time(up);
  if (seconds == 0.0) {
    set_text(reply.text, "{}: at {:.0f} % of nominal speed already", what, goal);
  } else if (std::isfinite(seconds)) {
    set_text(reply.text, "{}: {:.0f} % of nominal speed in about {:.{}f} s", what, goal, seconds,
             seconds < 10.0 ? 1 : 0);
  } else {
    set_text(reply.text, "{}, but {:.0f} % of nominal speed will not be reached", what, goal);
  }
  return true;
}

/// Of the slowest rotor, speed over nominal speed; 1 without rotors.
double Integrator::rotor_share() const noexcept {
  double share = 1.0;
  for (int j = 0; j < machine_.rotors; ++j) {
    share = std::min(share, plant_.state().rotor_speed[j] / machine_.nominal_rotor_speed[j]);
  }
  return share;
}

/// Until the last rotor is up, or down [s]; infinite when one stops short of that.
double Integrator::rotor_time(bool powered) const noexcept {
  constexpr int kParts = 200;  // of the way, each at its middle's acceleration
  const double goal = powered ? kUp : kDown;
  model::Input input;
  input.rotor_powered.fill(powered);
  model::RotorSpeeds step{};
  model::State state = plant_.state();
  for (int j = 0; j < machine_.rotors; ++j) {
    const double way = goal * machine_.nominal_rotor_speed[j] - state.rotor_speed[j];
    const bool there = powered ? way <= 0.0 : way >= 0.0;
    step[j] = there ? 0.0 : way / kParts;
    state.rotor_speed[j] += 0.5 * step[j];
  }
  model::RotorSpeeds time{};
  for (int k = 0; k < kParts; ++k) {
    const model::RotorSpeeds rate = machine_.rotor_acceleration(state, input);
    for (int j = 0; j < machine_.rotors; ++j) {
      if (step[j] == 0.0) continue;
      time[j] += step[j] * rate[j] > 0.0 ? step[j] / rate[j] : HUGE_VAL;
      state.rotor_speed[j] += step[j];
    }
  }
  return *std::max_element(time.begin(), time.end());
}

}  // namespace gyrotwin
