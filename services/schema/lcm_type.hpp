// LCM types from their text, so that a log can be read by the types it carries. Of LCM's language
// what gyrotwin's wire allows: types of one size, without `string` and variable arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/schema/lcm_source.hpp"

namespace gyrotwin {

/// Texts of the types that this program was built with.
std::span<const std::string> lcm_sources();

struct LcmType;

enum class Primitive : std::uint8_t {
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kByte,
  kBoolean,
  kFloat,
  kDouble
};

/// Bytes of one on the wire.
std::size_t size_of(Primitive primitive);

/// One field of a type.
struct LcmField {
  std::string name;
  std::size_t offset;                   ///< from the start of its type [byte]
  Primitive primitive;                  ///< where there is no `type`
  const LcmType* type;                  ///< of a field that has fields; else null
  std::vector<std::size_t> dimensions;  ///< none: one element
  bool is_text;                         ///< bytes that the comment behind them calls ASCII
  std::string comment;                  ///< behind it in the text, its unit first

  std::size_t element_size() const;
  std::size_t count() const;  ///< of all its elements
};

/// A type of one size.
struct LcmType {
  std::string name;           ///< without package
  std::uint64_t fingerprint;  ///< stands first in every message
  std::size_t size;           ///< of the fields [byte]
  std::vector<LcmField> fields;
  std::vector<LcmConstant> constants{};

  std::size_t payload_size() const { return sizeof fingerprint + size; }
};

/// Where a number stands in the payload of a type.
struct LcmNumber {
  std::size_t offset;  ///< from the fingerprint on [byte]
  Primitive primitive;
};

/// The number at a path like `header.epoch`; empty where the type has none there.
std::optional<LcmNumber> locate(const LcmType& type, std::string_view path);

/// An integer of a payload of the type it was located in.
std::int64_t integer_at(std::span<const std::uint8_t> payload, const LcmNumber& number);

/// A number of the payload.
double number_at(std::span<const std::uint8_t> payload, const LcmNumber& number);

/// Types that know each other.
class LcmTypes {
 public:
  /// @param sources .lcm texts; of two structs with one name the later is taken
  /// @throws Error naming the line and what was expected there
  explicit LcmTypes(std::span<const std::string> sources);

  /// Empty for a type that is not there, or has no one size.
  const LcmType* find(std::string_view name) const;
  const LcmType* find(std::uint64_t fingerprint) const;

  /// The first that satisfies `holds`, or null.
  template <class Holds>
  const LcmType* find_if(Holds&& holds) const {
    for (const auto& [name, type] : types_) {
      if (type && holds(*type)) return type.get();
    }
    return nullptr;
  }

 private:
  const LcmType* resolve(const std::string& name, int depth);

  std::map<std::string, LcmStruct, std::less<>> structs_;
  std::map<std::string, std::unique_ptr<LcmType>, std::less<>> types_;
};

}  // namespace gyrotwin
