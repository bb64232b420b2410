#include "services/hardware/line_clock.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

namespace {

constexpr std::int64_t kLast = std::int64_t{1} << 60;  // stamps are below it [ns]
constexpr std::size_t kFewest = 8;      // exchanges, before a line is fitted through them
constexpr double kJitterFloor = 10e3;   // round trips this close to the shortest are alike [ns]
constexpr std::size_t kDriftFrom = 64;  // exchanges, before their slope means something

}  // namespace

void LineClock::forget() noexcept {
  count_ = 0;
  echoed_ = 0;
  known_ = false;
  drift_ = 0.0;
}

void LineClock::on_beat(const beat_t& beat, std::int64_t now_ns) noexcept {
  // Stamps come from outside: what cannot be is passed over.
  if (beat.echo_ns <= echoed_ || beat.echo_ns > now_ns) return;
  if (beat.heard_ns < 0 || beat.sent_ns < beat.heard_ns || beat.sent_ns >= kLast) return;
  echoed_ = beat.echo_ns;
  const std::int64_t there_and_back = now_ns - beat.echo_ns;
  const std::int64_t at_device = beat.sent_ns - beat.heard_ns;
  if (at_device > there_and_back) return;
  const std::int64_t round_trip = there_and_back - at_device;
  const std::int64_t middle_host = beat.echo_ns + there_and_back / 2;
  const std::int64_t middle_device = beat.heard_ns + at_device / 2;
  last_[count_++ % kExchanges] = {middle_host, middle_device - middle_host, round_trip};
  round_trips_.add(round_trip);
}

void LineClock::fit(std::int64_t now_ns) noexcept {
  const std::size_t n = std::min(count_, kExchanges);
  if (n < kFewest) return;
  const auto shortest =
      std::min_element(last_.begin(), last_.begin() + static_cast<std::ptrdiff_t>(n),
                       [](const auto& a, const auto& b) { return a.round_trip < b.round_trip; });
  // Differences to one exchange keep nanoseconds of days within a double.
  const auto x = [&](const Exchange& e) { return static_cast<double>(e.at - now_ns); };
  const auto y = [&](const Exchange& e) {
    return static_cast<double>(e.offset - shortest->offset);
  };
  double W = 0, X = 0, Y = 0, XX = 0, XY = 0, WW = 0;
  const auto weight = [&](const Exchange& e) {
    const double late = static_cast<double>(e.round_trip - shortest->round_trip);
    return 1.0 / std::pow(kJitterFloor + late, 2);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const double w = weight(last_[i]);
    W += w;
    WW += w * w;
    X += w * x(last_[i]);
    Y += w * y(last_[i]);
    XX += w * x(last_[i]) * x(last_[i]);
    XY += w * x(last_[i]) * y(last_[i]);
  }
  const double spread = XX - X * X / W;
  drift_ = n >= kDriftFrom && spread > 0.0 ? (XY - X * Y / W) / spread : 0.0;
  const double at_now = (Y - drift_ * X) / W;
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    squares += weight(last_[i]) * std::pow(y(last_[i]) - at_now - drift_ * x(last_[i]), 2);
  }
  const double scatter = squares / W * WW / (W * W);  // of the weighted mean
  const double asymmetry = static_cast<double>(shortest->round_trip) / 2.0;
  offset_ = shortest->offset + std::llround(at_now);
  sigma_ = std::llround(std::sqrt(scatter + asymmetry * asymmetry / 3.0));
  fitted_at_ = now_ns;
  known_ = true;
}

std::int64_t LineClock::to_host(std::int64_t device_ns) const noexcept {
  const std::int64_t about = device_ns - offset_;
  return about - std::llround(drift_ * static_cast<double>(about - fitted_at_));
}

}  // namespace gyrotwin
