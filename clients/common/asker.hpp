// Asking the owner of a rig for something, as an operator.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "messages/channels.hpp"
#include "services/runtime/bus.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// One operator on one rig's bus. Not thread-safe; blocks up to the limits below.
class Asker {
 public:
  static constexpr std::int64_t kOwnerPatience = 2'000'000'000;  ///< for the owner's STATUS [ns]

  /// Opens the rig's bus.
  /// @throws Error naming what is missing (key, interface, permission) and the fix
  Asker(const Rig& rig, Clock& clock);

  /// The owner's STATUS, waited for up to `patience_ns` when none was heard yet.
  /// @throws NotDone when none comes, with the most likely reason
  const status_t& owner(std::int64_t patience_ns = kOwnerPatience);

  /// Fills in who asks whom and sends the request until it is answered. A request is done once
  /// however often it is sent. Where the owner's run ended meanwhile, asks the new run, once.
  /// @return the answer, APPLIED or REFUSED
  /// @throws NotDone when no answer comes
  reply_t ask(request_t request);

  /// The clock that limits are counted on [ns].
  std::int64_t now_ns() const { return clock_.now_ns(); }

  /// Hands every reception to `done` until it returns true.
  /// @return false when `limit_ns` passed before
  template <class Done>
  bool listen(std::int64_t limit_ns, Done&& done) {
    const std::int64_t end = clock_.now_ns() + limit_ns;
    for (;;) {
      while (const auto reception = bus_.receive()) {
        if (done(*reception)) return true;
      }
      const std::int64_t left = end - clock_.now_ns();
      if (left <= 0) return false;
      bus_.wait(left);
    }
  }

  /// What the bus heard that speaks for a wrong key or a wrong rig; empty when nothing does.
  std::string suspicion();

 private:
  std::optional<reply_t> exchange(request_t& request);

  const Rig& rig_;
  Clock& clock_;
  Bus bus_;
  std::int64_t epoch_, writer_;  // of this operator
  std::int64_t counter_ = 0;
  std::optional<status_t> owner_;
};

/// The answer to a request, which must be APPLIED.
/// @param what stands before the owner's reason: "arm"
/// @throws NotDone otherwise
reply_t ask_or_throw(Asker& asker, const request_t& request, const std::string& what);

}  // namespace gyrotwin
