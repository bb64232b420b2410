#include "services/runtime/rig_bus.hpp"

#include <unistd.h>

#include <algorithm>
#include <iterator>

#include "services/runtime/text.hpp"

namespace gyrotwin {

BusConfig bus_config(const Rig& rig, std::int32_t source) {
  BusConfig config;
  config.prefix = rig.network.prefix;
  config.rig_id = rig.id;
  config.source = source;
  config.group = rig.network.group;
  config.port = rig.network.port;
  config.interface = rig.network.interface;
  config.ttl = rig.network.ttl;
  if (rig.network.sign) config.key = load_key(key_path(rig.name));
  return config;
}

std::string reach(const Rig& rig) {
  return fmt::format("{} ({}, {}:{})", rig.network.ttl == 0 ? "this host only" : "this subnet",
                     rig.network.interface, rig.network.group, rig.network.port);
}

Identity::Identity() noexcept : pid(::getpid()) { ::gethostname(host, sizeof(host) - 1); }

void fill_process(status_t& status, const Identity& identity,
                  const BusCounters& counters) noexcept {
  status.pid = identity.pid;
  set_text(status.host, "{}", static_cast<const char*>(identity.host));
  status.malformed = counters.malformed;
  status.foreign = counters.foreign;
  status.other_rig = counters.other_rig;
  status.unauthentic = counters.unauthentic;
  status.kernel_dropped = counters.kernel_dropped;
  status.send_failed = counters.send_failed;
  std::copy(counters.sent.begin(), counters.sent.end(), std::begin(status.sent));
  std::copy(counters.received.begin(), counters.received.end(), std::begin(status.received));
  std::copy(counters.gaps.begin(), counters.gaps.end(), std::begin(status.gaps));
  std::copy(counters.repeats.begin(), counters.repeats.end(), std::begin(status.repeats));
  std::copy(counters.reordered.begin(), counters.reordered.end(), std::begin(status.reordered));
}

void fill_loop(status_t& status, Pacer& pacer) noexcept {
  status.overruns = pacer.overruns();
  status.skipped_ticks = pacer.skipped_ticks();
  status.lateness_p50_ns = pacer.lateness().p50();
  status.lateness_p99_ns = pacer.lateness().p99();
  status.lateness_max_ns = pacer.lateness().max();
  status.compute_p50_ns = pacer.compute().p50();
  status.compute_p99_ns = pacer.compute().p99();
  status.compute_max_ns = pacer.compute().max();
}

}  // namespace gyrotwin
