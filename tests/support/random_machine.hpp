// Random but physical parameters and states, from a seed.
#pragma once

#include <random>

#include "services/model/gimballed.hpp"
#include "services/model/gyroscope.hpp"
#include "services/model/umbrella.hpp"

namespace gyrotwin::reference {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }

  Eigen::Vector3d vector(double size) {
    return {between(-size, size), between(-size, size), between(-size, size)};
  }

  /// Every term of the equations is there: all offsets, inertias, frictions and dampings differ
  /// from 0. The structure is far from light and the ring touches some axles at small tilts.
  model::UmbrellaParameters umbrella() {
    model::UmbrellaParameters p;
    p.structure.mass = between(1, 5);
    p.structure.cm_height = between(0.1, 0.4);
    const double steiner = p.structure.mass * p.structure.cm_height * p.structure.cm_height;
    p.structure.inertia_x = steiner + between(0.02, 0.3);
    p.structure.inertia_y = steiner + between(0.02, 0.3);
    p.structure.inertia_z = between(0.02, 0.2);
    p.structure.damping = between(0.01, 0.1);
    p.disc = {between(0.1, 0.4),  between(1, 3),      between(-0.1, 0.1), between(0.01, 0.1),
              between(0.01, 0.1), between(0.01, 0.1), between(0.05, 0.2)};
    p.gyros.count = between(0, 1) < 0.5 ? 3 : 4;
    p.gyros.mass = between(0.5, 2);
    p.gyros.inertia_transverse = between(0.001, 0.01);
    p.gyros.inertia_axial = between(0.001, 0.01);
    p.gyros.rotor_inertia = between(0.001, 0.005);
    p.gyros.rotor_speed = between(-1500, 1500);
    p.gyros.pivot_radius = between(0.02, 0.15);
    p.gyros.pivot_height = between(-0.1, 0.1);
    p.gyros.axle_length = between(0.05, 0.2);
    p.gyros.cm_distance = between(-0.05, 0.05);
    p.gyros.ring_elevation = between(-0.3, 0.3);
    p.gyros.stop_lower = -0.8;
    p.gyros.stop_upper = 0.8;
    p.gyros.stop_stiffness = 2e3;
    p.gyros.damping = between(0.01, 0.1);
    p.contact = {between(1e5, 1e7), between(0.1, 2), between(0.01, 0.1), between(1e-3, 5e-3)};
    p.bushing = {between(10, 100), between(1, 10), between(1, 10)};
    p.drive = {between(1e-6, 1e-4), {0.05, between(5, 20), 0.35, 24}, 1e9};
    return p;
  }

  model::GimballedParameters gimballed(model::Arrangement arrangement) {
    model::GimballedParameters p;
    p.arrangement = arrangement;
    const double m = between(20, 50), zc = between(0.2, 1);
    p.structure = {m, zc, m * zc * zc + between(1, 10), between(0.3, 1), between(0.1, 1)};
    p.gyros = {between(1, 3),
               between(0.05, 0.2),
               between(0.05, 0.2),
               between(0.01, 0.05),
               between(-600, 600),
               1.0,
               1e3,
               between(0.1, 1)};
    p.torque_limit = 1e9;
    return p;
  }

  model::GyroscopeParameters gyroscope() {
    return {{between(0.5, 5), between(0.002, 0.05), between(0.002, 0.05), between(0.001, 0.01),
             between(-1500, 1500), between(0.05, 0.3), between(0.1, 0.4), 0.8, 2e3,
             between(0.01, 0.1), between(0.01, 0.1), between(0.001, 0.05)},
            1e9};
  }

  /// Motors far from their limits at nominal speed, and drag of every kind.
  model::RotorDrive rotor_drive() {
    return {1e6, 1e3, between(0.1, 1), between(1e-6, 1e-4), between(1e-3, 1e-2)};
  }

  model::LoadCell load_cell() {
    return {vector(0.5), vector(1.0).normalized(), between(1e3, 1e5), between(1, 100)};
  }

  /// One of every family and mount, with everything that can act on it.
  std::vector<model::Machine> machines() {
    std::vector<model::Machine> machines;
    for (const model::Mount mount :
         {model::Mount::kLevel, model::Mount::kRigid, model::Mount::kUniversalJoint}) {
      auto p = umbrella();
      p.mount = mount;
      p.track = model::TrackKind::kSlot;
      machines.push_back(model::build(p));
    }
    for (const auto arrangement :
         {model::Arrangement::kSingle, model::Arrangement::kPair, model::Arrangement::kTwoPairs}) {
      machines.push_back(model::build(gimballed(arrangement)));
    }
    machines.push_back(model::build(gyroscope()));
    for (model::Machine& machine : machines) {
      machine.rotor_drive = rotor_drive();
      machine.load_cell = load_cell();
    }
    return machines;
  }

  /// Everything an input can hold, some motors off and all rotors braked.
  model::Input input() {
    model::Input input;
    input.mode = model::DriveMode::kIdealTorque;
    for (double& drive : input.drive) drive = between(-5, 5);
    input.force = vector(5.0);
    input.moment = vector(5.0);
    input.ground_acceleration = vector(3.0);
    input.yaw_rate = between(-1, 1);
    for (int i = 0; i < model::kMaxAddedMasses; ++i) {
      input.added.add({between(0.1, 1), vector(0.3)});
    }
    for (double& strength : input.drive_strength) strength = between(0, 1);
    for (bool& powered : input.rotor_powered) powered = between(0, 1) < 0.5;
    for (double& brake : input.rotor_brake) brake = between(0, 1);
    return input;
  }

  /// Angles within +-angle, rates within +-rate; rotors at their nominal speeds.
  model::State state(const model::Machine& machine, double angle, double rate) {
    std::vector<double> q, v;
    for (int i = 0; i < machine.coordinates(); ++i) {
      q.push_back(between(-angle, angle));
      v.push_back(between(-rate, rate));
    }
    return machine.state(q, v);
  }

 private:
  std::mt19937 engine_;
};

/// Friction, damping, contact damping and rolling drag removed; the springs stay.
inline model::UmbrellaParameters frictionless(model::UmbrellaParameters p) {
  p.structure.damping = p.gyros.damping = 0.0;
  p.disc.viscous_friction = p.disc.coulomb_friction = 0.0;
  p.contact.damping = p.contact.rolling_drag = 0.0;
  p.bushing.rotating_damping = p.bushing.standing_damping = 0.0;
  return p;
}

inline model::GimballedParameters frictionless(model::GimballedParameters p) {
  p.structure.damping = p.gyros.damping = 0.0;
  return p;
}

}  // namespace gyrotwin::reference
