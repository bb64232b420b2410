#include "clients/common/asker.hpp"

#include "services/runtime/key.hpp"
#include "services/runtime/rig_bus.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

Asker::Asker(const Rig& rig, Clock& clock)
    : rig_(rig),
      clock_(clock),
      bus_(bus_config(rig, header_t::OPERATOR)),
      epoch_(random_id()),
      writer_(random_id()) {}

const status_t& Asker::owner(std::int64_t patience_ns) {
  if (owner_) return *owner_;
  const bool heard = listen(patience_ns, [this](const Reception& reception) {
    if (!is_owner_status(reception.channel)) return false;
    Bus::decode(reception, owner_.emplace());
    return true;
  });
  if (!heard) {
    throw NotDone(fmt::format(
        "no owner of rig {} is heard on {}: start `gyrotwin integrator --rig {}`, or `gyrotwin "
        "hardware` for a real one, or check --rig{}",
        rig_.name, reach(rig_), rig_.file.string(), suspicion()));
  }
  return *owner_;
}

reply_t Asker::ask(request_t request) {
  request.owner_epoch = owner().header.epoch;
  std::optional<reply_t> reply = exchange(request);
  // Its epoch tells a run that ended before the request came from one that the request itself
  // ended.
  if (reply && reply->result == reply_t::REFUSED && reply->header.epoch != request.owner_epoch) {
    request.owner_epoch = reply->header.epoch;
    reply = exchange(request);
  }
  if (!reply) {
    throw NotDone(
        fmt::format("the owner of rig {} (process {} on {}) was heard, but does not "
                    "answer; `gyrotwin ctl status` shows whether it still lives",
                    rig_.name, owner_->pid, get_text(owner_->host)));
  }
  owner_->header.epoch = reply->header.epoch;  // a reset has begun a new run
  return *reply;
}

/// Sends the same datagram until its answer comes.
std::optional<reply_t> Asker::exchange(request_t& request) {
  request.writer = writer_;
  request.counter = ++counter_;
  const Stamp stamp{.epoch = epoch_,
                    .sequence = counter_,
                    .tick = owner_->header.tick,
                    .sim_time_ns = owner_->header.sim_time_ns};
  reply_t reply;
  const auto answers = [&](const Reception& reception) {
    if (reception.channel != Channel::kReply) return false;
    Bus::decode(reception, reply);
    return reply.request_writer == writer_ && reply.request_counter == counter_;
  };
  for (int i = 0; i < kMostAsks; ++i) {
    bus_.send(Channel::kRequest, request, stamp);
    if (listen(kAskAgain, answers)) return reply;
  }
  return std::nullopt;
}

std::string Asker::suspicion() {
  const BusCounters& heard = bus_.counters();
  if (heard.unauthentic > 0) {
    return fmt::format("; {} messages came that {} did not sign: both sides need the same key",
                       heard.unauthentic, key_path(rig_.name).string());
  }
  if (heard.other_rig > 0 || heard.foreign > 0) {
    return fmt::format("; {} messages of other rigs came on this address: is it the rig that runs?",
                       heard.other_rig + heard.foreign);
  }
  return "";
}

reply_t ask_or_throw(Asker& asker, const request_t& request, const std::string& what) {
  const reply_t reply = asker.ask(request);
  if (reply.result != reply_t::APPLIED) {
    throw NotDone(what + " refused: " + get_text(reply.text));
  }
  return reply;
}

}  // namespace gyrotwin
