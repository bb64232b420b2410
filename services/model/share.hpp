// What the gyros of one gimbal add to the body that carries them, written out for how they lie.
// Derivation: README.md, section 2.
#pragma once

#include "services/model/gimbal.hpp"
#include "services/model/unroll.hpp"

namespace gyrotwin::model {

/// x with known zeros where the pattern has none.
template <Axes pattern>
static Eigen::Vector3d sparse(const Eigen::Vector3d& x) {
  return {pattern & 1 ? x[0] : 0.0, pattern & 2 ? x[1] : 0.0, pattern & 4 ? x[2] : 0.0};
}
template <MomentsPattern pattern>
static Moments<double> sparse(const Moments<double>& x) {
  Moments<double> y;
  y.first = sparse<pattern.first>(x.first);
  for (int i = 0; i < 6; ++i) y.second[i] = pattern.second >> i & 1 ? x.second[i] : 0.0;
  return y;
}

/// What a gimbal adds to its carrier at one angle; x_q is dx/dq. About the carrier's pivot, in its
/// axes.
template <class S>
struct GimbalShare {
  Moments<S> moments, moments_q;  ///< of the moments the part that varies
  Vector3<S> swing, swing_q;      ///< angular momentum of a unit rate of q [kg m^2]
  Vector3<S> h, h_q, h_t;         ///< rotor momentum [N m s], and by time
};

/// @tparam gyros how the gimbal's gyros lie
/// @param c, s cosine and sine of q
template <Shape::Gyros gyros, class S>
static GimbalShare<S> share_of(const Gimbal& gimbal, const S& c, const S& s,
                               const Rotors& rotors) noexcept {
  const Gimbal::Terms& terms = gimbal.terms();
  constexpr GimbalPattern pattern = pattern_of(gyros);
  GimbalShare<S> share;
  const S c2 = c * c - s * s, s2 = 2.0 * c * s;
  const Moments<double> cosine = sparse<pattern.cosine>(terms.cosine);
  const Moments<double> sine = sparse<pattern.sine>(terms.sine);
  const Moments<double> cosine2 = sparse<pattern.cosine2>(terms.cosine2);
  const Moments<double> sine2 = sparse<pattern.sine2>(terms.sine2);
  share.moments.add(c, cosine);
  share.moments.add(s, sine);
  share.moments.add(c2, cosine2);
  share.moments.add(s2, sine2);
  share.moments_q.add(-s, cosine);
  share.moments_q.add(c, sine);
  share.moments_q.add(-2.0 * s2, cosine2);
  share.moments_q.add(2.0 * c2, sine2);
  const Eigen::Vector3d swing_cosine = sparse<pattern.swing_cosine>(terms.swing_cosine);
  const Eigen::Vector3d swing_sine = sparse<pattern.swing_sine>(terms.swing_sine);
  share.swing =
      sparse<pattern.swing_fixed>(terms.swing_fixed) + (c * swing_cosine + s * swing_sine);
  share.swing_q = c * swing_sine - s * swing_cosine;

  Eigen::Vector3d h_axis = Eigen::Vector3d::Zero(), h_raised = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_axis = Eigen::Vector3d::Zero(), rate_raised = Eigen::Vector3d::Zero();
  count_to<gyros.rotors>([&](auto j) {
    constexpr int rotor = gyros.first_rotor + j;
    const Eigen::Vector3d axis = sparse<gyros.axis>(gimbal.momentum().row(rotor));
    const Eigen::Vector3d raised = sparse<gyros.raised>(gimbal.raised_momentum().row(rotor));
    h_axis += rotors.speed[rotor] * axis;
    h_raised += rotors.speed[rotor] * raised;
    rate_axis += rotors.rate[rotor] * axis;
    rate_raised += rotors.rate[rotor] * raised;
  });
  share.h = c * h_axis + s * h_raised;
  share.h_q = c * h_raised - s * h_axis;
  share.h_t = c * rate_axis + s * rate_raised;
  return share;
}

}  // namespace gyrotwin::model
