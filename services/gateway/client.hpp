// One client of the socket, as the gateway knows it.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "messages/channels.hpp"
#include "services/gateway/access.hpp"
#include "services/gateway/outbox.hpp"

namespace gyrotwin {

struct Client {
  static constexpr std::size_t kMostEntries = 256;  ///< of each table below

  Role role = Role::kObserver;
  Outbox outbox;
  std::map<std::uint32_t, Channel> subscriptions;     ///< by the client's number
  std::map<std::uint32_t, std::string> publications;  ///< topics that it publishes, by its number
  std::set<std::string, std::less<>> watched;         ///< parameters it wants to hear of
  bool watches_all = false;
  std::int64_t drops_told = 0;  ///< of outbox.dropped()
};

}  // namespace gyrotwin
