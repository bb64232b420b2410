// MuJoCo's steps beside a rig's ticks.
#include <cmath>

#include "services/runtime/error.hpp"
#include "tests/bench/plant/mujoco.hpp"
#include "tests/bench/plant/tick.hpp"

namespace gyrotwin::bench {

namespace {

constexpr double kMillisecond = 1e-3;  // [s]

class MujocoTicker : public Ticker {
 public:
  MujocoTicker(const Rig& rig, int steps_per_ms, Gears gears)
      : machine_(mechanism_of(rig), {.gears = gears, .timestep = kMillisecond / steps_per_ms}),
        steps_per_ms_(steps_per_ms),
        steps_(static_cast<int>(std::lround(rig.loop.tick_s() / kMillisecond)) * steps_per_ms) {}

  void start(const model::State& state) override {
    rotor_speed_ = state.rotor_speed;
    place(to_own(machine_.mechanism(), state));
  }
  void tick(const model::Input& input) override {
    machine_.act_by(rotor_speed_, input);
    for (int i = 0; i < steps_; ++i) step();
  }

 protected:
  virtual void place(const Own& own) = 0;
  virtual void step() = 0;
  std::string called(const std::string& name) const {
    return steps_per_ms_ == 1 ? name : name + " " + std::to_string(steps_per_ms_) + " steps";
  }

  MujocoMachine machine_;

 private:
  int steps_per_ms_, steps_;
  model::RotorSpeeds rotor_speed_{};
};

class Stepped : public MujocoTicker {
 public:
  Stepped(const Rig& rig, int steps_per_ms)
      : MujocoTicker(rig, steps_per_ms, Gears::kConstraints) {}
  std::string name() const override { return called("MuJoCo"); }
  model::Coordinates coordinates() const override {
    return machine_.coordinates(machine_.data().qpos);
  }

 private:
  void place(const Own& own) override {
    machine_.reset();
    machine_.place(own);
  }
  void step() override { machine_.step(); }
};

/// Runge and Kutta's method as MuJoCo has it, on the coordinates.
class Projected : public MujocoTicker {
 public:
  Projected(const Rig& rig, int steps_per_ms)
      : MujocoTicker(rig, steps_per_ms, Gears::kProjection), h_(kMillisecond / steps_per_ms) {}
  std::string name() const override { return called("MuJoCo projected"); }
  model::Coordinates coordinates() const override { return own_.c; }

 private:
  void place(const Own& own) override { own_ = own; }

  Own slope(const Own& at) {
    machine_.place(at);
    return {at.rate, machine_.projected()};
  }
  Own along(const Own& slope, double h) const {
    return {own_.c + h * slope.c, own_.rate + h * slope.rate};
  }
  void step() override {
    const Own k1 = slope(own_), k2 = slope(along(k1, 0.5 * h_));
    const Own k3 = slope(along(k2, 0.5 * h_)), k4 = slope(along(k3, h_));
    own_.c += h_ / 6.0 * (k1.c + 2.0 * k2.c + 2.0 * k3.c + k4.c);
    own_.rate += h_ / 6.0 * (k1.rate + 2.0 * k2.rate + 2.0 * k3.rate + k4.rate);
  }

  double h_;  ///< [s]
  Own own_;
};

}  // namespace

std::unique_ptr<Ticker> mujoco_ticker(const Rig& rig, int steps_per_ms) {
  return std::make_unique<Stepped>(rig, steps_per_ms);
}

std::unique_ptr<Ticker> mujoco_projected_ticker(const Rig& rig, int steps_per_ms) {
  return std::make_unique<Projected>(rig, steps_per_ms);
}

}  // namespace gyrotwin::bench
