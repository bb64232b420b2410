// A rig and an owner for it that answers operators as a test says. Link gyrotwin_rig_bus.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "services/runtime/bus.hpp"
#include "services/runtime/rig.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {

/// Unsigned, on an address of this process.
inline Rig fake_rig() {
  const BusConfig config = test_config();
  Rig rig;
  rig.name = "fake";
  rig.file = "fake.toml";
  rig.id = config.rig_id;
  rig.network = {.prefix = config.prefix,
                 .group = config.group,
                 .port = config.port,
                 .interface = config.interface,
                 .ttl = config.ttl,
                 .sign = false};
  return rig;
}

/// Publishes STATUS and answers requests on a thread of its own until it is stopped.
class FakeOwner {
 public:
  /// What to answer to a request, if anything; the addressee is filled in. A request that was
  /// answered and comes again gets the same answer without being shown again. `epoch` is the
  /// owner's own, which an answer may change: a STATUS with the new one goes before the reply.
  using Answer = std::function<std::optional<reply_t>(const request_t&, std::int64_t& epoch)>;

  explicit FakeOwner(const BusConfig& config, Answer answer = {})
      : bus_(config), answer_(std::move(answer)), thread_([this](std::stop_token stop) {
          while (!stop.stop_requested()) turn();
          turn();  // what was sent before the stop is heard
        }) {}

  /// Ends the thread. @return all requests, in the order in which they came
  const std::vector<request_t>& stop() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
    return requests_;
  }

  static constexpr std::int64_t kEpoch = 77;  ///< the first one

 private:
  void turn() {
    say_status();
    const auto reception = bus_.receive(kSecond / 100);
    if (!reception || reception->channel != Channel::kRequest) return;
    Bus::decode(*reception, requests_.emplace_back());
    reply(requests_.back());
  }

  void say_status() {
    status_t status{};
    status.service = status_t::INTEGRATOR;
    status.pid = 4711;
    status.tick_period_ns = kSecond / 1000;
    status.speed_factor = 1.0;
    bus_.send(Channel::kIntegratorStatus, status, {.epoch = epoch_, .sequence = ++sequence_});
  }

  void reply(const request_t& request) {
    const std::int64_t epoch = epoch_;
    if (request.counter != answered_counter_) {
      last_ = answer_ ? answer_(request, epoch_) : std::nullopt;
      if (last_) answered_counter_ = request.counter;
    }
    if (epoch != epoch_) say_status();
    std::optional<reply_t> answer = last_;
    if (!answer) return;
    // Somebody else's answers must not be taken for one's own.
    answer->request_writer = request.writer;
    answer->request_counter = request.counter + 1;
    bus_.send(Channel::kReply, *answer, {.epoch = epoch_, .sequence = ++sequence_});
    answer->request_writer = request.writer + 1;
    answer->request_counter = request.counter;
    bus_.send(Channel::kReply, *answer, {.epoch = epoch_, .sequence = ++sequence_});
    answer->request_writer = request.writer;
    answer->applied_tick = 5;
    bus_.send(Channel::kReply, *answer, {.epoch = epoch_, .sequence = ++sequence_});
  }

  Bus bus_;
  Answer answer_;
  std::int64_t epoch_ = kEpoch, sequence_ = 0;
  std::vector<request_t> requests_;
  std::int64_t answered_counter_ = 0;
  std::optional<reply_t> last_;
  std::jthread thread_;  // last: it uses all the others
};

}  // namespace gyrotwin
