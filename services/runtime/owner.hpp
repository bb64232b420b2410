// What every owner of a plant is, simulated or real: modes, obedience to commands, answers to
// operators. Pure: it sees neither bus nor clock; services/runtime/owner_desk.hpp wires it to them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "messages/channels.hpp"
#include "services/runtime/command_gate.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/rig.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

/// What the wiring knows about the others on the bus when a request comes.
struct Surroundings {
  bool controller_heard = false;   ///< within the last second
  bool other_owner_heard = false;  ///< within the last second
  std::int64_t fresh_epoch = 0;    ///< random; taken by a reset
};

/// The last answer to each of those who have asked. The longest silent one is forgotten first, but
/// not which counters it has used: a request that was recorded and comes again is not done again.
class Askers {
 public:
  Askers() { used_.reserve(kUsed); }

  /// The last answer to this writer, null when it has not asked before.
  const reply_t* last(std::int64_t writer) const noexcept {
    const auto asker = find(writer);
    return asker == answers_.end() ? nullptr : &*asker;
  }

  void remember(const reply_t& answer) noexcept {
    auto place = answers_.begin() + (find(answer.request_writer) - answers_.begin());
    if (place == answers_.end()) forget(*--place);
    std::move_backward(answers_.begin(), place, place + 1);
    answers_.front() = answer;
  }

  /// Whether an asker whose answer is forgotten has asked with this counter, or with a higher one.
  bool used(std::int64_t writer, std::int64_t counter) const noexcept {
    return std::ranges::any_of(
        used_, [=](const Used& used) { return used.writer == writer && counter <= used.counter; });
  }
  /// A new run: requests for the one before name its epoch.
  void begin_run() noexcept {
    used_.clear();
    oldest_ = 0;
  }

 private:
  struct Used {
    std::int64_t writer, counter;
  };
  static constexpr std::size_t kUsed = 65'536;  // 1 MB; all of them are looked through in 30 us

  void forget(const reply_t& answer) noexcept {
    if (answer.result == 0) return;
    const Used used{answer.request_writer, answer.request_counter};
    if (used_.size() < kUsed) {
      used_.push_back(used);
    } else {
      used_[oldest_++ % kUsed] = used;
    }
  }

  std::array<reply_t, 64>::const_iterator find(std::int64_t writer) const noexcept {
    return std::find_if(answers_.begin(), answers_.end(), [writer](const reply_t& answer) {
      return answer.result != 0 && answer.request_writer == writer;
    });
  }

  std::array<reply_t, 64> answers_{};
  std::vector<Used> used_;  // never grows beyond what is reserved
  std::size_t oldest_ = 0;  // once all places are taken
};

class Owner {
 public:
  virtual ~Owner() = default;
  Owner(const Owner&) = delete;
  Owner& operator=(const Owner&) = delete;

  /// @return whether the command is accepted
  virtual bool on_command(const command_t& command) noexcept;
  /// Does what is asked, or not; fills everything of `reply` but header and mac. A request that was
  /// answered already (same writer and counter) gets the same answer and is not done again; one
  /// that was recorded on the network and comes again later (a lower counter) is refused.
  /// @return false where the answer is somebody else's to give, see conclude()
  bool on_request(const request_t& request, const Surroundings& surroundings,
                  reply_t& reply) noexcept;
  /// Something noticed on the bus or in the loop; `why` is shown in STATUS.
  void notice(Event event, std::string_view why) noexcept { enter(event, why); }

  Mode mode() const noexcept { return mode_; }
  /// Why it is in this mode; empty where that needs no word.
  std::string_view why() const noexcept { return text_view(why_); }
  std::int64_t tick() const noexcept { return tick_; }
  std::int64_t epoch() const noexcept { return epoch_; }
  /// STATE's sequence: 0 while HELD, then tick + 1; the same run gives the same numbers.
  std::int64_t sequence() const noexcept { return mode_ == Mode::kHeld ? 0 : tick_ + 1; }
  std::int64_t sim_time_ns() const noexcept { return tick_ * rig_.loop.tick_ns(); }
  /// No valid command for the rig's timeout.
  bool timed_out() const noexcept { return gate_.lost(tick_); }

 protected:
  /// HELD.
  /// @param rig outlives the owner
  /// @param epoch random, of the first run
  Owner(const Rig& rig, std::int64_t epoch);

  /// Does what is asked and fills the reply's text, or refuses.
  /// @return false where the answer comes later, by conclude()
  virtual bool act(const request_t& request, const Surroundings& surroundings,
                   reply_t& reply) noexcept = 0;
  /// A way of the mode table is about to be taken.
  virtual void entering(Event event, Mode to) noexcept = 0;

  /// The verbs that the mode table knows: ARM, DISARM, PAUSE, RESUME, STEP.
  bool change_mode(const request_t& request, const Surroundings& surroundings,
                   reply_t& reply) noexcept;
  /// The answer to a request that was left for later.
  void conclude(const request_t& request, const reply_t& reply) noexcept;
  void enter(Event event, std::string_view why) noexcept;
  /// The tilt is beyond the rig's limit. What has stopped it before, if something has, stays told.
  void fall() noexcept;
  /// HELD at tick 0 of a new run.
  void begin_run(std::int64_t epoch) noexcept;
  /// Only what every owner knows: mode, text, pace, commands and requests.
  void fill_owner(status_t& status) const noexcept;

  const Rig& rig_;
  CommandGate gate_;
  std::int64_t tick_ = 0;

 private:
  Mode mode_ = Mode::kHeld;
  std::int64_t epoch_;
  Askers askers_;
  std::int64_t request_writer_ = 0, request_counter_ = 0;  // the last one that was applied
  std::uint8_t why_[128] = {};
};

}  // namespace gyrotwin
