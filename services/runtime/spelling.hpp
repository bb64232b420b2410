// Finding what was meant by a misspelt name.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace gyrotwin {

/// Insertions, deletions and changes of one character, and swaps of two neighbours, that turn `a`
/// into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Whether so small a distance speaks for a slip: at most half of the longer name.
bool is_near(std::size_t distance, std::string_view a, std::string_view b);

/// The candidate closest to `word`; empty when none is near.
std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);

/// "; did you mean `name`?", or nothing for no name.
std::string did_you_mean(std::string_view name);

}  // namespace gyrotwin
