// What machines are made of, without numbers: known at compile time, so that the compiler writes
// each kind's equations out. Derivation: README.md, section 2.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>

namespace gyrotwin::model {

inline constexpr int kMaxCoordinates = 6;
inline constexpr int kMaxBodies = 3;
inline constexpr int kMaxRotors = 4;

/// "No body": the ground as a parent.
inline constexpr int kGround = -1;

enum class Axis : std::uint8_t { kX = 0, kY = 1, kZ = 2 };

/// Along which axes of a frame something can lie, as a sum of these.
using Axes = unsigned;
inline constexpr Axes kAlongX = 1, kAlongY = 2, kAlongZ = 4, kAnywhere = 7;

/// A turn by `sense * q[coordinate]` about an axis of the frame reached so far.
struct Rotation {
  Axis axis = Axis::kZ;
  int coordinate = 0;
  int sense = 1;  ///< 1 or -1
};

/// A few items, in order.
template <class T, int kCapacity>
struct ShortList {
  std::array<T, static_cast<std::size_t>(kCapacity)> item{};
  int size = 0;

  constexpr ShortList() = default;
  constexpr ShortList(std::initializer_list<T> items) {
    for (const T& x : items) add(x);
  }
  constexpr void add(const T& x) { item[static_cast<std::size_t>(size++)] = x; }
  constexpr const T& operator[](int i) const { return item[static_cast<std::size_t>(i)]; }
  constexpr const T* begin() const { return item.data(); }
  constexpr const T* end() const { return item.data() + size; }
};

/// Indices of coordinates, none twice.
struct IndexList : ShortList<int, kMaxCoordinates> {
  using ShortList::ShortList;
  constexpr bool has(int i) const {
    for (int known : *this) {
      if (known == i) return true;
    }
    return false;
  }
  constexpr void add_new(int i) {
    if (!has(i)) add(i);
  }
};

/// Bodies joined by revolute joints whose angles are coordinates, and gimbals on them.
struct Shape {
  struct Joint {
    int position_parent = kGround;     ///< carries the pivot: the ground, or body 0
    int orientation_parent = kGround;  ///< the position parent, or the ground
    ShortList<Rotation, 4> rotations;  ///< from the orientation parent to the body
    Axes pivot = kAlongZ;              ///< in the position parent's axes
    Axes cm = kAlongZ;                 ///< of the body without its gyros, from its pivot
    bool has_rotor = false;            ///< of constant direction in the body
    IndexList linear;                  ///< coordinates that move the pivot
    IndexList angular;                 ///< coordinates that turn the body

    /// Of `angular` those that turn the orientation parent.
    constexpr IndexList inherited() const {
      IndexList list;
      for (int i = 0; i < angular.size - rotations.size; ++i) list.add(angular[i]);
      return list;
    }
  };
  /// How the gyros of one gimbal lie in their carrier's axes; by default anyhow.
  struct Gyros {
    Axes pivot = kAnywhere;
    Axes axis = kAnywhere;    ///< spin axis at angle 0
    Axes raised = kAnywhere;  ///< spin axis at angle 90 deg
    bool centred = false;     ///< cm on the hinge
    /// What they have off z cancels: at every angle the carrier's cm stays on z and its axes
    /// principal, and turning gyros have no angular momentum but their rotors'.
    bool balanced = false;
    int first_rotor = 0, rotors = kMaxRotors;  ///< which ones they carry
  };
  struct Hinge {
    int carrier = 0;
    int coordinate = 0;
    Gyros gyros;
  };

  int coordinates = 0;
  ShortList<Joint, kMaxBodies> bodies;
  ShortList<Hinge, kMaxRotors> gimbals;

  /// Adds a body. Coordinates are counted. What no evaluation knows does not compile
  /// (in a constant; else it throws).
  constexpr Shape& hang(int position_parent, int orientation_parent,
                        const ShortList<Rotation, 4>& rotations) {
    if (position_parent > 0 || position_parent >= bodies.size ||
        (orientation_parent != kGround && orientation_parent != position_parent)) {
      throw std::logic_error("a body is carried by the ground or body 0, and turned against that");
    }
    Joint joint;
    joint.position_parent = position_parent;
    joint.orientation_parent = orientation_parent;
    joint.rotations = rotations;
    if (position_parent != kGround) {
      for (int i : bodies[position_parent].linear) joint.linear.add_new(i);
      for (int i : bodies[position_parent].angular) joint.linear.add_new(i);
    }
    if (orientation_parent != kGround) joint.angular = bodies[orientation_parent].angular;
    for (const Rotation& r : rotations) {
      if (joint.angular.has(r.coordinate)) throw std::logic_error("a coordinate turns a body once");
      joint.angular.add(r.coordinate);
      coordinates = std::max(coordinates, r.coordinate + 1);
    }
    bodies.add(joint);
    return *this;
  }

  /// Of the body added last.
  constexpr Shape& pivot_along(Axes axes) {
    last().pivot = axes;
    return *this;
  }
  constexpr Shape& cm_along(Axes axes) {
    last().cm = axes;
    return *this;
  }
  constexpr Shape& with_rotor() {
    last().has_rotor = true;
    return *this;
  }

  /// Adds gyros that turn on a body by the next coordinate.
  constexpr Shape& gimbal(int carrier, const Gyros& gyros) {
    if (carrier < 0 || carrier >= bodies.size) throw std::logic_error("a body carries a gimbal");
    if (gyros.first_rotor < 0 || gyros.first_rotor + gyros.rotors > kMaxRotors) {
      throw std::logic_error("a gimbal's rotors are among the machine's");
    }
    gimbals.add({carrier, coordinates++, gyros});
    return *this;
  }

 private:
  constexpr Joint& last() { return bodies.item[static_cast<std::size_t>(bodies.size - 1)]; }
};

}  // namespace gyrotwin::model
