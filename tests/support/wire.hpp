// A switch between network interfaces that is a bad network on request: what `tc netem` does, but
// seeded, and on any kernel. Frames pass through this process.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <queue>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin::support {

/// What happens to frames. Every copy to every receiver is drawn by itself.
struct Troubles {
  double loss = 0.0;        ///< share that never arrive [1]
  double duplicated = 0.0;  ///< share that arrive twice [1]
  double overtaken = 0.0;  ///< share held back for overtaken_s, so that later ones arrive first [1]
  double overtaken_s = 0.0;
  double delay_s = 0.0;          ///< of all
  double jitter_s = 0.0;         ///< delay_s is uniform within +-jitter_s
  double rate_bit_s = 0.0;       ///< of a port to its host; 0: as fast as it goes
  double longest_queue_s = 0.1;  ///< what would have to wait longer for that rate is dropped
};

class Wire {
 public:
  /// Joins these interfaces of the present network namespace, port 0 first. Needs CAP_NET_RAW.
  Wire(const std::vector<std::string>& interfaces, std::uint64_t seed);
  ~Wire();
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;

  /// From now on; what is on its way stays so.
  void set(const Troubles& troubles);
  /// Nothing to or from this port, or everything again.
  void cut(std::size_t port, bool is_cut);

 private:
  using Bytes = std::vector<std::uint8_t>;
  /// A copy on its way to a port.
  struct Copy {
    std::int64_t due_ns;
    std::uint64_t number;  // what is due at once leaves in the order in which it came
    std::size_t port;
    Bytes frame;
    bool operator>(const Copy& other) const {
      return due_ns != other.due_ns ? due_ns > other.due_ns : number > other.number;
    }
  };

  void work();
  void take_from(std::size_t port, std::int64_t now);
  void schedule(const Bytes& frame, std::size_t port, std::int64_t now);
  void deliver(std::int64_t now);
  bool happens(double share) { return share > 0.0 && uniform_(random_) < share; }

  std::vector<Descriptor> ports_;
  std::mutex mutex_;  // of the two below
  Troubles troubles_;
  std::vector<bool> cut_;

  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  std::priority_queue<Copy, std::vector<Copy>, std::greater<>> on_their_way_;
  std::vector<std::int64_t> free_at_;  // [ns] when a port has sent what waits for its rate
  std::uint64_t copies_ = 0;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace gyrotwin::support
