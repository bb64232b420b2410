#include "clients/netcheck/measure.hpp"

#include <algorithm>
#include <cmath>

#include "clients/netcheck/arrivals.hpp"
#include "services/runtime/pacer.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin::netcheck {
namespace {

constexpr std::int64_t kAskAgainNs = 50'000'000;
// The account is waited for longer. With a patience of a second that is 60 questions: of a line
// that loses half of them, both ways, 1 in 10^7 runs gets no answer.
constexpr std::int64_t kAccountPatience = 3;

/// Hands arrivals to `take` until `deadline_ns`, or until `done()`.
template <class Take, class Done>
void listen_until(const Line& line, std::int64_t deadline_ns, Take&& take, Done&& done) {
  for (;;) {
    while (const auto arrival = line.socket.receive()) take(*arrival);
    const std::int64_t left = deadline_ns - line.clock.now_ns();
    if (left <= 0 || done()) return;
    line.socket.wait(left);
  }
}

/// Repeats a question, with the next serial each time, and hands its reports to `take`.
template <class Take, class Done>
void ask(const Line& line, Question question, std::int64_t limit_ns, Take&& take, Done&& done) {
  const std::int64_t end = line.clock.now_ns() + limit_ns;
  const auto reports = [&](const Arrival& arrival) {
    const auto* report = std::get_if<Report>(&arrival.probe);
    if (report != nullptr && report->session == question.session) take(*report, arrival);
  };
  const auto enough = [&] { return done() || line.stopping(); };
  while (!enough() && line.clock.now_ns() < end) {
    line.socket.send(question);
    ++question.serial;
    listen_until(line, std::min(end, line.clock.now_ns() + kAskAgainNs), reports, enough);
  }
}

/// One measurement while it runs.
class Run {
 public:
  Run(const Line& line, const Peer& peer, double rate_hz, std::int64_t ticks)
      : line_(line), peer_(peer), session_(random_id()), ticks_(ticks) {
    measured_.period_ns = std::llround(1e9 / rate_hz);
    measured_.trips.reserve(static_cast<std::size_t>(ticks));
    sent_ns_.reserve(static_cast<std::size_t>(ticks));
  }

  Measurement measure() {
    const std::int64_t dropped_before = line_.socket.counters().kernel_dropped;
    const std::int64_t wall_ahead = wall_ns() - line_.clock.now_ns();
    ping();
    listen_until(line_, line_.clock.now_ns() + line_.patience_ns, taker(),
                 [&] { return answered_ == measured_.trips.size() || line_.stopping(); });
    measured_.clock_step_ns = wall_ns() - line_.clock.now_ns() - wall_ahead;
    ask_for_account();
    measured_.heard.distinct = answers_.distinct();
    measured_.heard.repeats = answers_.repeats();
    measured_.heard.late = answers_.late();
    measured_.heard.kernel_dropped = line_.socket.counters().kernel_dropped - dropped_before;
    set_text(measured_.heard.interface, "{}", interface_name(interface_));
    return std::move(measured_);
  }

 private:
  std::function<void(const Arrival&)> taker() {
    return [this](const Arrival& arrival) { take(arrival); };
  }

  void ping() {
    Pacer pacer(measured_.period_ns, OverrunPolicy::kSkip);
    pacer.anchor(line_.clock.now_ns());
    const std::int64_t first = pacer.deadline();
    const auto take_all = taker();
    while (!line_.stopping()) {
      const std::int64_t deadline = pacer.deadline();
      const std::int64_t tick = (deadline - first) / measured_.period_ns;
      if (tick >= ticks_) break;
      listen_until(line_, deadline, take_all, [] { return false; });
      const std::int64_t now = line_.clock.now_ns();
      pacer.begin(now);
      measured_.trips.push_back(
          {.tick = tick, .lateness = std::max<std::int64_t>(0, now - deadline)});
      sent_ns_.push_back(wall_ns());
      line_.socket.send(Ping{.session = session_,
                             .target = peer_.answerer,
                             .sequence = static_cast<std::int64_t>(sent_ns_.size()) - 1});
    }
    const std::int64_t gone_by = (pacer.deadline() - first) / measured_.period_ns;
    measured_.ticks = std::min(ticks_, gone_by);
  }

  void take(const Arrival& arrival) {
    const auto* answer = std::get_if<Answer>(&arrival.probe);
    if (answer == nullptr || answer->session != session_ || answer->answerer != peer_.answerer) {
      return;
    }
    note_way(arrival);
    const auto n = static_cast<std::size_t>(answer->sequence);
    if (!answers_.hear(answer->number) || n >= measured_.trips.size()) return;
    Trip& trip = measured_.trips[n];
    if (trip.answered()) return;
    complete(trip, sent_ns_[n], answer->received_ns, answer->sent_ns, arrival.received_ns);
    ++answered_;
  }

  void note_way(const Arrival& arrival) {
    Heard& heard = measured_.heard;
    heard.ttl_min =
        heard.ttl_min < 0 ? arrival.ttl : std::min<std::int64_t>(heard.ttl_min, arrival.ttl);
    heard.ttl_max = std::max<std::int64_t>(heard.ttl_max, arrival.ttl);
    interface_ = arrival.interface;
  }

  void ask_for_account() {
    ask(
        line_, {.session = session_, .target = peer_.answerer},
        kAccountPatience * line_.patience_ns,
        [&](const Report& report, const Arrival&) {
          if (report.answerer == peer_.answerer) measured_.there = report;
        },
        [&] { return measured_.there.has_value(); });
  }

  const Line& line_;
  const Peer& peer_;
  std::int64_t session_;
  std::int64_t ticks_;
  Measurement measured_;
  std::vector<std::int64_t> sent_ns_;  // wall clock, of each trip
  Arrivals answers_;
  std::size_t answered_ = 0;
  int interface_ = 0;
};

}  // namespace

std::vector<Peer> find_peers(const Line& line, std::size_t enough) {
  std::vector<Peer> peers;
  ask(
      line, {.session = random_id()}, line.patience_ns,
      [&](const Report& report, const Arrival& arrival) {
        if (std::ranges::find(peers, report.answerer, &Peer::answerer) != peers.end()) return;
        peers.push_back({report.answerer, address_text(arrival.from), report.facts});
      },
      [&] { return enough > 0 && peers.size() >= enough; });
  std::ranges::sort(peers, {}, &Peer::address);
  return peers;
}

Measurement measure(const Line& line, const Peer& peer, double rate_hz, std::int64_t ticks) {
  return Run(line, peer, rate_hz, ticks).measure();
}

}  // namespace gyrotwin::netcheck
