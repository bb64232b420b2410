// What the umbrella platform's formulas share.
#pragma once

#include <optional>

#include "clients/analyze/modes.hpp"
#include "services/model/free_tilt.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// Symbols as in services/model/README.md, section 4; what hangs on the steady motion is that of
/// the ring's elevation where there is none.
struct Symbols {
  model::ReducedUmbrella r;
  model::FreeTilt tilt;        ///< with the gyros where they rest
  model::TiltBushing between;  ///< what axles and bushing are together, steady
  double b, cs;                ///< friction of disc and ground [N m s/rad]
  double shorted;              ///< b with the drive's motor shorted [N m s/rad]
  double speed;                ///< Omega, of the disc, signed [rad/s]
  double L;                    ///< momentum along the disc's axis [N m s]
  double press;                ///< moment with which the ring rights the structure, level; < 0:
                               ///< the axles are lifted off it [N m]
  double no_load;              ///< of the drive [rad/s]
  double preload;              ///< of one axle on the ring, steady [N]
  double sink;                 ///< of one axle [m]
  double growth;               ///< of the tilts of structure and disc [1/s]
  bool carried;                ///< level: the bushing alone holds the structure up
};

Symbols symbols_of(const Rig& rig, const model::UmbrellaParameters& p,
                   const std::optional<LinearModel>& linear);

}  // namespace gyrotwin
