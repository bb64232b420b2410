// Requests of clients on their way to the owner: one after the other, each sent again until it is
// answered. Pure.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>

#include "messages/channels.hpp"

namespace gyrotwin {

class Requests {
 public:
  static constexpr std::size_t kMost = 64;  ///< that wait for an answer

  /// Signs a request and sends it.
  using Send = std::function<void(request_t request, std::int64_t sequence)>;

  explicit Requests(Send send);

  /// Puts a request in the queue; who asks without an identity gets the gateway's.
  /// @return false when too many wait
  bool ask(request_t request, std::int64_t now_ns);

  /// Before a DISARM: forgets all requests that are not answered yet, but for earlier DISARMs, so
  /// that it need not wait for them and they do not act after it. @return how many
  std::size_t forget();

  /// Sends again what was not answered.
  /// @return false when the owner answers nothing: whatever waited is forgotten
  bool on_timer(std::int64_t now_ns);
  void on_reply(const reply_t& reply, std::int64_t now_ns);

 private:
  void begin(std::int64_t now_ns);
  void send(std::int64_t now_ns);

  Send send_;
  std::int64_t writer_, counter_ = 0;
  std::deque<request_t> waiting_;            // the first is on its way
  std::int64_t sequence_ = 0, sent_ns_ = 0;  // of the first
  int tries_ = 0;
};

}  // namespace gyrotwin
