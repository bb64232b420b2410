#include "clients/log/log_info.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "messages/channels.hpp"
#include "services/runtime/mode.hpp"
#include "services/schema/lcm_text.hpp"

namespace gyrotwin {

namespace {

double seconds_between(std::int64_t first_us, std::int64_t last_us) {
  return 1e-6 * (static_cast<double>(last_us) - static_cast<double>(first_us));
}

/// An event whose type is known.
struct Message {
  const LcmType& type;
  std::span<const std::uint8_t> payload;
  double seconds;

  std::int64_t get(std::string_view path) const {
    const auto number = locate(type, path);
    return number ? integer_at(payload, *number) : 0;
  }
};

RunInfo& run_of(LogInfo& info, std::int64_t epoch, const Message& message) {
  const auto known = std::ranges::find(info.runs, epoch, &RunInfo::epoch);
  if (known != info.runs.end()) return *known;
  const std::int64_t tick = message.get("header.tick");
  return info.runs.emplace_back(
      RunInfo{epoch, message.seconds, message.seconds, tick, tick, {}, {}});
}

/// STATE and STATUS of the owner.
void take_owner(LogInfo& info, const Message& message) {
  RunInfo& run = run_of(info, message.get("header.epoch"), message);
  run.last_s = message.seconds;
  run.last_tick = std::max(run.last_tick, message.get("header.tick"));
  const std::string mode(mode_name(static_cast<std::int32_t>(message.get("mode"))));
  if (run.modes.empty() || run.modes.back() != mode) run.modes.push_back(mode);
}

RequestInfo& request_of(RunInfo& run, std::int64_t writer, std::int64_t counter,
                        const Message& message) {
  for (RequestInfo& request : run.requests) {
    if (request.writer == writer && request.counter == counter) return request;
  }
  return run.requests.emplace_back(
      RequestInfo{.writer = writer,
                  .counter = counter,
                  .seconds = message.seconds,
                  .verb = std::string(verb_name(static_cast<std::int32_t>(message.get("verb")))),
                  .result = "no answer",
                  .text = {}});
}

void take_request(LogInfo& info, const Message& message) {
  RunInfo& run = run_of(info, message.get("owner_epoch"), message);
  request_of(run, message.get("writer"), message.get("counter"), message);
}

/// A reset is answered by the run that it begins.
void take_reply(LogInfo& info, const Message& message) {
  const std::int64_t writer = message.get("request_writer");
  const std::int64_t counter = message.get("request_counter");
  RequestInfo* asked = nullptr;
  for (RunInfo& run : info.runs) {
    for (RequestInfo& request : run.requests) {
      if (request.writer == writer && request.counter == counter) asked = &request;
    }
  }
  if (asked == nullptr) {
    asked =
        &request_of(run_of(info, message.get("header.epoch"), message), writer, counter, message);
  }
  const bool applied = message.get("result") == reply_t::APPLIED;
  asked->result = applied ? "APPLIED" : "REFUSED";
  asked->tick = applied ? message.get("applied_tick") : 0;
  asked->text = text_at(message.type, message.payload, "text");
}

void count(ChannelInfo& channel, const LogEvent& event) {
  if (channel.messages == 0) channel.first_us = event.time_us;
  channel.last_us = event.time_us;
  ++channel.messages;
  channel.bytes += static_cast<std::int64_t>(event.data.size());
}

void take_order(ChannelInfo& channel, const Message& message) {
  const std::int64_t epoch = message.get("header.epoch");
  const std::int64_t sequence = message.get("header.sequence");
  if (epoch < 0 || sequence < 0) return;
  const auto [place, missing] = channel.order.hear(epoch, sequence);
  channel.gaps = add_saturating(channel.gaps, missing);
  if (place == SequenceOrder::Place::kRepeat) ++channel.repeats;
  if (place == SequenceOrder::Place::kOlder) ++channel.reordered;
}

bool ends_with(std::string_view channel, Channel which) {
  const std::string_view suffix = spec(which).suffix;
  return channel.size() > suffix.size() && channel.ends_with(suffix) &&
         channel[channel.size() - suffix.size() - 1] == '/';
}

}  // namespace

double ChannelInfo::rate_hz() const {
  const double span = seconds_between(first_us, last_us);
  return messages > 1 && span > 0.0 ? static_cast<double>(messages - 1) / span : 0.0;
}

double LogInfo::duration_s() const { return seconds_between(first_us, last_us); }

LogInfo survey(Log& log) {
  LogInfo info;
  while (const auto event = log.next()) {
    if (is_log_channel(event->channel)) continue;
    if (info.messages++ == 0) info.first_us = event->time_us;
    info.last_us = event->time_us;
    ChannelInfo& channel = info.channels[std::string(event->channel)];
    count(channel, *event);
    const LcmType* type = log.catalog().type_of(*event);
    if (type == nullptr) continue;
    channel.type = type->name;
    const Message message{*type, event->data, seconds_between(info.first_us, event->time_us)};
    if (locate(*type, "header.sequence")) take_order(channel, message);
    if (ends_with(event->channel, Channel::kState) ||
        ends_with(event->channel, Channel::kIntegratorStatus) ||
        ends_with(event->channel, Channel::kHardwareStatus)) {
      take_owner(info, message);
    } else if (ends_with(event->channel, Channel::kRequest)) {
      take_request(info, message);
    } else if (ends_with(event->channel, Channel::kReply)) {
      take_reply(info, message);
    }
  }
  return info;
}

}  // namespace gyrotwin
