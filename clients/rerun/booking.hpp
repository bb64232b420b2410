// What a rerun makes, against what was recorded of it.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "clients/common/run_name.hpp"
#include "clients/rerun/comparison.hpp"
#include "clients/rerun/rerun.hpp"

namespace gyrotwin {

template <class Message>
Comparison::Payload encoded(const Message& message) {
  Comparison::Payload payload(kWireSize<Message>);
  message.encode(payload.data(), 0, static_cast<int>(payload.size()));
  return payload;
}

/// Without what differs from run to run: messages/README.md.
template <class Message>
Comparison::Payload comparable(Message message) {
  message.header.sender_mono_ns = 0;
  message.header.source = header_t::TWIN;
  if constexpr (std::is_same_v<Message, health_t>) message.step_p50_ns = message.step_max_ns = 0;
  if constexpr (std::is_same_v<Message, command_t>) {
    message.header.epoch = message.writer = message.counter = 0;
  }
  std::ranges::fill(message.mac, 0);
  return encoded(message);
}

/// Hands on what is made, and keeps account. What the recorded core knew is what the record tells
/// only where that has its run from the start and each of its answers.
class Booking {
 public:
  /// @param answers where the core answers each message
  Booking(const Rig& rig, std::int32_t source, Channel answers, bool remembers, const Take& take)
      : rig_(rig), source_(source), answers_(answers), remembers_(remembers), take_(take) {}

  /// A message that the core goes by.
  /// @param first the tick at which the core remembers nothing yet
  void heard(std::int64_t epoch, std::int64_t tick, std::int64_t first) {
    heard();
    if (epoch == run_) return;
    run_ = epoch;
    known_ = !remembers_ || tick <= first;
    unanswered_.clear();
    early_.clear();
    newest_ = 0;
    if (!known_) {
      say(
          fmt::format("the record begins in mid-run {}, and what was remembered then is not in it: "
                      "record from before the rig is armed",
                      run_name(epoch)));
    }
  }
  void heard() { ++account_.heard; }
  /// Forecasts of a mirror that was behind come later than a rerun's.
  void heard(const status_t& mirror) { behind_ |= mirror.overruns > 0; }

  template <class Message>
  void made(Channel channel, Message& message, std::int64_t epoch, std::int64_t us) {
    message.header.rig_id = rig_.id;
    message.header.source = source_;
    message.header.sender_mono_ns = 0;
    ++account_.made;
    if (take_) take_(channel, encoded(message), us);
    if (is_repeat(message) || !known(epoch)) return;
    const std::int64_t sequence = message.header.sequence;
    if (channel == answers_ && sequence > newest_) {
      newest_ = sequence;
      if (early_.erase(sequence) == 0) unanswered_.insert(sequence);
      early_.erase(early_.begin(), early_.lower_bound(sequence));
    }
    comparison(channel).made(channel, epoch, sequence, comparable(message));
  }
  template <class Message>
  void recorded(Channel channel, const Message& message, std::int64_t epoch) {
    if (is_repeat(message)) return;
    const std::int64_t sequence = message.header.sequence;
    ++account_.recorded;
    if (channel == answers_) check_gap(epoch, sequence);
    if (!known(epoch)) {
      ++account_.unknown;
      return;
    }
    comparison(channel).recorded(channel, epoch, sequence, comparable(message));
  }

  Account account() const {
    Account account = account_;
    const auto add = [&account](const Comparison& part) {
      account.compared += part.compared();
      account.different += part.different();
      if (account.first_difference.empty()) account.first_difference = part.first_difference();
    };
    add(comparison_);
    if (!behind_) {
      add(forecasts_);
    } else if (forecasts_.compared() > 0) {
      account.unknown += forecasts_.compared();
      if (account.why_unknown.empty()) {
        account.why_unknown =
            "the mirror was behind and left out forecasting, so its forecasts came later";
      }
    }
    return account;
  }

 private:
  /// Told while the rig is HELD, as often as it pleased: nobody can say which belong together.
  template <class Message>
  static bool is_repeat(const Message& message) {
    return message.header.sequence == 0;
  }

  bool known(std::int64_t epoch) const { return epoch != run_ || known_; }
  void say(std::string why) {
    if (account_.why_unknown.empty()) account_.why_unknown = std::move(why);
  }
  Comparison& comparison(Channel channel) {
    return channel == Channel::kForecast ? forecasts_ : comparison_;
  }

  void check_gap(std::int64_t epoch, std::int64_t sequence) {
    if (epoch != run_ || !known_) return;
    const bool gap = !unanswered_.empty() && *unanswered_.begin() < sequence;
    if (gap && remembers_) {
      known_ = false;
      say(
          fmt::format("an answer to sequence {} of run {} is not in the record, so what was "
                      "remembered from then on is not known",
                      *unanswered_.begin(), run_name(epoch)));
    }
    unanswered_.erase(unanswered_.begin(), unanswered_.upper_bound(sequence));
    if (sequence > newest_) early_.insert(sequence);
  }

  const Rig& rig_;
  std::int32_t source_;
  Channel answers_;
  bool remembers_;
  const Take& take_;
  Account account_;
  Comparison comparison_, forecasts_;
  bool behind_ = false;

  std::optional<std::int64_t> run_;    // that the core is in
  bool known_ = true;                  // what the recorded core remembered in it
  std::set<std::int64_t> unanswered_;  // sequences, in the record so far
  std::set<std::int64_t> early_;       // answers that the record has before what they answer
  std::int64_t newest_ = 0;            // sequence that was answered here
};

}  // namespace gyrotwin
