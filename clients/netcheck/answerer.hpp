// The other end: answers the rig's authentic probes, and nothing else. No socket and no clock.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "clients/netcheck/arrivals.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/probe_socket.hpp"

namespace gyrotwin::netcheck {

/// So many in a second, so many at once.
class RateLimit {
 public:
  RateLimit(double per_second, double burst)
      : per_second_(per_second), burst_(burst), left_(burst) {}
  /// @param now_ns never goes back
  bool allows(std::int64_t now_ns) noexcept;

 private:
  double per_second_, burst_, left_;
  std::int64_t last_ns_ = 0;
};

/// Remembers the 16 sessions pinged last. A question changes nothing that it remembers.
class Answerer {
 public:
  /// Twice the highest rate that is ever asked for.
  static constexpr double kMostPerSecond = 20'000.0;
  static constexpr double kMostAtOnce = 2'000.0;
  /// Questions are answered by every listener there is, so that fewer will do: ten askers' worth.
  static constexpr double kMostReportsPerSecond = 200.0;
  static constexpr double kMostReportsAtOnce = 20.0;

  /// @param id random, one run
  Answerer(std::int64_t id, const HostFacts& facts) : id_(id), facts_(facts) {}

  /// What to send in answer. An Answer's `sent_ns` is the sender's to fill.
  /// @param now_ns monotonic
  std::optional<Probe> answer(const Arrival& arrival, const ProbeCounters& counters,
                              std::int64_t now_ns);

 private:
  struct Session {
    std::int64_t id = 0;
    Arrivals pings;
    std::int64_t answered = 0, over_rate = 0;
    std::int64_t dropped_before = 0;  // of the socket's datagrams, when the session began
    int ttl_min = -1, ttl_max = -1, interface = 0;
  };

  Report report(const Question& question, const ProbeCounters& counters) const;
  std::optional<Probe> answer_to(const Ping& ping, const Arrival& arrival,
                                 const ProbeCounters& counters, std::int64_t now_ns);
  /// The session of a ping that has come: looked up or begun, and the last heard from now on.
  Session& session(std::int64_t id, const Arrival& arrival, const ProbeCounters& counters);

  std::int64_t id_;
  HostFacts facts_;
  RateLimit answers_{kMostPerSecond, kMostAtOnce};
  RateLimit reports_{kMostReportsPerSecond, kMostReportsAtOnce};
  std::vector<std::unique_ptr<Session>> sessions_;  // the last pinged first
};

/// Answers until `stopping()` says so; looks every 50 ms.
template <class Stopping>
void serve(ProbeSocket& socket, Answerer& answerer, const Clock& clock, Stopping&& stopping) {
  constexpr std::int64_t kLookNs = 50'000'000;
  while (!stopping()) {
    socket.wait(kLookNs);
    const ProbeCounters& counters = socket.counters();  // the kernel is asked once a round
    while (const auto arrival = socket.receive()) {
      auto reply = answerer.answer(*arrival, counters, clock.now_ns());
      if (!reply) continue;
      if (auto* answer = std::get_if<Answer>(&*reply)) answer->sent_ns = wall_ns();
      socket.send(*reply);
    }
  }
}

}  // namespace gyrotwin::netcheck
