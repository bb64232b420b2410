#include "services/runtime/owner_desk.hpp"

#include "services/runtime/error.hpp"
#include "services/runtime/key.hpp"
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

bool OwnerDesk::controller_heard(std::int64_t now) const noexcept {
  return lately(controller_heard_, now);
}

void OwnerDesk::hear_other_owner(const Reception& reception, std::int64_t now) noexcept {
  other_owner_heard_ = now;
  if (!is_owner_status(reception.channel)) {
    owner_.notice(Event::kConflict, "another owner publishes this rig's STATE");
    return;
  }
  status_t other;
  Bus::decode(reception, other);
  std::uint8_t why[96];
  set_text(why, "conflict: process {} on {:.24} owns this rig too", other.pid,
           text_view(other.host));
  owner_.notice(Event::kConflict, text_view(why));
}

bool OwnerDesk::ask(const request_t& request, std::int64_t now, reply_t& reply) noexcept {
  const Surroundings surroundings{.controller_heard = controller_heard(now),
                                  .other_owner_heard = lately(other_owner_heard_, now),
                                  .fresh_epoch = random_id()};
  return owner_.on_request(request, surroundings, reply);
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
  if (status.text[0] == 0 && !controller_heard(now)) {
    set_text(status.text, "no controller is heard");
  }
  bus_.send(status_channel_, status,
            {owner_.epoch(), ++status_sequence_, owner_.tick(), owner_.sim_time_ns()});
}

}  // namespace gyrotwin
