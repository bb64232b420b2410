// A machine's motion under a law, by the tests' own integrator.
#pragma once

#include <functional>

#include "services/model/machine.hpp"
#include "tests/support/extrapolation.hpp"

namespace gyrotwin::reference {

using Law = std::function<model::Input(double t, const model::State& state)>;

/// The law of a machine left alone.
inline model::Input no_input(double /*t*/, const model::State& /*state*/) { return {}; }

/// The machine from t = 0 until `duration` [s] under a law; `observe(t, state)` sees the start and
/// every accepted step and ends the run by returning false. @returns the last state seen.
model::State simulate(
    const model::Machine& machine, const model::State& start, double duration, const Law& law,
    const Tolerance& tolerance = {},
    const std::function<bool(double t, const model::State& state)>& observe =
        [](double, const model::State&) { return true; });

}  // namespace gyrotwin::reference
