// Brings a crew and a journal together.
#pragma once

#include <cstdint>
#include <functional>

#include "clients/sweep/crew.hpp"
#include "clients/sweep/journal.hpp"

namespace gyrotwin {

/// Has the crew do the runs that the journal lacks.
/// @param go_on is told every 100 ms or so how many are done; false: no new run begins, those under
///        way are waited for
/// @return whether all are done
/// @throws Error as the crew and the journal do, once the others' runs have come in
bool conduct(Crew& crew, Journal& journal, std::int64_t runs,
             const std::function<bool(std::int64_t done)>& go_on);

}  // namespace gyrotwin
