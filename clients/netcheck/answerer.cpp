#include "clients/netcheck/answerer.hpp"

#include <algorithm>

#include "services/runtime/text.hpp"

namespace gyrotwin::netcheck {
namespace {

constexpr std::size_t kSessions = 16;

}  // namespace

bool RateLimit::allows(std::int64_t now_ns) noexcept {
  left_ = std::min(burst_, left_ + 1e-9 * per_second_ * static_cast<double>(now_ns - last_ns_));
  last_ns_ = now_ns;
  if (left_ < 1.0) return false;
  left_ -= 1.0;
  return true;
}

std::optional<Probe> Answerer::answer(const Arrival& arrival, const ProbeCounters& counters,
                                      std::int64_t now_ns) {
  if (const auto* ping = std::get_if<Ping>(&arrival.probe)) {
    // Its target is this very run: what was recorded before and is played back is nobody's.
    if (ping->target != id_) return {};
    return answer_to(*ping, arrival, counters, now_ns);
  }
  if (const auto* question = std::get_if<Question>(&arrival.probe)) {
    if (question->target != id_ && question->target != Question::kEverybody) return {};
    if (!reports_.allows(now_ns)) return {};
    return report(*question, counters);
  }
  return {};
}

std::optional<Probe> Answerer::answer_to(const Ping& ping, const Arrival& arrival,
                                         const ProbeCounters& counters, std::int64_t now_ns) {
  Session& s = session(ping.session, arrival, counters);
  if (!s.pings.hear(ping.sequence)) return {};
  if (!answers_.allows(now_ns)) {
    ++s.over_rate;
    return {};
  }
  return Answer{.session = ping.session,
                .answerer = id_,
                .sequence = ping.sequence,
                .number = s.answered++,
                .received_ns = arrival.received_ns};
}

// A question to everybody names no run, so that anybody may play back an old one: it looks a
// session up, but neither begins one nor makes another be forgotten.
Report Answerer::report(const Question& question, const ProbeCounters& counters) const {
  Report report{.session = question.session,
                .answerer = id_,
                .serial = question.serial,
                .unauthentic = counters.unauthentic,
                .facts = facts_};
  const auto found = std::ranges::find(sessions_, question.session, &Session::id);
  if (found == sessions_.end()) return report;
  const Session& s = **found;
  report.answered = s.answered;
  report.over_rate = s.over_rate;
  report.heard = {.distinct = s.pings.distinct(),
                  .repeats = s.pings.repeats(),
                  .late = s.pings.late(),
                  .ttl_min = s.ttl_min,
                  .ttl_max = s.ttl_max,
                  .kernel_dropped = counters.kernel_dropped - s.dropped_before};
  set_text(report.heard.interface, "{}", interface_name(s.interface));
  return report;
}

Answerer::Session& Answerer::session(std::int64_t id, const Arrival& arrival,
                                     const ProbeCounters& counters) {
  auto found = std::ranges::find(sessions_, id, &Session::id);
  if (found == sessions_.end()) {
    if (sessions_.size() == kSessions) sessions_.pop_back();
    sessions_.push_back(std::make_unique<Session>());
    found = sessions_.end() - 1;
    (*found)->id = id;
    (*found)->dropped_before = counters.kernel_dropped;
  }
  std::rotate(sessions_.begin(), found, found + 1);
  Session& s = *sessions_.front();
  s.ttl_min = s.ttl_min < 0 ? arrival.ttl : std::min(s.ttl_min, arrival.ttl);
  s.ttl_max = std::max(s.ttl_max, arrival.ttl);
  s.interface = arrival.interface;
  return s;
}

}  // namespace gyrotwin::netcheck
