// What a core makes of a record against what was recorded of it.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "clients/log/log.hpp"
#include "messages/channels.hpp"

namespace gyrotwin {

/// Message by message: the channel, the owner's epoch and the sequence say which belong together.
class Comparison {
 public:
  using Payload = std::vector<std::uint8_t>;

  /// Both in any order; of a repeat the last one counts.
  void made(Channel channel, std::int64_t epoch, std::int64_t sequence, const Payload& payload);
  void recorded(Channel channel, std::int64_t epoch, std::int64_t sequence, const Payload& payload);

  std::int64_t compared() const { return compared_; }
  std::int64_t different() const { return different_; }
  /// Names the message and its first field that differs; empty where none does.
  const std::string& first_difference() const { return first_difference_; }

 private:
  using Key = std::tuple<Channel, std::int64_t, std::int64_t>;

  /// Messages without their counterparts; where there are too many, the first that came goes.
  class Waiting {
   public:
    void keep(const Key& key, const Payload& payload);
    /// @return whether it was there
    bool take(const Key& key, Payload& payload);

   private:
    using Order = std::list<std::pair<Key, Payload>>;
    Order order_;  // of arrival
    std::map<Key, Order::iterator> place_;
  };

  void compare(const Key& key, const Payload& recorded, const Payload& made);

  Waiting made_, recorded_;
  std::int64_t compared_ = 0, different_ = 0;
  std::string first_difference_;
};

}  // namespace gyrotwin
