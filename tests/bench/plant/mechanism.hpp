// A rig's machine in the words that any multibody engine has: links, hinges, and gears that tie
// hinges to coordinates. Read from the rig file's parameters, not from the model's tree.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "services/runtime/rig.hpp"

namespace gyrotwin::bench {

inline constexpr int kMaxLinks = 6;

/// Turns by `coefficient * c[coordinate]` about an axis of the frame reached so far.
struct Hinge {
  Eigen::Vector3d axis;
  int coordinate;
  double coefficient = 1.0;
};

/// A rigid body. Its hinges pass through its frame's origin, in the order they turn it.
struct Link {
  int parent;                   ///< -1: the ground; parents come first
  Eigen::Vector3d position;     ///< of the frame's origin in the parent's frame [m]
  Eigen::Matrix3d orientation;  ///< parent's frame <- this frame with the hinges at 0
  std::vector<Hinge> hinges;
  double mass;              ///< [kg]
  Eigen::Vector3d cm;       ///< in the frame [m]
  Eigen::Vector3d inertia;  ///< about cm; principal axes are the frame's [kg m^2]
  Eigen::Vector3d rotor = Eigen::Vector3d::Zero();  ///< axial inertia x spin axis [kg m^2]
  int rotor_index = -1;                             ///< -1: no flywheel in it
};

/// Links in depth-first order; the first is the structure, the second a disc if there is one.
struct Mechanism {
  std::vector<Link> links;
  int coordinates = 0;
  bool has_disc = false;
  /// The disc is on a universal joint: engines know its turn against the structure, c[2..4] about
  /// x, y, z in this order, where the model has (bx, by, phi) against the world.
  bool free_disc = false;
  model::Coordinates damping = model::Coordinates::Zero();  ///< on c [N m s/rad]
  std::vector<model::Stop> stops;                           ///< on c
  std::vector<int> drives;  ///< coordinates that they act on; a disc's drive is none of them
  model::DiscFriction friction;
  std::optional<model::Track> track;

  int hinges() const;
};

/// @throws Error for a rig that has what no engine here is given: a bushing, a load cell
Mechanism mechanism_of(const Rig& rig);

/// The mechanism's own coordinates and their rates.
struct Own {
  model::Coordinates c = model::Coordinates::Zero(), rate = model::Coordinates::Zero();
};
Own to_own(const Mechanism& mechanism, const model::State& state);
/// The model's q'' [rad/s^2], from c'' at that state.
model::Coordinates from_own(const Mechanism& mechanism, const model::State& state,
                            const model::Coordinates& acceleration);

/// Ties hinges to coordinates by projection: with hinge angles G c, c'' solves G'M G c'' = G'f.
class Reduction {
 public:
  explicit Reduction(const Mechanism& mechanism);

  int hinges() const { return static_cast<int>(coordinate_.size()); }
  int coordinate(int hinge) const { return coordinate_[static_cast<std::size_t>(hinge)]; }
  double coefficient(int hinge) const { return coefficient_[static_cast<std::size_t>(hinge)]; }

  /// Angles, rates or accelerations of the hinges.
  void spread(const model::Coordinates& c, double* hinge) const {
    for (int h = 0; h < hinges(); ++h) hinge[h] = coefficient(h) * c[coordinate(h)];
  }

  void clear() {
    M_.setZero();
    f_.setZero();
  }
  /// Entry (i, j) of the hinges' symmetric mass matrix; each pair once.
  void add_mass(int i, int j, double m) {
    const double share = coefficient(i) * coefficient(j) * m;
    M_(coordinate(i), coordinate(j)) += share;
    if (i != j) M_(coordinate(j), coordinate(i)) += share;
  }
  /// What hinge i has to exert for a unit of c''; each pair (i, c).
  void add_column(int i, int c, double m) { M_(coordinate(i), c) += coefficient(i) * m; }
  /// On a hinge.
  void add_force(int i, double f) { f_[coordinate(i)] += coefficient(i) * f; }
  /// On a coordinate.
  void add_coordinate_force(int c, double f) { f_[c] += f; }
  model::Coordinates solve() const;

 private:
  std::vector<int> coordinate_;
  std::vector<double> coefficient_;
  int coordinates_;
  model::MassMatrix M_;
  model::Coordinates f_;
};

}  // namespace gyrotwin::bench
