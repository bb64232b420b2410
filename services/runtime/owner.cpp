#include "services/runtime/owner.hpp"

#include <optional>

#include "services/runtime/refuse.hpp"

namespace gyrotwin {

namespace {

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

}  // namespace

Owner::Owner(const Rig& rig, std::int64_t epoch)
    : rig_(rig),
      gate_(rig.safety.command_timeout_ticks, rig.loop.command_delay_ticks),
      epoch_(epoch) {
  gate_.reset(epoch);
}

void Owner::begin_run(std::int64_t epoch) noexcept {
  enter(Event::kReset, "");
  epoch_ = epoch;
  tick_ = 0;
  gate_.reset(epoch);
  askers_.begin_run();
}

void Owner::enter(Event event, std::string_view why) noexcept {
  const std::optional<Mode> to = next(mode_, event);
  if (!to) return;
  entering(event, *to);
  mode_ = *to;
  set_text(why_, "{}", why);
}

void Owner::fall() noexcept {
  std::uint8_t why[sizeof why_];
  if (mode_ == Mode::kSafeStop && why_[0] != 0) {
    set_text(why, "fell after the stop: {}", text_view(why_));
  } else {
    set_text(why, "tilt beyond safety.fall_tilt_rad");
  }
  enter(Event::kTiltLimit, text_view(why));
}

bool Owner::on_command(const command_t& command) noexcept {
  if (mode_ != Mode::kRunning && mode_ != Mode::kPaused) return false;
  return gate_.offer(command, tick_);
}

bool Owner::on_request(const request_t& request, const Surroundings& surroundings,
                       reply_t& reply) noexcept {
  const reply_t* last = askers_.last(request.writer);
  if (last != nullptr && last->request_counter == request.counter) {
    reply = *last;  // asked again because the answer got lost
    return true;
  }
  reply = {};
  reply.request_writer = request.writer;
  reply.request_counter = request.counter;
  reply.verb = request.verb;
  reply.result = reply_t::APPLIED;
  reply.applied_tick = tick_;
  if (request.owner_epoch != epoch_) {
    refuse(reply, "meant for another run of this owner; ask again");
    return true;
  }
  const bool used = last != nullptr ? request.counter < last->request_counter
                                    : askers_.used(request.writer, request.counter);
  if (used) {
    refuse(reply, "the counter was used already; count on");
    return true;
  }
  if (!act(request, surroundings, reply)) return false;
  conclude(request, reply);
  return true;
}

void Owner::conclude(const request_t& request, const reply_t& reply) noexcept {
  if (reply.result == reply_t::APPLIED) {
    request_writer_ = request.writer;
    request_counter_ = request.counter;
  }
  // One that was left for later does not take the place of a newer one, which would be done twice.
  const reply_t* last = askers_.last(request.writer);
  if (last == nullptr || last->request_counter < request.counter) askers_.remember(reply);
}

bool Owner::change_mode(const request_t& request, const Surroundings& surroundings,
                        reply_t& reply) noexcept {
  const std::optional<Event> event = event_of(request.verb);
  if (!event) return refuse(reply, "verb {} is not known to this owner", request.verb);
  if (!next(mode_, *event)) {
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
  enter(*event, "");
  set_text(reply.text, "{}", name_of(mode_));
  return true;
}

void Owner::fill_owner(status_t& status) const noexcept {
  status.mode = static_cast<std::int32_t>(mode_);
  set_text(status.text, "{}", text_view(why_));
  status.tick_period_ns = rig_.loop.tick_ns();
  const bool leased = mode_ == Mode::kPaused || (mode_ == Mode::kRunning && !gate_.lost(tick_));
  status.command_writer = leased ? gate_.writer() : 0;
  status.command_counter = gate_.counter();
  status.request_writer = request_writer_;
  status.request_counter = request_counter_;
  const CommandGate::Refusals& refused = gate_.refusals();
  status.refused_not_finite = refused.not_finite;
  status.refused_epoch = refused.epoch;
  status.refused_expired = refused.expired;
  status.refused_counter = refused.counter;
  status.refused_writer = refused.writer;
}

}  // namespace gyrotwin
