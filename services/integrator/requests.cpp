// The integrator's answers to operators: refuse with a reason and a fix, or apply and say when.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/integrator/integrator.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr double kSlowest = 0.01, kFastest = 100.0;        // speed factor
constexpr std::int64_t kMostSteps = 1'000'000;             // [tick]
constexpr double kLongest = 3600.0;                        // disturbance [s]
constexpr std::int64_t kLastTick = 1'000'000'000'000'000;  // decades, and sums of it fit
constexpr double kStrongest = 1e9;                         // disturbance [N], [N m]

template <std::size_t N>
bool all_within(const double (&x)[N], double limit) {
  return std::all_of(std::begin(x), std::end(x),
                     [limit](double value) { return std::abs(value) <= limit; });
}

std::optional<Event> event_of(std::int32_t verb) {
  switch (verb) {
    case request_t::ARM:
      return Event::kArm;
    case request_t::DISARM:
      return Event::kDisarm;
    case request_t::PAUSE:
      return Event::kPause;
    case request_t::RESUME:
      return Event::kResume;
    case request_t::STEP:
      return Event::kStep;
    default:
      return std::nullopt;
  }
}

template <class... Args>
bool refuse(reply_t& reply, fmt::format_string<Args...> why, Args&&... args) {
  reply.result = reply_t::REFUSED;
  set_text(reply.text, why, std::forward<Args>(args)...);
  return false;
}

}  // namespace

void Integrator::on_request(const request_t& request, const Surroundings& surroundings,
                            reply_t& reply) noexcept {
  const reply_t* last = askers_.last(request.writer);
  if (last != nullptr && last->request_counter == request.counter) {
    reply = *last;  // asked again because the answer got lost
    return;
  }
  reply = {};
  reply.request_writer = request.writer;
  reply.request_counter = request.counter;
  reply.verb = request.verb;
  reply.result = reply_t::APPLIED;
  reply.applied_tick = tick_;
  if (request.owner_epoch != epoch_) {
    refuse(reply, "meant for another run of this owner; ask again");
    return;
  }
  if (last != nullptr && request.counter < last->request_counter) {
    refuse(reply, "the counter was used already; count on");
    return;
  }
  if (act(request, surroundings, reply)) {
    request_writer_ = request.writer;
    request_counter_ = request.counter;
  }
  askers_.remember(reply);
}

bool Integrator::act(const request_t& request, const Surroundings& surroundings,
                     reply_t& reply) noexcept {
  if (request.verb == request_t::RESET) return reset(request, surroundings.fresh_epoch, reply);
  if (request.verb == request_t::DISTURB) return disturb(request, reply);
  if (request.verb == request_t::CLEAR) {
    set_text(reply.text, "{} disturbances cleared", disturbances_.count());
    disturbances_.clear();
    return true;
  }
  if (request.verb == request_t::SPEED) {
    if (rig_.loop.clock == ClockMode::kLockstep) {
      return refuse(reply, "lockstep has no speed: it steps when the controller answers");
    }
    if (!(request.speed_factor >= kSlowest && request.speed_factor <= kFastest)) {
      return refuse(reply, "speed must be {} to {}", kSlowest, kFastest);
    }
    speed_ = request.speed_factor;
    set_text(reply.text, "speed {}", speed_);
    return true;
  }

  const std::optional<Event> event = event_of(request.verb);
  if (!event) return refuse(reply, "verb {} is not known to this owner", request.verb);
  const std::optional<Mode> to = next(mode_, *event);
  if (!to) {
    return refuse(reply, "not possible in {}; see gyrotwin ctl modes", name_of(mode_));
  }
  if (*event == Event::kArm) {
    if (surroundings.other_owner_heard) {
      return refuse(reply, "another owner speaks for this rig; stop one of the two");
    }
    if (!surroundings.controller_heard && rig_.loop.clock != ClockMode::kFree) {
      return refuse(reply,
                    "no controller is heard; start gyrotwin-controller with the same rig file");
    }
  }
  if (*event == Event::kStep) {
    if (request.step_ticks < 1 || request.step_ticks > kMostSteps) {
      return refuse(reply, "step takes 1 to {} ticks", kMostSteps);
    }
    steps_left_ = request.step_ticks;
  }
  enter(*event, "");
  set_text(reply.text, "{}", name_of(mode_));
  return true;
}

bool Integrator::reset(const request_t& request, std::int64_t fresh_epoch,
                       reply_t& reply) noexcept {
  model::State initial = machine_.state(rig_.initial_q, rig_.initial_v);
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
  enter(Event::kReset, "");
  epoch_ = fresh_epoch;
  tick_ = recorded_ = 0;
  lying_ = false;
  disturbances_.clear();
  gate_.reset(epoch_);
  input_ = {};
  plant_.set_state(initial);
  truth_ = machine_.truth(initial, input_);
  reply.applied_tick = 0;
  set_text(reply.text, "HELD at the {} initial state",
           request.initial_given != 0 ? "requested" : "rig file's");
  return true;
}

bool Integrator::disturb(const request_t& request, reply_t& reply) noexcept {
  if (mode_ == Mode::kFallen || mode_ == Mode::kFault) {
    return refuse(reply, "{}: nothing to push; ctl reset first", name_of(mode_));
  }
  if (mode_ == Mode::kHeld && request.start_tick <= 0) {
    return refuse(reply, "HELD: the plant is held; ctl arm first, or name a start tick");
  }
  if (!all_within(request.force_n, kStrongest) || !all_within(request.moment_nm, kStrongest)) {
    return refuse(reply, "force and moment must be finite and within {} N, N m", kStrongest);
  }
  const bool step = request.disturbance == request_t::STEP_LOAD;
  if (!step && request.disturbance != request_t::IMPULSE) {
    return refuse(reply, "disturbance {} is not known to this owner", request.disturbance);
  }
  const auto longest = static_cast<std::int64_t>(kLongest * 1e9);
  if (request.duration_ns < (step ? 0 : 1) || request.duration_ns > longest) {
    return refuse(reply, "duration must be {} to {} s", step ? "0 (until clear)" : "more than 0",
                  kLongest);
  }
  if (request.start_tick > kLastTick) return refuse(reply, "start ticks end at {}", kLastTick);
  if (request.start_tick != 0 && request.start_tick < tick_) {
    return refuse(reply, "tick {} is over, it is {} now", request.start_tick, tick_);
  }

  Disturbance disturbance;
  disturbance.force = Eigen::Map<const Eigen::Vector3d>(request.force_n);
  disturbance.moment = Eigen::Map<const Eigen::Vector3d>(request.moment_nm);
  disturbance.begin = std::max(request.start_tick, tick_);
  const std::int64_t period = rig_.loop.tick_ns();
  const std::int64_t length =
      std::max<std::int64_t>(1, (request.duration_ns + period / 2) / period);
  disturbance.end = request.duration_ns == 0 ? Disturbance::kForever : disturbance.begin + length;
  if (!disturbances_.add(disturbance)) {
    return refuse(reply, "{} disturbances are active or scheduled already; clear first",
                  Disturbances::kCapacity);
  }
  reply.applied_tick = disturbance.begin;
  if (disturbance.end == Disturbance::kForever) {
    set_text(reply.text, "from tick {} until clear", disturbance.begin);
  } else {
    set_text(reply.text, "ticks {} to {}", disturbance.begin, disturbance.end - 1);
  }
  return true;
}

}  // namespace gyrotwin
