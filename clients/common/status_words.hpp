// STATUS in words, for people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "messages/channels.hpp"

namespace gyrotwin {

/// "p50 70 us, p99 1.25 ms, max 2 s".
std::string distribution_text(std::int64_t p50, std::int64_t p99, std::int64_t max);

/// "4711 on lab".
std::string process_text(const status_t& status);

/// "realtime", "lockstep", "free".
std::string_view pace_name(std::int32_t clock);

/// So many of something.
struct Count {
  std::int64_t count;
  std::string_view what;
};

/// Those that are not 0, "3 late, 1 lost", or `none`.
std::string counts_text(std::initializer_list<Count> all, std::string_view none);

/// Whether the plant of an owner is "simulated" or "real".
std::string_view plant_name(const status_t& owner);

/// A device's clock against its host's: "+1000.000052 s +-20 us, +12.3 ppm".
std::string clock_text(const link_t& link);

/// What the line to a device has lost: "3 samples missed, 2 damaged, 1 time reopened" or
/// "nothing".
std::string line_losses_text(const link_t& link);

/// The verdict of a twin in words.
std::string verdict_text(const health_t& health);

/// "3 ticks too late, 1 skipped" or "none".
std::string overruns_text(const status_t& owner);

/// Commands that an owner did not obey, by reason: "7 expired" or "no commands".
std::string refusals_text(const status_t& owner);

/// Sum over the channels.
std::int64_t sum(const std::int64_t (&slots)[kChannelSlots]);

/// Who holds the owner's command lease: "nobody", "the controller", "writer ...".
/// @param command the last one heard
std::string lease_holder(const status_t& owner, const std::optional<status_t>& controller,
                         const std::optional<command_t>& command);

}  // namespace gyrotwin
