#include "services/mirror/rotor_watch.hpp"

#include <cmath>

namespace gyrotwin {

namespace {

// The expected speed follows the measured one so slowly [rad/s]; their difference is smoothed [s].
constexpr double kFollow = 0.2, kSmooth = 0.5;

// A rotor is blamed from so many sigmas of noise and this share of its nominal speed on.
constexpr double kSigmas = 8.0, kShare = 1e-3;

}  // namespace

RotorWatch::RotorWatch(const Rig& rig, const model::Machine& machine)
    : machine_(machine),
      tick_s_(rig.loop.tick_s()),
      noise_(rig.sensors->rotor.noise * std::sqrt(tick_s_ / (2.0 * kSmooth))) {}

void RotorWatch::take(const model::RotorSpeeds& speed, bool trusted,
                      const model::Input& acting) noexcept {
  const model::RotorSpeeds rate = machine_.rotor_acceleration(expected_, acting);
  for (int j = 0; j < machine_.rotors; ++j) {
    if (!trusted || !known_[j]) {
      expected_.rotor_speed[j] = speed[j];
      missing_[j] = 0.0;
      known_[j] = trusted;
      continue;
    }
    const double difference = speed[j] - expected_.rotor_speed[j];
    expected_.rotor_speed[j] += tick_s_ * (rate[j] + kFollow * difference);
    missing_[j] += tick_s_ / kSmooth * (difference - missing_[j]);
  }
}

int RotorWatch::blamed() const noexcept {
  int worst = -1;
  double most = 0.0;
  for (int j = 0; j < machine_.rotors; ++j) {
    const double off = std::abs(missing_[j]);
    const double limit = kSigmas * noise_ + kShare * std::abs(machine_.nominal_rotor_speed[j]);
    if (off <= limit || off <= most) continue;
    most = off;
    worst = j;
  }
  return worst;
}

}  // namespace gyrotwin
