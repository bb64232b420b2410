// What an analysis finds: numbers, conditions, limits. Each has a key for programs and words for
// people.
#pragma once

#include <cmath>
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

/// Adds to a list of numbers.
class Teller {
 public:
  explicit Teller(std::vector<DerivedNumber>& all) : all_(all) {}
  void operator()(const char* key, const char* symbol, const char* meaning, double value,
                  const char* unit) const {
    all_.push_back({key, symbol, meaning, value, unit});
  }

 private:
  std::vector<DerivedNumber>& all_;
};

/// What hangs on a condition.
enum class Role {
  kDecides,   ///< what it forbids does not come back upright: it falls, or parks tilted
  kExplains,  ///< a rule of thumb that tells why one that decides fails
  kAdvises    ///< a limit, or a hint
};

/// An inequality that decides something, or advises.
struct Condition {
  std::string key;
  std::string claim;    ///< "H^2 > C U"
  std::string meaning;  ///< what it does where it holds, in plain words
  double value, required;
  std::string relation;  ///< of value to required, ">" or "<"; empty: a matter of yes or no
  std::string unit;
  bool holds;
  Role role;

  /// How far it is fulfilled: value / required or its inverse, > 1 where it holds; not finite where
  /// that says nothing (a required 0).
  double margin;

  bool decides() const { return role == Role::kDecides; }
  /// It compares two numbers; otherwise it is a matter of yes (value 1) or no (0).
  bool compares() const { return std::isfinite(required); }
};

/// value > required.
Condition above(std::string key, std::string claim, std::string meaning, double value,
                double required, std::string unit, Role role);
/// value < required.
Condition below(std::string key, std::string claim, std::string meaning, double value,
                double required, std::string unit, Role role);
/// True or not; it has no margin.
Condition yes_no(std::string key, std::string claim, std::string meaning, bool holds, Role role);

}  // namespace gyrotwin
