// Two hosts and a bad line between them, whose faults are counted: network namespaces joined by
// this process, which hands frames from one to the other, or does not.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin::support {

/// What one way of the line does to the datagrams that are counted: each n-th, counted from 1; 0:
/// none. What is lost is not doubled or held.
struct LineFaults {
  int lose_each = 0;
  int double_each = 0;
  int hold_each = 0;  ///< until the next one has gone by
};

/// What it has done.
struct LineCounts {
  std::int64_t came = 0, lost = 0, doubled = 0, held = 0;
  std::int64_t others = 0;  ///< datagrams of another size, which have passed
};

/// Needs root in a network namespace of its own, as tests/support/in_namespace gives it. The far
/// end of each way is `lab0` in that host's namespace, with the address 198.51.100.1 or .2.
class BadLine {
 public:
  /// @param port UDP port of the datagrams; everything else is cut
  /// @param size of the UDP payload of those that the faults are for, one number each way: from the
  ///        first host and from the second; others pass
  BadLine(int port, std::array<int, 2> size);
  ~BadLine();
  BadLine(const BadLine&) = delete;
  BadLine& operator=(const BadLine&) = delete;

  /// Begins to hand frames over. `delay_ns` at least, on each way.
  void start(std::array<LineFaults, 2> faults, std::int64_t delay_ns);
  /// Ends it. @return what was done, for each way
  std::array<LineCounts, 2> stop();

  /// What runs a program on host 0 or 1: the words before its own.
  std::vector<std::string> on_host(int host) const;

 private:
  struct Frame {
    std::int64_t due_ns;
    std::vector<std::uint8_t> bytes;
  };
  /// From one host to the other.
  struct Way {
    LineFaults faults;
    LineCounts counts;
    std::deque<Frame> under_way;
    std::optional<std::vector<std::uint8_t>> held;
  };

  void carry(const std::stop_token& stop);
  bool take_frame(int from);
  void hand_over(int from, std::vector<std::uint8_t> bytes);
  bool counts(int from, const std::vector<std::uint8_t>& frame) const;

  int port_;
  std::array<int, 2> size_;
  std::int64_t delay_ns_ = 0;
  std::array<pid_t, 2> hosts_{-1, -1};
  std::array<Descriptor, 2> ends_;
  std::array<Way, 2> ways_;
  std::jthread carrier_;
};

}  // namespace gyrotwin::support
