// What is in a log: channels, runs, requests.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "clients/log/log.hpp"
#include "services/runtime/sequence_order.hpp"

namespace gyrotwin {

/// The messages of one channel.
struct ChannelInfo {
  std::string type;  ///< empty: unknown
  std::int64_t messages = 0, bytes = 0;
  std::int64_t first_us = 0, last_us = 0;
  std::int64_t gaps = 0, repeats = 0, reordered = 0;  ///< as a bus counts
  SequenceOrder order;

  double rate_hz() const;  ///< 0 where there are not two messages
};

/// A request that was seen, or its answer.
struct RequestInfo {
  std::int64_t writer, counter;
  double seconds;  ///< since the first message
  std::string verb;
  std::string result;     ///< APPLIED, REFUSED or "no answer"
  std::int64_t tick = 0;  ///< APPLIED: the first it acts in
  std::string text;       ///< of the answer
};

/// One epoch of the rig's owner.
struct RunInfo {
  std::int64_t epoch;
  double first_s, last_s;  ///< since the first message
  std::int64_t first_tick, last_tick;
  std::vector<std::string> modes;  ///< in the order they came
  std::vector<RequestInfo> requests;
};

struct LogInfo {
  std::int64_t messages = 0;  ///< without the log's own events
  std::int64_t first_us = 0, last_us = 0;
  std::map<std::string, ChannelInfo, std::less<>> channels;
  std::vector<RunInfo> runs;  ///< in the order they were first heard

  double duration_s() const;
};

/// Reads a log to its end.
LogInfo survey(Log& log);

/// For people, and for programs.
std::string info_text(const std::string& file, const Log& log, const LogInfo& info);
std::string info_json(const std::string& file, const Log& log, const LogInfo& info);

}  // namespace gyrotwin
