#include "services/runtime/owner_desk.hpp"

#include "services/runtime/error.hpp"
#include "services/runtime/key.hpp"
#include "services/runtime/show_status.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kClaim = kSecond;  // listening before owning
constexpr std::int64_t kHeardLately = kSecond;

bool lately(std::int64_t heard, std::int64_t now) {
  return heard >= 0 && now - heard < kHeardLately;
}

}  // namespace

void claim(const Rig& rig, Bus& bus, Clock& clock, const Daemon& daemon) {
  const std::int64_t end = clock.now_ns() + kClaim;
  for (std::int64_t now = clock.now_ns(); now < end && !daemon.stopping(); now = clock.now_ns()) {
    bus.wait(end - now);
    while (const auto reception = bus.receive()) {
      if (!is_owner_status(reception->channel)) continue;
      status_t other;
      Bus::decode(*reception, other);
      throw NotDone(
          fmt::format("rig {} is owned already by process {} on {}; stop that one first, or "
                      "give this rig a file with another id, port and prefix",
                      rig.name, other.pid, get_text(other.host)));
    }
  }
}

OwnerDesk::OwnerDesk(Bus& bus, Daemon& daemon, Owner& owner, Channel status)
    : bus_(bus), daemon_(daemon), owner_(owner), status_channel_(status) {}

bool OwnerDesk::hear(const Reception& reception, std::int64_t now) noexcept {
  switch (reception.channel) {
    case Channel::kCommand:
      return hear_command(reception, now);
    case Channel::kRequest:
      hear_request(reception, now);
      return false;
    case Channel::kControllerStatus:
      controller_heard_ = now;
      return false;
    case Channel::kState:
    case Channel::kIntegratorStatus:
    case Channel::kHardwareStatus:
      hear_other_owner(reception, now);
      return false;
    default:
      return false;
  }
}

bool OwnerDesk::hear_command(const Reception& reception, std::int64_t now) noexcept {
  command_t command;
  Bus::decode(reception, command);
  if (command.owner_epoch == owner_.epoch()) controller_heard_ = now;
  return owner_.on_command(command);
}

void OwnerDesk::hear_request(const Reception& reception, std::int64_t now) noexcept {
  request_t request;
  Bus::decode(reception, request);
  const Surroundings surroundings{.controller_heard = lately(controller_heard_, now),
                                  .other_owner_heard = lately(other_owner_heard_, now),
                                  .fresh_epoch = random_id()};
  if (!owner_.on_request(request, surroundings, answer_.emplace())) answer_.reset();
}

/// STATE or STATUS: own messages never come back. STATE comes first, and STATUS says whose it is.
void OwnerDesk::hear_other_owner(const Reception& reception, std::int64_t now) noexcept {
  if (!lately(other_owner_heard_, now)) {
    set_text(conflict_, "conflict: another owner publishes this rig's STATE; stop one of the two");
  }
  other_owner_heard_ = now;
  if (is_owner_status(reception.channel)) {
    status_t other;
    Bus::decode(reception, other);
    set_text(conflict_, "conflict: process {} on {:.24} owns this rig too; stop one of the two",
             other.pid, text_view(other.host));
  }
  owner_.notice(Event::kConflict, text_view(conflict_));
}

void OwnerDesk::answer() noexcept {
  if (answer_) answer(*answer_);
  answer_.reset();
}

void OwnerDesk::answer(reply_t& reply) noexcept {
  bus_.send(Channel::kReply, reply,
            {owner_.epoch(), ++reply_sequence_, owner_.tick(), owner_.sim_time_ns()});
  const bool applied = reply.result == reply_t::APPLIED;
  daemon_.log(applied ? LogLevel::kInfo : LogLevel::kWarning, "{}: {}{}", verb_name(reply.verb),
              applied ? "" : "refused: ", text_view(reply.text));
}

void OwnerDesk::send_status(status_t& status, std::int64_t now) noexcept {
  fill_process(status, identity_, bus_.counters());
  const bool grave = status.mode == status_t::MODE_FALLEN || status.mode == status_t::MODE_FAULT;
  if (lately(other_owner_heard_, now) && !grave) {
    set_text(status.text, "{}", text_view(conflict_));
  } else if (status.text[0] == 0 && !lately(controller_heard_, now)) {
    set_text(status.text, "no controller is heard");
  }
  show_status(daemon_, status);
  bus_.send(status_channel_, status,
            {owner_.epoch(), ++status_sequence_, owner_.tick(), owner_.sim_time_ns()});
}

}  // namespace gyrotwin
