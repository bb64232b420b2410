#include "services/mirror/filter.hpp"

#include <cmath>

namespace gyrotwin {

namespace {

// Interval of the divided differences in sigmas: that of the normal distribution's fourth moment.
const double kReach = std::sqrt(3.0);

// A curvature that moves no quantity by this share of its sigma is left out.
constexpr double kFlat = 1e-2;

// Inertia is learned while the structure accelerates faster than it would topple at this tilt
// [rad]; a drive whose current nobody measures while it changes a rate by so many sigmas a tick.
constexpr double kSwing = 0.05, kTelling = 3.0;

// What changes slowly is let walk every so many ticks.
constexpr int kSlow = 16;

}  // namespace

Filter::Filter(const Rig& rig, const model::Machine& machine)
    : tilt_(machine.layout.tilt),
      unknowns_(rig, machine),
      readings_(rig, machine, unknowns_),
      prediction_(rig, machine, unknowns_),
      x_(Point::Zero(unknowns_.size)),
      start_(x_),
      D_(unknowns_.size),
      Z_(readings_.count),
      moved_D_(unknowns_.size),
      moved_Z_(readings_.count) {
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    if (!machine.drives[i].motor) blind_drive_[i] = machine.drives[i].coordinate;
  }
}

void Filter::start(const model::State& state, const Point& sigma) noexcept {
  const int n = unknowns_.coordinates;
  x_.setZero();
  x_.head(n) = state.q.head(n);
  x_.segment(n, n) = state.v.head(n);
  D_.clear(unknowns_.size);
  for (int i = 0; i < unknowns_.size; ++i) {
    D_.column(i)[i] = i < 2 * n ? sigma[i] : unknowns_.prior[i];
  }
  ticks_ = 0;
}

/// What happens unseen in a tick: rows for what walks, a little forgetting for what returns.
void Filter::add_noise() noexcept {
  const double tick = prediction_.tick_s();
  const bool slow = ticks_++ % kSlow == 0;
  for (int i = 0; i < unknowns_.size; ++i) {
    if (slow && unknowns_.forget[i] > 0.0) {
      const double keep = 1.0 - unknowns_.forget[i] * kSlow * tick;
      x_[i] *= keep;
      D_.column(i) *= keep;
    }
    if (unknowns_.walk[i] == 0.0 || (unknowns_.slow[i] && !slow)) continue;
    const double time = unknowns_.slow[i] ? kSlow * tick : tick;
    const int row = D_.extend();
    D_.column(i)[row] = unknowns_.walk[i] * std::sqrt(time);
  }
}

/// Nothing is learned of inertia and drives in a tick in which they do hardly anything: all there
/// is to see then is that what the filter reckons with, walks and noise, does not come.
void Filter::freeze(const Prediction::Tick& tick, const Point& centre) noexcept {
  const int n = unknowns_.coordinates;
  frozen_ = 0;
  const auto tells = [&](int k, int rate, double sigmas) {
    const double effect = std::abs(moved_D_.row(k)[rate] / D_.row(k)[k]);  // d v / d x_k of a tick
    return effect > sigmas * D_.sigma(rate);
  };
  if (unknowns_.inertia >= 0) {
    bool swings = false;
    for (const int tilt : tilt_) {
      if (tilt == model::kFixed) continue;
      const double acceleration = (centre[n + tilt] - start_[n + tilt]) / prediction_.tick_s();
      swings |= std::abs(acceleration) > kSwing * unknowns_.toppling_rate &&
                tells(unknowns_.inertia, n + tilt, 1.0);
    }
    if (!swings) frozen_ |= 1u << unknowns_.inertia;
  }
  for (std::size_t i = 0; i < blind_drive_.size(); ++i) {
    const int k = unknowns_.strength[i], rate = n + blind_drive_[i];
    if (k < 0 || blind_drive_[i] < 0) continue;
    if (tick.acting.mode == model::DriveMode::kBrake || !tells(k, rate, kTelling))
      frozen_ |= 1u << k;
  }
}

void Filter::predict(const Prediction::Tick& tick) noexcept {
  add_noise();
  D_.compress();
  start_ = x_;
  std::array<double, Deviations::kMaxColumns> sigma{};
  for (int i = 0; i < 2 * unknowns_.coordinates; ++i) sigma[i] = D_.sigma(i);
  const int n = unknowns_.size, dynamic = unknowns_.dynamic, moving = 2 * unknowns_.coordinates;
  const int channels = readings_.count;

  Point centre = x_;
  prediction_.advance(tick, centre);
  Channels sensed{}, plus_sensed{}, minus_sensed{};
  prediction_.sense(tick, centre, sensed);
  z_ = sensed;
  x_ = centre;

  // D is triangular: its rows from `dynamic` on move biases alone, those from `moving` on nothing
  // that moves by itself.
  const double h = kReach, second = std::sqrt(h * h - 1.0) / (2.0 * h * h);
  moved_D_.clear(2 * n);
  moved_Z_.clear(2 * n);
  int curved = n;
  for (int k = 0; k < n; ++k) {
    auto D = moved_D_.row(k);
    auto Z = moved_Z_.row(k);
    D.tail(n - k) = D_.row(k).tail(n - k);
    if (k >= dynamic) continue;
    Point plus = start_;
    plus.head(dynamic) += h * D_.row(k).head(dynamic).transpose();
    prediction_.advance(tick, plus);
    prediction_.sense(tick, plus, plus_sensed);
    if (k >= moving) {  // straight over a tick: one side tells
      D.head(moving) = (plus - centre).head(moving).transpose() / h;
      for (int c = 0; c < channels; ++c) Z[c] = (plus_sensed[c] - sensed[c]) / h;
      continue;
    }
    Point minus = start_;
    minus.head(dynamic) -= h * D_.row(k).head(dynamic).transpose();
    prediction_.advance(tick, minus);
    prediction_.sense(tick, minus, minus_sensed);

    D.head(moving) = (plus - minus).head(moving).transpose() / (2.0 * h);
    auto bent_D = moved_D_.row(curved);
    auto bent_Z = moved_Z_.row(curved);
    bool flat = true;
    for (int i = 0; i < moving; ++i) {
      const double bend = plus[i] + minus[i] - 2.0 * centre[i];
      x_[i] += bend / (2.0 * h * h);
      bent_D[i] = second * bend;
      flat &= std::abs(bent_D[i]) <= kFlat * sigma[i];
    }
    for (int c = 0; c < channels; ++c) {
      Z[c] = (plus_sensed[c] - minus_sensed[c]) / (2.0 * h);
      const double bend = plus_sensed[c] + minus_sensed[c] - 2.0 * sensed[c];
      z_[c] += bend / (2.0 * h * h);
      bent_Z[c] = second * bend;
      flat &= bent_Z[c] * bent_Z[c] <= kFlat * kFlat * readings_.channel[c].variance;
    }
    if (flat) {
      bent_D.setZero();
      bent_Z.setZero();
    } else {
      ++curved;
    }
  }
  freeze(tick, centre);
  D_.take(moved_D_, curved);
  Z_.take(moved_Z_, curved);
  for (int c = 0; c < channels; ++c) {
    variance_[c] = readings_.channel[c].variance;
    const int bias = readings_.channel[c].bias;
    if (bias < 0) continue;
    z_[c] += x_[bias];
    Z_.column(c) += D_.column(bias);
  }
  rows_ = D_.rows();
}

void Filter::close() noexcept {
  D_.cut(rows_);
  Z_.cut(rows_);
}

void Filter::open(const Prediction::Tick& tick, int i, double sigma) noexcept {
  const int row = D_.extend();
  Z_.extend();
  D_.column(i)[row] = sigma;
  if (i < unknowns_.dynamic) {
    // What a small jump does, as many times as it is larger.
    constexpr double kSmall = 1e-4;
    Point centre = start_, moved = start_;
    moved[i] += kSmall * sigma;
    prediction_.advance(tick, centre);
    prediction_.advance(tick, moved);
    Channels sensed{}, moved_sensed{};
    prediction_.sense(tick, centre, sensed);
    prediction_.sense(tick, moved, moved_sensed);
    for (int k = 0; k < 2 * unknowns_.coordinates; ++k) {
      D_.column(k)[row] = (moved[k] - centre[k]) / kSmall;
    }
    for (int c = 0; c < readings_.count; ++c) {
      Z_.column(c)[row] = (moved_sensed[c] - sensed[c]) / kSmall;
    }
  }
  for (int c = 0; c < readings_.count; ++c) {
    if (readings_.channel[c].bias == i) Z_.column(c)[row] += sigma;
  }
}

double Filter::absorb(int i, double reading) noexcept {
  // Potter: D <- D - beta a a' D with a the channel's deviations takes out what it tells.
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Deviations::kMaxRows, 1> a = Z_.column(i);
  const double variance = variance_[i];
  const double gain = 1.0 / (a.squaredNorm() + variance);
  const double beta = gain / (1.0 + std::sqrt(gain * variance));
  const double innovation = reading - z_[i];
  for (int k = 0; k < unknowns_.size; ++k) {
    if (frozen_ & (1u << k)) continue;
    const double cross = a.dot(D_.column(k));
    x_[k] += cross * gain * innovation;
    D_.column(k) -= (beta * cross) * a;
  }
  for (int c = 0; c < readings_.count; ++c) {
    const double cross = a.dot(Z_.column(c));
    z_[c] += cross * gain * innovation;
    Z_.column(c) -= (beta * cross) * a;
  }
  return gain * innovation * innovation;
}

double Filter::misfit(const Channels& readings, unsigned use) const noexcept {
  // L L' the covariance of the channels in use, row by row (Cholesky); the innovations alongside.
  Eigen::Matrix<double, kMaxChannels, kMaxChannels> L;
  Channels y{};
  double sum = 0.0;
  int rows = 0;
  std::array<int, kMaxChannels> used{};
  for (int c = 0; c < readings_.count; ++c) {
    if (!(use & (1u << c))) continue;
    double d = Z_.column(c).squaredNorm() + variance_[c];
    double e = readings[c] - z_[c];
    for (int j = 0; j < rows; ++j) {
      double s = Z_.column(c).dot(Z_.column(used[j]));
      for (int k = 0; k < j; ++k) s -= L(rows, k) * L(j, k);
      L(rows, j) = s / L(j, j);
      d -= L(rows, j) * L(rows, j);
      e -= L(rows, j) * y[j];
    }
    L(rows, rows) = std::sqrt(std::max(d, 1e-300));
    y[rows] = e / L(rows, rows);
    sum += y[rows] * y[rows];
    used[rows++] = c;
  }
  return sum;
}

}  // namespace gyrotwin
