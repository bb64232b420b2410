// The way there and back, as one subject of loop_bench makes it: what an owner and a controller do
// of one tick, without the plant and the law.
#pragma once

#include <memory>
#include <string_view>

namespace gyrotwin::bench {

/// The owner's end.
class Near {
 public:
  virtual ~Near() = default;
  /// Sends a STATE and waits for the COMMAND that answers it. @return whether it came within 0.1 s
  virtual bool there_and_back() = 0;
};

/// The controller's end, in a process of its own.
class Far {
 public:
  virtual ~Far() = default;
  /// Waits for a STATE, for 0.1 s or longer, and answers it with a COMMAND.
  virtual void answer() = 0;
};

/// Each has ports or groups of its own, so that none pays for another's datagrams. Both ends throw
/// where something is missing.
struct Subject {
  std::string_view name;  ///< as it stands in the figures
  std::unique_ptr<Near> (*near)();
  std::unique_ptr<Far> (*far)();
};

inline constexpr int kPatienceMs = 100;

std::unique_ptr<Near> raw_udp_near();
std::unique_ptr<Far> raw_udp_far();
std::unique_ptr<Near> raw_multicast_near();
std::unique_ptr<Far> raw_multicast_far();
std::unique_ptr<Near> bus_near();
std::unique_ptr<Far> bus_far();
std::unique_ptr<Near> signed_bus_near();
std::unique_ptr<Far> signed_bus_far();
std::unique_ptr<Near> liblcm_near();
std::unique_ptr<Far> liblcm_far();
std::unique_ptr<Near> zeromq_near();
std::unique_ptr<Far> zeromq_far();
std::unique_ptr<Near> zeromq_ipc_near();
std::unique_ptr<Far> zeromq_ipc_far();
std::unique_ptr<Near> cyclone_near();
std::unique_ptr<Far> cyclone_far();

}  // namespace gyrotwin::bench
