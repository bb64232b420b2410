// What waits to be sent to one client, bounded: who reads too slowly loses data, and only he.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gyrotwin {

using SharedBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

/// One WebSocket message: a head of its own before a body that clients share.
struct Outgoing {
  std::array<std::uint8_t, 13> head;
  std::size_t head_size = 0;
  SharedBytes body{};  ///< may be null
  bool is_text = false;
  bool is_data = false;  ///< may be left out

  std::size_t size() const { return head_size + (body ? body->size() : 0); }
};

/// First in, first out. Data beyond its room pushes the oldest data out; what is no data stays, and
/// when even that is too much the client is to be let go.
class Outbox {
 public:
  static constexpr std::size_t kRoom = 512 << 10;  ///< data and all else, each [byte]

  void put(Outgoing message) {
    std::size_t& held = message.is_data ? data_ : other_;
    held += message.size();
    waiting_.push_back(std::move(message));
    while (data_ > kRoom) drop_oldest();
  }
  void put_text(std::string_view text) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(text.data());
    put({.head = {},
         .body = std::make_shared<const std::vector<std::uint8_t>>(begin, begin + text.size()),
         .is_text = true});
  }

  bool empty() const { return waiting_.empty(); }
  bool overfull() const { return other_ > kRoom; }
  Outgoing take() {
    Outgoing message = std::move(waiting_.front());
    waiting_.pop_front();
    (message.is_data ? data_ : other_) -= message.size();
    return message;
  }

  std::int64_t dropped() const { return dropped_; }    ///< messages left out so far
  std::size_t size() const { return data_ + other_; }  ///< [byte]

 private:
  void drop_oldest() {
    auto oldest = waiting_.begin();
    while (!oldest->is_data) ++oldest;
    data_ -= oldest->size();
    waiting_.erase(oldest);
    ++dropped_;
  }

  std::deque<Outgoing> waiting_;
  std::size_t data_ = 0, other_ = 0;  // [byte]
  std::int64_t dropped_ = 0;
};

}  // namespace gyrotwin
