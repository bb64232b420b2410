// An analysis as text, and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clients/analyze/analysis.hpp"

namespace gyrotwin {

/// For a terminal: verdict and reason first, then what they rest on.
std::string text_of(const Rig& rig, const Analysis& analysis);

/// Everything, numbers with every digit, units in the names or beside the values; what is not
/// finite is null.
nlohmann::ordered_json json_of(const Rig& rig, const Analysis& analysis);

/// "at 1.4 s: 20 s later it stands, tilt at most 4.4 deg": what the reference push did; empty where
/// there was none.
std::string push_words(const Case& seen);

/// Which loads count as stood, in words. @pre there are limits
std::string limits_rule(const Analysis& analysis);
/// "its stops take over at 62 N m": where and how a limit ends.
std::string limit_words(const Limit& limit);

/// What is to be known of the eigenvalues; empty where they tell all of small deviations.
std::vector<std::string> cautions(const LinearModel& linear);

/// "-0.41", "-3.2+-139.5i": each pair once.
std::string listed_rates(const Eigen::VectorXcd& eigenvalues);

/// Four digits, and the value's unit.
std::string with_unit(double value, const std::string& unit);

}  // namespace gyrotwin
