// How late a line is, and how far the device's clock is from ours: by beats that both sides stamp.
#pragma once

#include <array>
#include <cstdint>

#include "messages/channels.hpp"
#include "services/runtime/histogram.hpp"

namespace gyrotwin {

/// Four stamps an exchange, as in NTP (RFC 5905, section 8): t1 sent and t4 heard by the host's
/// clock, t2 heard and t3 sent by the device's. Round trip (t4 - t1) - (t3 - t2), offset
/// ((t2 - t1) + (t3 - t4))/2. Offset and drift are a line through the last exchanges, where short
/// round trips count most. Does not allocate.
class LineClock {
 public:
  /// A beat of the device, heard at `now_ns` of the host's clock; one that echoes nothing is passed
  /// over.
  void on_beat(const beat_t& beat, std::int64_t now_ns) noexcept;
  /// Another device, another clock.
  void forget() noexcept;
  /// The line through the last exchanges, anew; ten times a second is enough.
  void fit(std::int64_t now_ns) noexcept;

  bool known() const noexcept { return known_; }
  /// Device's clock minus the host's, when last fitted [ns].
  std::int64_t offset_ns() const noexcept { return offset_; }
  /// Its standard deviation: scatter, and that the two ways may differ by up to the shortest round
  /// trip [ns].
  std::int64_t sigma_ns() const noexcept { return sigma_; }
  /// > 0: the device's clock runs fast [1e-6].
  double drift_ppm() const noexcept { return drift_ * 1e6; }
  /// Of the device's clock [ns] on the host's.
  std::int64_t to_host(std::int64_t device_ns) const noexcept;

  WindowedHistogram& round_trips() noexcept { return round_trips_; }

 private:
  struct Exchange {
    std::int64_t at, offset, round_trip;  // by the host's clock [ns]
  };
  static constexpr std::size_t kExchanges = 256;

  std::array<Exchange, kExchanges> last_{};
  std::size_t count_ = 0;
  std::int64_t echoed_ = 0;  // newest stamp of ours that came back
  bool known_ = false;
  std::int64_t fitted_at_ = 0, offset_ = 0, sigma_ = 0;
  double drift_ = 0.0;  // [1]
  WindowedHistogram round_trips_;
};

}  // namespace gyrotwin
