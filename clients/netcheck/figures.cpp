#include "clients/netcheck/figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace gyrotwin::netcheck {
namespace {

/// The quickest round trip knows the clocks best: its offset is wrong by half its time at most.
void compare_clocks(Figures& figures, const std::vector<Trip>& trips) {
  const Trip* quickest = nullptr;
  for (const Trip& trip : trips) {
    if (!trip.answered()) continue;
    if (quickest == nullptr || trip.network < quickest->network) quickest = &trip;
  }
  if (quickest == nullptr) return;
  figures.clock_offset = quickest->offset;
  figures.clock_uncertainty = (quickest->network + 1) / 2;
}

Way way(std::int64_t sent, const Heard& heard, std::int64_t ttl_sent) {
  return {.sent = sent,
          // More may be heard than sent was seen to be, when the account is older than the answers.
          .lost = std::max<std::int64_t>(0, sent - heard.distinct),
          .late = heard.late,
          .repeats = heard.repeats,
          .kernel_dropped = heard.kernel_dropped,
          .ttl_sent = ttl_sent,
          .ttl_min = heard.ttl_min,
          .ttl_max = heard.ttl_max};
}

}  // namespace

void complete(Trip& trip, std::int64_t t1, std::int64_t t2, std::int64_t t3, std::int64_t t4) {
  trip.turn = std::max<std::int64_t>(0, t3 - t2);
  trip.network = std::max<std::int64_t>(0, (t4 - t1) - (t3 - t2));
  trip.offset = (t2 - t1) / 2 + (t3 - t4) / 2;
}

Spread spread(std::vector<std::int64_t> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto rank = [&](std::size_t per_mille) {
    const std::size_t n = (values.size() * per_mille + 999) / 1000;
    return values[std::max<std::size_t>(n, 1) - 1];
  };
  return {.p50 = rank(500), .p99 = rank(990), .p999 = rank(999), .max = values.back()};
}

Figures figures(const Measurement& measured, std::int64_t ttl_here) {
  const auto sent = static_cast<std::int64_t>(measured.trips.size());
  Figures f;
  f.ticks = measured.ticks;
  f.missed = measured.ticks - sent;

  std::vector<std::int64_t> lateness, turn, network, jitter, response;
  for (const Trip& trip : measured.trips) {
    lateness.push_back(trip.lateness);
    if (!trip.answered()) continue;
    if (!network.empty()) jitter.push_back(std::abs(trip.network - network.back()));
    network.push_back(trip.network);
    turn.push_back(trip.turn);
    response.push_back(trip.response());
  }
  f.unanswered = sent - static_cast<std::int64_t>(response.size());
  f.wake_here = spread(std::move(lateness));
  f.wake_there = spread(std::move(turn));
  f.network = spread(std::move(network));
  f.jitter = spread(std::move(jitter));
  f.response = spread(std::move(response));
  compare_clocks(f, measured.trips);

  if (const auto& there = measured.there) {
    f.out = way(sent, there->heard, ttl_here);
    f.back = way(there->answered, measured.heard, there->facts.ttl);
  }
  return f;
}

}  // namespace gyrotwin::netcheck
