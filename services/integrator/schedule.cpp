#include "services/integrator/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/integrator/schedule_checks.hpp"
#include "services/integrator/simulated_sensors.hpp"
#include "services/runtime/refuse.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kForever = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kLastTick = 1'000'000'000'000'000;  // decades, and sums of it fit

}  // namespace

Schedule::Schedule(const Rig& rig, const model::Machine& machine) : rig_(rig), machine_(machine) {
  if (!rig.sensors) return;
  sensors_t healthy{};
  SimulatedSensors(rig, machine).measure(0, rig.initial_state(machine), {}, {}, healthy);
  sensors_ = healthy.valid;
  past_.resize(static_cast<std::size_t>(std::ceil(kLongestDelay / rig.loop.tick_s())) + 1);
}

bool Schedule::add(const request_t& request, std::int64_t tick, reply_t& reply) noexcept {
  if (!check_request(request, rig_, machine_, sensors_, reply)) return false;
  if (count_ == kCapacity) {
    return refuse(reply, "{} disturbances and faults act or are to come; cancel one, or clear",
                  kCapacity);
  }
  Entry& entry = entries_[count_];
  entry = {};
  entry.request = request;
  if (!place(entry, tick, reply) || !has_room_for(entry, reply)) return false;

  const double dt = rig_.loop.tick_s();
  if (entry.disturbs(request_t::GUST)) {
    entry.gusts.fill(DrydenAlong(dt, request.correlation_s));
  }
  if (entry.disturbs(request_t::WIND) && request.turbulence_m_s != 0.0) {
    const double correlation = request.length_m / request.speed_m_s;
    entry.gusts[0] = DrydenAlong(dt, correlation);
    entry.across = DrydenAcross(dt, correlation);
  }
  entry.id = next_id_++;
  ++count_;

  reply.result = reply_t::APPLIED;
  reply.id = entry.id;
  reply.applied_tick = entry.begin;
  if (entry.end == kForever) {
    set_text(reply.text, "number {}, from tick {} until it is cancelled", entry.id, entry.begin);
  } else {
    set_text(reply.text, "number {}, ticks {} to {}", entry.id, entry.begin, entry.end - 1);
  }
  return true;
}

/// Sets the first and the last tick.
bool Schedule::place(Entry& entry, std::int64_t tick, reply_t& reply) const noexcept {
  const request_t& request = entry.request;
  // The readings of the present tick are out already.
  const std::int64_t first = entry.on_sensor() ? tick + 1 : tick;
  if (request.start_tick > kLastTick) return refuse(reply, "start ticks end at {}", kLastTick);
  if (request.start_tick != 0 && request.start_tick < first) {
    return refuse(reply, "tick {} is over; the next one it can act in is {}", request.start_tick,
                  first);
  }
  entry.begin = std::max(request.start_tick, first);
  entry.end = request.duration_ns == 0 ? kForever : entry.begin + to_ticks(request.duration_ns);
  return true;
}

/// The machine takes few added masses at a time.
bool Schedule::has_room_for(const Entry& entry, reply_t& reply) const noexcept {
  if (!entry.disturbs(request_t::ADDED_MASS)) return true;
  const auto beside =
      std::count_if(entries_.begin(), entries_.begin() + count_, [&](const Entry& other) {
        return other.disturbs(request_t::ADDED_MASS) && other.begin < entry.end &&
               entry.begin < other.end;
      });
  if (beside < model::kMaxAddedMasses) return true;
  return refuse(reply, "{} masses are on the structure then already; cancel one",
                model::kMaxAddedMasses);
}

bool Schedule::cancel(std::int64_t id, reply_t& reply) noexcept {
  const int before = count_;
  forget([id](const Entry& entry) { return entry.id == id; });
  if (count_ == before) {
    return refuse(reply, "nothing of number {} acts or is to come in this run", id);
  }
  reply.result = reply_t::APPLIED;
  reply.id = id;
  set_text(reply.text, "number {} is cancelled", id);
  return true;
}

std::int64_t Schedule::to_ticks(std::int64_t time_ns) const noexcept {
  const std::int64_t period = rig_.loop.tick_ns();
  return std::max<std::int64_t>(1, (time_ns + period / 2) / period);
}

void Schedule::reset() noexcept {
  clear();
  next_id_ = 1;
}

bool Schedule::command_lost(std::int64_t tick) const noexcept {
  return std::any_of(entries_.begin(), entries_.begin() + count_, [tick](const Entry& entry) {
    return entry.fails(request_t::COMMAND_LOST) && entry.acts(tick);
  });
}

int Schedule::disturbances() const noexcept {
  return static_cast<int>(std::count_if(entries_.begin(), entries_.begin() + count_,
                                        [](const Entry& entry) { return entry.disturbs(); }));
}

int Schedule::faults() const noexcept { return count_ - disturbances(); }

}  // namespace gyrotwin
