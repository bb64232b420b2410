// What of a body's moments is zero whatever its numbers are, from how a shape says that it lies.
// Derivation: README.md, section 2.
#pragma once

#include <array>
#include <cmath>

#include "services/model/shape.hpp"

namespace gyrotwin::model {

/// Which elements of Moments can differ from 0, bit by bit in their order.
struct MomentsPattern {
  Axes first = 0;
  unsigned second = 0;

  constexpr MomentsPattern operator|(const MomentsPattern& o) const {
    return {first | o.first, second | o.second};
  }
  constexpr MomentsPattern operator&(const MomentsPattern& o) const {
    return {first & o.first, second & o.second};
  }
};

inline constexpr unsigned kDiagonal = 0b000111;

/// What a gimbal adds to its carrier is a trigonometric polynomial of second degree in q. These are
/// its coefficients, of 1, cos q, sin q, cos 2q, sin 2q; or which of their elements can differ from
/// 0.
template <class AnyMoments, class AnyVector>
struct GimbalTerms {
  AnyMoments fixed{}, cosine{}, sine{}, cosine2{}, sine2{};
  AnyVector swing_fixed{}, swing_cosine{}, swing_sine{};
};
using GimbalPattern = GimbalTerms<MomentsPattern, Axes>;

/// Whether elements of x that are not in the pattern are 0, but for a tolerance.
template <class Vector>
bool fits(const Vector& x, unsigned pattern, double tolerance = 0.0) {
  for (int i = 0; i < x.size(); ++i) {
    if (!(pattern >> i & 1) && !(std::abs(x[i]) <= tolerance)) return false;
  }
  return true;
}

/// Of a b' + b a'.
constexpr unsigned product_pattern(Axes a, Axes b) {
  const auto mixed = [&](int i, int j) { return ((a >> i & b >> j) | (a >> j & b >> i)) & 1U; };
  return (a & b) | mixed(0, 1) << 3 | mixed(0, 2) << 4 | mixed(1, 2) << 5;
}

/// Of a x b.
constexpr Axes cross_pattern(Axes a, Axes b) {
  const unsigned mixed = product_pattern(a, b) >> 3;  // xy, xz, yz
  return mixed >> 2 | (mixed & 2) | (mixed & 1) << 2;
}

/// Of a body without gyros.
constexpr MomentsPattern pattern_of(const Shape::Joint& joint) {
  return {joint.cm, kDiagonal | product_pattern(joint.cm, joint.cm)};
}

constexpr GimbalPattern pattern_of(const Shape::Gyros& g) {
  const unsigned axes = product_pattern(g.axis, g.axis) | product_pattern(g.raised, g.raised);
  GimbalPattern p;
  p.fixed = {g.pivot, kDiagonal | product_pattern(g.pivot, g.pivot) | axes};
  p.cosine2.second = axes;
  p.sine2.second = product_pattern(g.axis, g.raised);
  p.swing_fixed = cross_pattern(g.axis, g.raised);
  if (!g.centred) {
    p.cosine = {g.axis, kDiagonal | product_pattern(g.pivot, g.axis)};
    p.sine = {g.raised, kDiagonal | product_pattern(g.pivot, g.raised)};
    p.swing_cosine = cross_pattern(g.pivot, g.raised);
    p.swing_sine = cross_pattern(g.pivot, g.axis);
  }
  if (g.balanced) {
    for (MomentsPattern* moments : {&p.fixed, &p.cosine, &p.sine, &p.cosine2, &p.sine2}) {
      *moments = *moments & MomentsPattern{kAlongZ, kDiagonal};
    }
    p.swing_fixed = p.swing_cosine = p.swing_sine = 0;
  }
  return p;
}

/// Of a body with what of its gyros' moments does not vary.
constexpr MomentsPattern fixed_pattern(const Shape& shape, int body) {
  MomentsPattern p = pattern_of(shape.bodies[body]);
  for (const Shape::Hinge& hinge : shape.gimbals) {
    if (hinge.carrier == body) p = p | pattern_of(hinge.gyros).fixed;
  }
  return p;
}

/// Of a vector of those axes turned about one of them, or of none.
constexpr Axes turned_pattern(Axes x, Axis about) {
  const Axes across = kAnywhere & ~(1U << static_cast<int>(about));
  return (x & across) != 0 ? x | across : x;
}

/// Of J x.
constexpr Axes times_pattern(unsigned J, Axes x) {
  Axes y = J & x;
  if (J & 8) y |= (x & 1) << 1 | (x & 2) >> 1;
  if (J & 16) y |= (x & 1) << 2 | (x & 4) >> 2;
  if (J & 32) y |= (x & 2) << 1 | (x & 4) >> 1;
  return y;
}

/// Which elements of a symmetric matrix can differ from 0.
struct Coupling {
  std::array<unsigned, kMaxCoordinates> of{};

  constexpr bool has(int i, int j) const { return of[i] >> j & 1; }
  constexpr void add(int i, int j) {
    of[i] |= 1U << j;
    of[j] |= 1U << i;
  }
};

/// Of M with masses that ride on body 0, and of what elimination from the last coordinate to the
/// first makes of it.
constexpr Coupling coupling_of(const Shape& shape) {
  std::array<std::array<Axes, kMaxCoordinates>, kMaxBodies> Jv{}, Jw{};
  Coupling M;
  for (int i : shape.bodies[0].angular) {
    for (int j : shape.bodies[0].angular) M.add(i, j);
  }
  for (int b = 0; b < shape.bodies.size; ++b) {
    const Shape::Joint& joint = shape.bodies[b];
    for (int i : joint.linear) Jv[b][i] = kAnywhere;
    for (int i : joint.inherited()) Jw[b][i] = Jw[joint.orientation_parent][i];
    for (const Rotation& r : joint.rotations) {
      for (Axes& x : Jw[b]) x = turned_pattern(x, r.axis);
      Jw[b][r.coordinate] = 1U << static_cast<int>(r.axis);
    }
    MomentsPattern moments = fixed_pattern(shape, b);
    for (const Shape::Hinge& hinge : shape.gimbals) {
      if (hinge.carrier != b) continue;
      const GimbalPattern p = pattern_of(hinge.gyros);
      const MomentsPattern varying = p.cosine | p.sine | p.cosine2 | p.sine2;
      moments = moments | varying;
      for (int i : joint.linear) {
        if (varying.first & Jv[b][i]) M.add(hinge.coordinate, i);
      }
      for (int i : joint.angular) {
        if ((p.swing_fixed | p.swing_cosine | p.swing_sine) & Jw[b][i]) M.add(hinge.coordinate, i);
      }
    }
    for (int i : joint.linear) {
      for (int j : joint.linear) M.add(i, j);
      for (int j : joint.angular) {
        if (cross_pattern(moments.first, Jv[b][i]) & Jw[b][j]) M.add(i, j);
      }
    }
    for (int i : joint.angular) {
      for (int j : joint.angular) {
        if (times_pattern(moments.second, Jw[b][i]) & Jw[b][j]) M.add(i, j);
      }
    }
  }
  for (int k = shape.coordinates - 1; k > 0; --k) {
    for (int i = 0; i < k; ++i) {
      for (int j = 0; j < k; ++j) {
        if (M.has(k, i) && M.has(k, j)) M.add(i, j);
      }
    }
  }
  return M;
}

}  // namespace gyrotwin::model
