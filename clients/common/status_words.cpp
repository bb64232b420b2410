#include "clients/common/status_words.hpp"

#include <iterator>
#include <numeric>

#include "clients/common/time_text.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

std::string distribution_text(std::int64_t p50, std::int64_t p99, std::int64_t max) {
  return fmt::format("p50 {}, p99 {}, max {}", time_text_ns(p50), time_text_ns(p99),
                     time_text_ns(max));
}

std::string process_text(const status_t& status) {
  return fmt::format("{} on {}", status.pid, get_text(status.host));
}

std::string_view pace_name(std::int32_t clock) {
  switch (clock) {
    case status_t::PACE_REALTIME:
      return "realtime";
    case status_t::PACE_LOCKSTEP:
      return "lockstep";
    case status_t::PACE_FREE:
      return "free";
    default:
      return "unknown";
  }
}

std::string counts_text(std::initializer_list<Count> all, std::string_view none) {
  std::string text;
  for (const Count& c : all) {
    if (c.count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", c.count, c.what);
  }
  return text.empty() ? std::string(none) : text;
}

std::string_view plant_name(const status_t& owner) {
  return owner.service == status_t::HARDWARE ? "real" : "simulated";
}

std::string clock_text(const link_t& link) {
  if (link.clock_offset_sigma_ns == 0) return "not known yet";
  return fmt::format("{:+.6f} s +-{}, {:+.1f} ppm",
                     1e-9 * static_cast<double>(link.clock_offset_ns),
                     time_text_ns(link.clock_offset_sigma_ns), link.clock_drift_ppm);
}

std::string line_losses_text(const link_t& link) {
  return counts_text({{link.samples_missed, "samples missed"},
                      {link.host_bad, "damaged"},
                      {link.host_dropped, "never sent"},
                      {link.device_bad, "damaged at the device"},
                      {link.device_dropped, "never sent by it"},
                      {link.reconnects, link.reconnects == 1 ? "time reopened" : "times reopened"}},
                     "nothing");
}

std::string verdict_text(const health_t& health) {
  const std::string text = get_text(health.text);
  return text.empty() ? "settling" : text;
}

std::string overruns_text(const status_t& owner) {
  return counts_text({{owner.overruns, "ticks too late"}, {owner.skipped_ticks, "skipped"}},
                     "none");
}

std::string refusals_text(const status_t& owner) {
  return counts_text({{owner.refused_not_finite, "not finite"},
                      {owner.refused_epoch, "for another run"},
                      {owner.refused_expired, "expired"},
                      {owner.refused_counter, "with a used counter"},
                      {owner.refused_writer, "without the lease"}},
                     "no commands");
}

std::int64_t sum(const std::int64_t (&slots)[kChannelSlots]) {
  return std::accumulate(std::begin(slots), std::end(slots), std::int64_t{0});
}

std::string lease_holder(const status_t& owner, const std::optional<status_t>& controller,
                         const std::optional<command_t>& command) {
  const std::int64_t writer = owner.command_writer;
  if (writer == 0) return "nobody";
  const bool known = command && command->writer == writer && controller &&
                     command->header.epoch == controller->header.epoch;
  return known ? "the controller" : fmt::format("writer {}", writer);
}

}  // namespace gyrotwin
