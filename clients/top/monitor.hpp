// Follows a rig by listening alone: through resets, restarts of daemons and silence.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "clients/top/picture.hpp"

namespace gyrotwin {

/// A moment, for counting and for people.
struct Moment {
  std::int64_t mono_ns = 0;  ///< of a Clock
  std::int64_t utc_ns = 0;   ///< since 1970
};

class Monitor {
 public:
  static constexpr std::size_t kHappenings = 200;  ///< that are remembered

  /// Takes one message in.
  void hear(const Reception& reception, const Moment& now);
  /// Lets time pass: notices who fell silent and measures rates. To be called some times a second.
  /// @param bus of the bus that the receptions came from
  void look(const Moment& now, const BusCounters& bus);
  Picture picture(const Moment& now) const;

 private:
  template <class Message>
  struct Kept {
    Message message{};
    std::int64_t at_ns = 0;
    Heard<Message> at(const Moment& now) const { return {message, now.mono_ns - at_ns}; }
  };
  /// A daemon that is followed on its STATUS channel.
  struct Followed {
    const char* name;
    std::optional<Kept<status_t>> status{};
    bool alive = false;
    std::optional<std::int64_t> rival_at_ns{};  ///< when another one spoke on the same channel
  };
  /// What rates are measured against.
  struct Sample {
    std::int64_t at_ns;
    std::array<std::int64_t, kChannels.size()> received;
    std::int64_t epoch, sim_time_ns;
  };
  using RequestId = std::pair<std::int64_t, std::int64_t>;  // writer, counter

  void on_status(Followed& peer, const status_t& status, const Moment& now);
  bool is_rival(Followed& peer, const status_t& status, const Moment& now);
  void on_health(const health_t& health, const Moment& now);
  void on_forecast(const forecast_t& forecast, const Moment& now);
  void on_link(const link_t& link, const Moment& now);
  void on_reply(const reply_t& reply, const Moment& now);
  void schedule(const reply_t& reply, const request_t* request);
  const request_t* request_of(const reply_t& reply) const;
  bool of_this_run(const header_t& header) const;
  std::optional<header_t> latest() const;
  void forget_what_is_over();
  void measure(const Moment& now);
  void happen(const Moment& now, Level level, std::string who, std::string what);

  Followed owner_{.name = "owner"}, controller_{.name = "controller"}, mirror_{.name = "mirror"};
  std::optional<Kept<state_t>> state_;
  std::optional<Kept<truth_t>> truth_;
  std::optional<Kept<health_t>> health_;
  std::optional<Kept<forecast_t>> forecast_;
  std::optional<Kept<link_t>> link_;
  std::optional<command_t> command_;
  std::array<std::optional<std::int64_t>, kChannels.size()> heard_at_{};
  BusCounters bus_;
  std::deque<Sample> samples_;

  std::deque<request_t> requests_;  // the last ones
  std::deque<RequestId> answered_;  // likewise: an answer that comes again is no news
  std::vector<Acting> acting_;
  std::deque<Happening> happenings_;
  std::int64_t happened_ = 0;
};

}  // namespace gyrotwin
