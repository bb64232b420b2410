// Operators' requests to a real plant: what the owner can do itself, what it asks the device for,
// and what nobody can.
#include <algorithm>

#include "services/hardware/hardware.hpp"
#include "services/runtime/refuse.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kAnswerIn = 500'000'000;  // that the device may take [ns]
constexpr std::int64_t kLastTick = std::int64_t{1} << 53;

}  // namespace

bool Hardware::act(const request_t& request, const Surroundings& surroundings,
                   reply_t& reply) noexcept {
  switch (request.verb) {
    case request_t::ARM:
      arm(request, surroundings, reply);
      return true;
    case request_t::RESET:
      reset(request, surroundings.fresh_epoch, reply);
      return true;
    case request_t::ROTORS:
      set_rotors(request, reply);
      return true;
    case request_t::PAUSE:
    case request_t::RESUME:
    case request_t::STEP:
    case request_t::SPEED:
      refuse(reply, "the plant is real: its time neither stops nor changes speed");
      return true;
    case request_t::DISTURB:
    case request_t::FAULT:
    case request_t::CANCEL:
    case request_t::CLEAR:
      return !forward(request, reply);
    default:
      change_mode(request, surroundings, reply);
      return true;
  }
}

bool Hardware::arm(const request_t& request, const Surroundings& surroundings,
                   reply_t& reply) noexcept {
  Text why;
  if (mode() == Mode::kHeld && hindered(why)) return refuse(reply, "{}", text_view(why));
  return change_mode(request, surroundings, reply);
}

bool Hardware::reset(const request_t& request, std::int64_t fresh_epoch, reply_t& reply) noexcept {
  if (request.initial_given != 0) {
    return refuse(reply, "a real plant cannot be put into a state; prop it there by hand");
  }
  if (pressed()) return refuse(reply, "the E-stop is pressed; release it first");
  begin_run(fresh_epoch);
  estimator_.forget();  // where it lay says nothing of where it is propped
  rotors_asked_.reset();
  // What the device still owes an answer to ends with the run, and overdue() says so.
  for (std::optional<Pending>& pending : pending_) {
    if (pending) pending->sent = pending->outrun = true;
  }
  reply.applied_tick = 0;
  set_text(reply.text, "HELD, drives off: prop the platform upright before arming");
  return true;
}

bool Hardware::set_rotors(const request_t& request, reply_t& reply) noexcept {
  if (!machine_.rotor_drive) {
    return refuse(reply, "rotors of this rig keep their speed; give its file [rotor_drive]");
  }
  if (request.kind != request_t::SPIN_UP && request.kind != request_t::SPIN_DOWN) {
    return refuse(reply, "kind of ROTORS must be SPIN_UP or SPIN_DOWN");
  }
  if (!connected_) return refuse(reply, "the device is not heard: check cable and power");
  if (pressed() && request.kind == request_t::SPIN_UP) {
    return refuse(reply, "the E-stop is pressed; release it first");
  }
  rotors_asked_ = request.kind == request_t::SPIN_UP;
  set_text(reply.text, "the device is asked to {} its rotors",
           *rotors_asked_ ? "power" : "cut the power of");
  return true;
}

/// @return whether the device has it now; otherwise refused
bool Hardware::forward(const request_t& request, reply_t& reply) noexcept {
  const auto same = [&](const std::optional<Pending>& pending) {
    return pending && pending->request.writer == request.writer &&
           pending->request.counter == request.counter;
  };
  if (std::any_of(pending_.begin(), pending_.end(), same)) return true;  // asked again
  if (!connected_) return refuse(reply, "the device is not heard: check cable and power");
  const bool acts = request.verb == request_t::DISTURB || request.verb == request_t::FAULT;
  if (acts && (mode() == Mode::kFallen || mode() == Mode::kFault)) {
    return refuse(reply, "{}: nothing to disturb; ctl reset first", name_of(mode()));
  }
  if (acts && mode() == Mode::kHeld) return refuse(reply, "HELD: the plant is held; ctl arm first");
  const auto free = std::find(pending_.begin(), pending_.end(), std::nullopt);
  if (free == pending_.end()) return refuse(reply, "the device has not answered the last requests");
  if (request.start_tick > kLastTick) return refuse(reply, "start_tick is beyond all ticks");
  request_t& forwarded = (*free = Pending{.request = request})->request;
  if (request.start_tick > 0) forwarded.start_tick += device_tick_.value_or(0) - tick_;
  return true;
}

std::optional<request_t> Hardware::take_request() noexcept {
  for (std::optional<Pending>& pending : pending_) {
    if (!pending || pending->sent) continue;
    pending->sent = true;
    return pending->request;
  }
  return std::nullopt;
}

bool Hardware::on_reply(const reply_t& answer, reply_t& reply) noexcept {
  for (std::optional<Pending>& pending : pending_) {
    if (!pending || pending->outrun || pending->request.writer != answer.request_writer ||
        pending->request.counter != answer.request_counter) {
      continue;
    }
    reply = answer;
    reply.verb = pending->request.verb;
    reply.applied_tick = std::clamp<std::int64_t>(answer.applied_tick, 0, kLastTick) -
                         device_tick_.value_or(0) + tick_;
    if (reply.result != reply_t::APPLIED) {
      reply.result = reply_t::REFUSED;
    } else if (reply.id > 0) {  // the device counts other ticks than the owner
      set_text(reply.text, "number {}, from tick {}", reply.id, reply.applied_tick);
    }
    conclude(pending->request, reply);
    pending.reset();
    return true;
  }
  return false;
}

bool Hardware::overdue(std::int64_t now, reply_t& reply) noexcept {
  for (std::optional<Pending>& pending : pending_) {
    if (!pending) continue;
    if (pending->due == 0) pending->due = now + kAnswerIn;
    if (now < pending->due && !pending->outrun) continue;
    reply = {};
    reply.request_writer = pending->request.writer;
    reply.request_counter = pending->request.counter;
    reply.verb = pending->request.verb;
    refuse(
        reply, "{}",
        pending->outrun ? "a reset came before the device's answer" : "the device does not answer");
    conclude(pending->request, reply);
    pending.reset();
    return true;
  }
  return false;
}

}  // namespace gyrotwin
