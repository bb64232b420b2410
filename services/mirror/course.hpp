// One future of a rig: the model run on from a state, in coarse steps. Pure.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "services/controller/law.hpp"
#include "services/model/machine.hpp"
#include "services/onboard/safe_stop.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// Where a future begins, and what is assumed to go on.
struct Outset {
  model::State state;
  LawState memory = LawState::Zero();
  bool lawful = true;         ///< the law acts; else the drives are in their safe stop
  model::State stopped_from;  ///< not lawful: where the safe stop began
  /// Moments on the structure about x and y [N m]: one that lasts, and one that fades.
  Eigen::Vector2d lasting_moment = Eigen::Vector2d::Zero();
  Eigen::Vector2d fading_moment = Eigen::Vector2d::Zero();
  double fade_s = 0.05;        ///< time constant with which it fades [s]
  double disc_friction = 0.0;  ///< beyond the model's [N m]
  std::array<double, model::kMaxDrives> drive_strength{1, 1, 1, 1};
};

/// What has come of it so far; times since its beginning [s], negative: not yet.
struct Outcome {
  double fell_at = -1.0;       ///< the tilt passed safety.fall_tilt_rad
  double saturated_at = -1.0;  ///< a drive reached its limit, by the law
  double peak_tilt = 0.0;      ///< [rad]
  double peak_at = 0.0;
  double tilt = 0.0;           ///< at its end so far [rad]
  double gimbal_margin = 0.0;  ///< smallest, < 0: in a stop [rad]
  bool falls() const noexcept { return fell_at >= 0.0; }
};

/// Runge-Kutta's classical method; the law feels every stage, rotors keep their speed.
class Course {
 public:
  /// @param rig outlives the course
  /// @throws Error as make_law()
  Course(const Rig& rig, double horizon_s, double step_s);

  void begin(const Outset& outset) noexcept;
  /// One step. @return whether there is more: not yet fallen, not yet at the horizon
  bool advance() noexcept;

  bool over() const noexcept { return over_; }
  const Outcome& outcome() const noexcept { return outcome_; }
  const model::State& state() const noexcept { return at_.state; }

 private:
  model::Input input(const model::State& state, double t) const noexcept;
  void look() noexcept;
  void step_memory() noexcept;
  void calm_down(const model::Motion& motion, const model::State& state, const model::Input& input,
                 model::Coordinates& acceleration) const noexcept;

  const Rig& rig_;
  model::Machine machine_;
  std::unique_ptr<Law> law_;
  double horizon_, step_;
  double friction_;                                  // the model's own [N m]
  std::array<double, model::kMaxDrives> lightness_;  // of what the drives turn
  Outset at_;                                        // state and memory are those of now
  SafeStop safe_stop_;
  double time_ = 0.0;
  bool over_ = true;
  Outcome outcome_;
};

/// Longest step [s] of a few whose tilt stays within 5 mrad of a fine step's through the rig's
/// reference push, with its law.
double coarsest_step(const Rig& rig);

}  // namespace gyrotwin
