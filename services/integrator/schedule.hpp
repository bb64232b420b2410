// What operators have asked to go wrong: disturbances and faults, each from one tick to another.
// The live owner and `simulate` use the same one. Meaning of the fields: messages/README.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "messages/channels.hpp"
#include "services/integrator/dryden.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

class Schedule {
 public:
  static constexpr int kCapacity = 64;  ///< disturbances and faults, acting or to come

  /// @param rig, machine must outlive the schedule
  Schedule(const Rig& rig, const model::Machine& machine);

  /// Takes a request with the verb DISTURB or FAULT, or not. Fills result, id, applied_tick and
  /// text of `reply`. What this rig cannot do is refused. @param tick the next one to run
  bool add(const request_t& request, std::int64_t tick, reply_t& reply) noexcept;
  /// Ends one. @return false, and says so in `reply`, when there is none of this number
  bool cancel(std::int64_t id, reply_t& reply) noexcept;
  /// Ends all. Numbers go on.
  void clear() noexcept { count_ = 0; }
  /// A new run: ends all, numbers from 1 again.
  void reset() noexcept;

  /// Adds to the input what acts in `tick`: disturbances, faults of drives and rotors, in the order
  /// of asking; forgets what is over. To be called once a tick, in order.
  void apply(std::int64_t tick, model::Input& input) noexcept;
  /// Faults of sensors at `tick`, in the order of asking, delays first; forgets what is over. Once
  /// a tick, in order, from tick 0.
  void corrupt(std::int64_t tick, sensors_t& sensors) noexcept;
  /// Commands do not arrive in `tick`.
  bool command_lost(std::int64_t tick) const noexcept;

  int disturbances() const noexcept;
  int faults() const noexcept;

 private:
  struct Entry {
    request_t request;
    std::int64_t id;
    std::int64_t begin, end;           // acts in [begin, end)
    std::array<DrydenAlong, 6> gusts;  // GUST: force, moment; WIND: [0] along the wind
    DrydenAcross across;               // WIND
    sensors_t kept;                    // SENSOR_STUCK: the reading at the onset

    bool acts(std::int64_t tick) const noexcept { return begin <= tick && tick < end; }
    bool disturbs() const noexcept { return request.verb == request_t::DISTURB; }
    bool disturbs(std::int32_t kind) const noexcept { return disturbs() && request.kind == kind; }
    bool fails(std::int32_t kind) const noexcept { return !disturbs() && request.kind == kind; }
    bool on_sensor() const noexcept {
      return !disturbs() && request.kind <= request_t::SENSOR_DELAYED;
    }
  };

  bool place(Entry& entry, std::int64_t tick, reply_t& reply) const noexcept;
  bool has_room_for(const Entry& entry, reply_t& reply) const noexcept;
  void disturb(Entry& entry, std::int64_t tick, model::Input& input) const noexcept;
  void blow(Entry& entry, std::int64_t tick, double rise, model::Input& input) const noexcept;
  void fail(const request_t& request, model::Input& input) const noexcept;
  void corrupt(Entry& entry, std::int64_t tick, sensors_t& sensors) const noexcept;
  int channels(std::int32_t sensor) const noexcept;
  std::int64_t to_ticks(std::int64_t time_ns) const noexcept;  // at least one
  template <class Over>
  void forget(Over&& over) noexcept {
    const auto end = std::remove_if(entries_.begin(), entries_.begin() + count_, over);
    count_ = static_cast<int>(end - entries_.begin());
  }

  const Rig& rig_;
  const model::Machine& machine_;
  std::int32_t sensors_ = 0;     // VALID_* that the rig has
  std::vector<sensors_t> past_;  // the longest delay of healthy readings; place tick modulo size
  std::array<Entry, kCapacity> entries_{};
  int count_ = 0;
  std::int64_t next_id_ = 1;
};

}  // namespace gyrotwin
