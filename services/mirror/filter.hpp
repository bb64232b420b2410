// The filter behind the follower: the unknowns' estimate and its deviations, a tick at a time.
// README.md, "The filter".
#pragma once

#include <array>
#include <cstdint>

#include "services/mirror/deviations.hpp"
#include "services/mirror/prediction.hpp"
#include "services/mirror/readings.hpp"
#include "services/mirror/unknowns.hpp"

namespace gyrotwin {

/// A sigma-point filter in square-root form (Norgaard, Poulsen and Ravn's divided differences,
/// 2000, which needs no negative weights where the unscented filter does).
class Filter {
 public:
  using Point = Prediction::Point;

  /// @pre rig.sensors
  Filter(const Rig& rig, const model::Machine& machine);

  const Unknowns& unknowns() const noexcept { return unknowns_; }
  const Readings& readings() const noexcept { return readings_; }
  const Point& mean() const noexcept { return x_; }
  double sigma(int entry) const noexcept { return D_.sigma(entry); }
  const Deviations& deviations() const noexcept { return D_; }

  /// Unknowns at their priors, and of q and v what is told.
  void start(const model::State& state, const Point& sigma) noexcept;
  /// A tick on, and what the sensors should say then.
  void predict(const Prediction::Tick& tick) noexcept;
  /// What a point becomes without the filter's help.
  void advance(const Prediction::Tick& tick, Point& x) noexcept { prediction_.advance(tick, x); }

  /// Expected of channel i after predict(), bias included, and its deviations.
  double expected(int i) const noexcept { return z_[i]; }
  double expected_sigma(int i) const noexcept { return Z_.sigma(i); }
  /// More uncertainty after predict(): as if entry `i` had jumped at the begin of the tick.
  void open(const Prediction::Tick& tick, int i, double sigma) noexcept;
  /// Until the next predict(): a channel's readings are worth as much as one in so many.
  void weigh(int i, double one_in) noexcept { variance_[i] *= one_in; }
  double variance(int i) const noexcept { return variance_[i]; }
  /// Takes a channel's reading for what it is worth. To be called once a channel after predict().
  /// @return its innovation squared over its variance, given the channels before it
  double absorb(int i, double reading) noexcept;
  /// The same of all channels that `use` names, without absorbing them.
  double misfit(const Channels& readings, unsigned use) const noexcept;
  /// To what predict() left: undoes open().
  void close() noexcept;

 private:
  void add_noise() noexcept;
  void freeze(const Prediction::Tick& tick, const Point& centre) noexcept;

  std::array<int, 2> tilt_;
  std::array<int, model::kMaxDrives> blind_drive_{-1, -1, -1,
                                                  -1};  // coordinate of one without a motor
  Unknowns unknowns_;
  Readings readings_;
  Prediction prediction_;
  Point x_, start_;  // now; at the begin of the tick
  Deviations D_;
  Deviations Z_;  // of the expected readings, row by row as D_
  Deviations moved_D_, moved_Z_;
  Channels z_{}, variance_{};
  int rows_ = 0;         // of D_ after predict()
  unsigned frozen_ = 0;  // entries of which this tick tells nothing
  std::int64_t ticks_ = 0;
};

}  // namespace gyrotwin
