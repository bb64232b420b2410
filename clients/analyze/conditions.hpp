// The derived numbers of a rig, and the conditions that its standing hangs on. Derivation:
// services/model/README.md, sections 4 and 5.
#pragma once

#include <vector>

#include "clients/analyze/findings.hpp"
#include "clients/analyze/modes.hpp"
#include "clients/analyze/polynomial.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// A characteristic polynomial of a reduced model, and its scheme.
struct Criterion {
  std::string name;     ///< "disc left alone"
  std::string formula;  ///< "A C s^3 + (A b + C cs) s^2 + (H^2 - C U + b cs) s - U b"
  Polynomial polynomial;
  Routh scheme;
};

/// What the formulas say of a rig.
struct Theory {
  std::vector<DerivedNumber> numbers;
  std::vector<Condition> conditions;
  std::vector<Criterion> criteria;
};

/// @param linear of the rig under its law, where there is one: tells the preload of the ring and
///        what the law does to the gimbals
Theory theory_of(const Rig& rig, const std::optional<LinearModel>& linear);

}  // namespace gyrotwin
