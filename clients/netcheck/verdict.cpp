#include "clients/netcheck/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace gyrotwin::netcheck {
namespace {

/// What every rate is judged by.
struct Evidence {
  double ticks = 0.0;
  double unanswered = 0.0;
  std::vector<std::int64_t> responses{};  ///< ascending [ns]
  Staleness stale{};
};

Evidence evidence(const Measurement& measured) {
  Evidence e{.ticks = static_cast<double>(measured.ticks), .stale = staleness(measured)};
  for (const Trip& trip : measured.trips) {
    if (trip.answered()) {
      e.responses.push_back(trip.response());
    } else {
      e.unanswered += 1.0;
    }
  }
  std::ranges::sort(e.responses);
  return e;
}

Fit fit(const Evidence& e, double rate_hz, int timeout_ticks) {
  const double period = 1e9 / rate_hz;
  Fit f{.rate_hz = rate_hz, .budget_ns = std::llround(kBudget * period)};
  const auto in_time =
      static_cast<double>(std::ranges::upper_bound(e.responses, f.budget_ns) - e.responses.begin());
  f.unanswered = e.ticks > 0.0 ? e.unanswered / e.ticks : 1.0;
  f.missed = e.ticks > 0.0 ? (e.ticks - in_time) / e.ticks : 1.0;
  // A loss may be of so many messages or of so much time: whichever is worse at this rate.
  const auto silent = static_cast<double>(std::max<std::int64_t>(e.stale.silence_ns, 0));
  f.age_ticks = std::max(static_cast<std::int64_t>(silent / period), e.stale.lost_run);
  if (f.unanswered > kMayMiss) {
    f.limit = Limit::kLoss;
  } else if (f.missed > kMayMiss) {
    f.limit = Limit::kSlow;
  } else if (f.age_ticks >= timeout_ticks) {
    f.limit = Limit::kStale;
  }
  return f;
}

std::int64_t longest_lost_run(const std::vector<Trip>& trips) {
  std::int64_t run = 0, longest = 0;
  for (const Trip& trip : trips) {
    run = trip.answered() ? 0 : run + 1;
    longest = std::max(longest, run);
  }
  return longest;
}

Part slowest_part(const Measurement& measured, std::int64_t budget_ns) {
  const auto sent = static_cast<std::int64_t>(measured.trips.size());
  const std::int64_t slept = (measured.ticks - sent) * measured.period_ns;
  // Not whole numbers: clocks that are set make trips of years, and some of these do not fit in
  // one.
  double here = static_cast<double>(slept), network = 0.0, there = 0.0;
  for (const Trip& trip : measured.trips) {
    if (!trip.answered() || trip.response() <= budget_ns) continue;
    here += static_cast<double>(trip.lateness);
    network += static_cast<double>(trip.network);
    there += static_cast<double>(trip.turn);
  }
  const double most = std::max({here, network, there});
  if (most == 0.0) return Part::kNone;
  if (most == here) return Part::kWakeHere;
  return most == network ? Part::kNetwork : Part::kWakeThere;
}

}  // namespace

const Fit* LineVerdict::limited() const {
  const auto bad =
      std::ranges::find_if(rates.rbegin(), rates.rend(), [](const Fit& f) { return !f.good(); });
  return bad == rates.rend() ? nullptr : &*bad;
}

Staleness staleness(const Measurement& measured) {
  struct Came {
    std::int64_t at, deadline;
  };
  std::vector<Came> came;
  for (const Trip& trip : measured.trips) {
    if (!trip.answered()) continue;
    const std::int64_t deadline = trip.tick * measured.period_ns;
    came.push_back({deadline + trip.response(), deadline});
  }
  std::ranges::sort(came, {}, &Came::at);

  // Before the first and after the last, the line is taken to be good: `newest` is the deadline
  // that the newest answer belongs to.
  Staleness stale{.lost_run = longest_lost_run(measured.trips)};
  std::int64_t newest = -measured.period_ns;
  const auto silent_until = [&](std::int64_t at) {
    stale.silence_ns = std::max(stale.silence_ns, at - newest - measured.period_ns);
  };
  for (const Came& answer : came) {
    if (answer.deadline <= newest) continue;
    silent_until(answer.at);
    newest = answer.deadline;
  }
  silent_until(measured.ticks * measured.period_ns);
  return stale;
}

LineVerdict line_verdict(const Measurement& measured, double rig_hz, int timeout_ticks) {
  const Evidence e = evidence(measured);
  LineVerdict verdict{.rig = fit(e, rig_hz, timeout_ticks)};
  verdict.slowest = slowest_part(measured, verdict.rig.budget_ns);
  std::vector<double> rates(kRates.begin(), kRates.end());
  if (std::ranges::find(rates, rig_hz) == rates.end()) rates.push_back(rig_hz);
  std::ranges::sort(rates, std::greater());
  for (const double rate : rates) {
    verdict.rates.push_back(fit(e, rate, timeout_ticks));
    if (verdict.good_for_hz == 0.0 && verdict.rates.back().good()) verdict.good_for_hz = rate;
  }
  return verdict;
}

}  // namespace gyrotwin::netcheck
