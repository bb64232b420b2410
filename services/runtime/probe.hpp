// What `gyrotwin netcheck` says on the network, on a port of its own: datagrams as large as STATE
// and COMMAND, in the bus's envelope and signed like them. No socket and no clock. Layout and
// reasons: clients/netcheck/README.md.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "services/runtime/datagram.hpp"

namespace gyrotwin::netcheck {

/// No count or size of a good probe is larger, so that what is computed of them cannot overflow.
inline constexpr std::int64_t kProbeMost = std::int64_t{1} << 53;
/// All stamps of a good probe are before: the year 2116. Their differences fit, and sums of two.
inline constexpr std::int64_t kProbeLatest = std::int64_t{1} << 62;

/// Who runs a program and what its host grants it; each end tells its own.
struct HostFacts {
  std::uint8_t host[32] = {};           ///< name, see set_text()
  std::uint8_t interface[16] = {};      ///< network.interface
  std::int64_t mtu = 0;                 ///< largest IP packet of the interface [bytes]
  std::int64_t ttl = 0;                 ///< network.ttl: what it sends with
  std::int64_t buffer_wanted = 0;       ///< of the receiving socket [bytes]
  std::int64_t buffer_granted = 0;      ///< the same, as the kernel counts: twice the payload
  std::int64_t priority_error = 0;      ///< asking for SCHED_FIFO: 0 granted, else errno
  std::int64_t memory_error = 0;        ///< asking for locked memory: the same
  std::int64_t clock_synchronised = 0;  ///< 1: the kernel's clock follows another one
  std::int64_t clock_max_error_ns = 0;  ///< of a synchronised clock, as the kernel tells it
  std::int64_t saves_power = 0;         ///< 1: a processor's governor is not `performance`
  std::int64_t wireless = 0;            ///< 1: the interface is a radio
};

/// What one end has heard of the other in one session.
struct Heard {
  std::int64_t distinct = 0;  ///< messages, each counted once
  std::int64_t repeats = 0;   ///< came once more
  std::int64_t late = 0;      ///< came after one that was sent later
  std::int64_t ttl_min = -1;  ///< with which they arrived; -1 before the first
  std::int64_t ttl_max = -1;
  std::int64_t kernel_dropped = 0;  ///< of everything, as this end's buffer was full
  std::uint8_t interface[16] = {};  ///< on which they came in
};

/// Who is there, and what have you heard? A Report answers.
struct Question {
  static constexpr std::int64_t kEverybody = -1;
  std::int64_t session = 0;  ///< random, one measurement of whoever asks
  std::int64_t target = kEverybody;
  std::int64_t serial = 0;  ///< counts the questions of a session
};

/// As large as STATE. An Answer answers each one once, however often it comes.
struct Ping {
  std::int64_t session = 0;
  std::int64_t target = 0;
  std::int64_t sequence = 0;  ///< 0, 1, 2 ...
};

/// As large as COMMAND.
struct Answer {
  std::int64_t session = 0;
  std::int64_t answerer = 0;     ///< random, one run of whoever answers
  std::int64_t sequence = 0;     ///< of the ping
  std::int64_t number = 0;       ///< counts the answers of a session from 0
  std::int64_t received_ns = 0;  ///< when the answerer's kernel had the ping: its wall clock
  std::int64_t sent_ns = 0;      ///< when this was sent: the same clock
};

/// Not larger than the question, so that nobody is made to amplify.
struct Report {
  std::int64_t session = 0;
  std::int64_t answerer = 0;
  std::int64_t serial = 0;       ///< of the question
  std::int64_t answered = 0;     ///< pings of this session
  std::int64_t over_rate = 0;    ///< pings that were too many to answer
  std::int64_t unauthentic = 0;  ///< datagrams with a wrong signature, of anybody
  HostFacts facts{};
  Heard heard{};
};

using Probe = std::variant<Question, Ping, Answer, Report>;

/// Writes and judges the datagrams of one rig's probes.
class ProbeFormat {
 public:
  /// @throws Error when the prefix is none
  ProbeFormat(const std::string& prefix, std::int32_t rig_id, const std::optional<Key>& key);

  struct Judged {
    Verdict verdict;
    Probe probe{};  ///< when the verdict is kGood
  };
  /// Takes any bytes. What is good has numbers within kProbeMost and kProbeLatest; counts and
  /// stamps are not negative.
  Judged judge(std::span<const std::uint8_t> datagram) const noexcept;

  /// Writes and signs a datagram. @return its size
  std::size_t write(Frame& frame, const Probe& probe) const noexcept;

 private:
  std::string prefix_;  // with the slash
  std::int32_t rig_id_;
  std::optional<Key> key_;
  DatagramFormat envelope_;
};

}  // namespace gyrotwin::netcheck
