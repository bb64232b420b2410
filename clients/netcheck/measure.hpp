// This end: who answers, and how well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "clients/netcheck/figures.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/probe_socket.hpp"

namespace gyrotwin::netcheck {

/// A host that answers.
struct Peer {
  std::int64_t answerer = 0;  ///< its run
  std::string address;
  HostFacts facts{};
};

/// What measuring needs; all outlive it.
struct Line {
  ProbeSocket& socket;
  Clock& clock;
  std::function<bool()> stopping;
  std::int64_t patience_ns;  ///< how long to wait for what may still come, once all is sent
};

/// Asks everybody, several times in case some of it is lost, for as long as patience lasts or until
/// `enough` have answered. In the order of addresses.
/// @param enough 0: nobody knows how many there are
std::vector<Peer> find_peers(const Line& line, std::size_t enough);

/// Pings at absolute deadlines, waits for what is still on its way, asks for the other's account.
/// A deadline that was slept through is given up, as an owner does. Ends early when stopping.
/// @param rate_hz of the pings
/// @param ticks deadlines
Measurement measure(const Line& line, const Peer& peer, double rate_hz, std::int64_t ticks);

}  // namespace gyrotwin::netcheck
