// What many runs say together.
#pragma once

#include <cstdint>
#include <span>

namespace gyrotwin {

/// Share of the hits, and the interval that holds the true one in 95 of 100 cases.
struct Proportion {
  double share, low, high;
};

/// E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209: right for few tries and shares near 0 and 1
/// too.
/// @pre 0 <= hits <= tries; without tries: nothing is known, 0 to 1
Proportion proportion(std::int64_t hits, std::int64_t tries);

/// Spearman's rank correlation: +1 when y always rises with x, whatever the curve; ties get their
/// mean rank. Not finite, there is none, when either is constant.
/// @pre both as long
double rank_correlation(std::span<const double> x, std::span<const double> y);

}  // namespace gyrotwin
