#include "clients/netcheck/host.hpp"

#include <sys/timex.h>

#include <cctype>
#include <filesystem>
#include <fstream>

#include "services/runtime/rig_bus.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin::netcheck {
namespace {

/// Whether some processor may clock itself down; a virtual one has no governor and says nothing.
bool saves_power() {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/devices/system/cpu", none)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("cpu") || name.size() < 4 || std::isdigit(name[3]) == 0) continue;
    std::ifstream file(entry.path() / "cpufreq/scaling_governor");
    std::string governor;
    if (file >> governor && governor != "performance") return true;
  }
  return false;
}

}  // namespace

HostFacts host_facts(const ProbeSocket& socket, const Rig& rig, const Rights& rights) {
  HostFacts facts;
  const Identity identity;
  set_text(facts.host, "{}", static_cast<const char*>(identity.host));
  set_text(facts.interface, "{}", rig.network.interface);
  facts.mtu = socket.mtu();
  facts.ttl = rig.network.ttl;
  facts.buffer_wanted = 2 * Bus::kReceiveBuffer;
  facts.buffer_granted = socket.granted_buffer();
  facts.priority_error = rights.priority_error;
  facts.memory_error = rights.memory_error;
  timex clock{};
  facts.clock_synchronised = ::adjtimex(&clock) != TIME_ERROR && (clock.status & STA_UNSYNC) == 0;
  facts.clock_max_error_ns = 1000 * clock.maxerror;
  facts.saves_power = saves_power();
  std::error_code none;
  facts.wireless = std::filesystem::exists(
      std::filesystem::path("/sys/class/net") / rig.network.interface / "wireless", none);
  return facts;
}

}  // namespace gyrotwin::netcheck
