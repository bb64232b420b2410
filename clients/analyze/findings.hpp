// What an analysis finds: numbers, conditions, limits. Each has a key for programs and words for
// people.
#pragma once

#include <string>
#include <vector>

namespace gyrotwin {

/// A derived number.
struct DerivedNumber {
  std::string key;      ///< "stability_ratio"
  std::string symbol;   ///< "H^2/(C U)"
  std::string meaning;  ///< one line
  double value;
  std::string unit;  ///< "N m s"; empty: a ratio
};

/// An inequality that decides something, or advises.
struct Condition {
  std::string key;
  std::string claim;    ///< "H^2 > C U"
  std::string meaning;  ///< what it decides, in plain words
  double value, required;
  std::string unit;
  bool holds;
  bool decides;  ///< what it forbids falls; otherwise it is a rule of thumb or a limit

  /// How far it is fulfilled: value / required or its inverse, > 1 where it holds; not finite where
  /// that says nothing (a required 0).
  double margin;
};

/// value > required.
Condition above(std::string key, std::string claim, std::string meaning, double value,
                double required, std::string unit, bool decides);
/// value < required.
Condition below(std::string key, std::string claim, std::string meaning, double value,
                double required, std::string unit, bool decides);

}  // namespace gyrotwin
