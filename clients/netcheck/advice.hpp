// What to fix, and with which command. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clients/netcheck/figures.hpp"
#include "clients/netcheck/measure.hpp"
#include "clients/netcheck/verdict.hpp"
#include "services/runtime/probe_socket.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin::netcheck {

/// One host that answered, and the line to it.
struct CheckedLine {
  Peer peer;
  Figures figures;
  LineVerdict verdict;
  double rate_hz = 0.0;            ///< at which it was measured
  std::int64_t over_rate = 0;      ///< pings that it did not answer, being too many
  std::int64_t unauthentic = 0;    ///< that it has heard since its start
  std::int64_t clock_step_ns = 0;  ///< by which this host's clock was set meanwhile
  std::string came_in_on{};        ///< interface of this host
};

/// All that was found.
struct Netcheck {
  Rig rig;
  std::string rig_words{};  ///< the options that name it, as a shell takes them
  int port = 0;             ///< of the probes
  bool alone = false;       ///< between two threads of this host
  std::size_t hosts = 0;    ///< so many must answer; 0: any
  std::string broken{};     ///< why nothing can be sent; empty: it can
  HostFacts here{};
  std::string address{};  ///< of this host
  ProbeCounters counters{};
  std::vector<CheckedLine> lines{};

  /// Every host that must answer does; of `hosts` 0 that is one.
  bool complete() const;
  /// It is complete, and every line is good for the rig's own rate.
  bool good() const;
};

struct Advice {
  std::string text;
  std::vector<std::string> commands;  ///< as a shell takes them, quoted; empty: none would do
  bool operator==(const Advice&) const = default;
};

/// Of the lines first, then of each host.
std::vector<Advice> advice(const Netcheck& check);

}  // namespace gyrotwin::netcheck
