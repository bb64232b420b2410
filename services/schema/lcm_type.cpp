#include "services/schema/lcm_type.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>

#include "messages/big_endian.hpp"
#include "services/schema/lcm_source.hpp"

namespace gyrotwin {

namespace {

constexpr int kDeepest = 16;               // types within types
constexpr std::size_t kLargest = 1 << 20;  // [byte]

struct PrimitiveName {
  std::string_view name;
  Primitive primitive;
  std::size_t size;
};
constexpr std::array<PrimitiveName, 8> kPrimitives{{{"int8_t", Primitive::kInt8, 1},
                                                    {"int16_t", Primitive::kInt16, 2},
                                                    {"int32_t", Primitive::kInt32, 4},
                                                    {"int64_t", Primitive::kInt64, 8},
                                                    {"byte", Primitive::kByte, 1},
                                                    {"boolean", Primitive::kBoolean, 1},
                                                    {"float", Primitive::kFloat, 4},
                                                    {"double", Primitive::kDouble, 8}}};

const PrimitiveName* find_primitive(std::string_view name) {
  const auto* found = std::ranges::find(kPrimitives, name, &PrimitiveName::name);
  return found == kPrimitives.end() ? nullptr : found;
}

/// lcm-gen's hash of a type: names, primitive types and dimensions of its members, in order.
class Hash {
 public:
  void character(std::uint64_t c) {
    // The shift to the right is one of a signed number.
    value_ =
        ((value_ << 8) ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(value_) >> 55)) + c;
  }
  void text(std::string_view text) {
    character(text.size());
    for (const char c : text) character(static_cast<std::uint64_t>(c));
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0x12345678;
};

std::uint64_t hash_of(const LcmStruct& parsed) {
  constexpr std::uint64_t kConstant = 0;  // a dimension that is a number
  Hash hash;
  for (const LcmMember& member : parsed.members) {
    hash.text(member.name);
    if (find_primitive(member.type) != nullptr) hash.text(member.type);
    hash.character(member.dimensions.size());
    for (const std::size_t dimension : member.dimensions) {
      hash.character(kConstant);
      hash.text(std::to_string(dimension));
    }
  }
  return hash.value();
}

}  // namespace

std::size_t size_of(Primitive primitive) {
  return std::ranges::find(kPrimitives, primitive, &PrimitiveName::primitive)->size;
}

std::size_t LcmField::element_size() const {
  return type != nullptr ? type->size : size_of(primitive);
}

std::size_t LcmField::count() const {
  std::size_t n = 1;
  for (const std::size_t dimension : dimensions) n *= dimension;
  return n;
}

std::optional<LcmNumber> locate(const LcmType& type, std::string_view path) {
  const std::size_t dot = path.find('.');
  const auto field = std::ranges::find(type.fields, path.substr(0, dot), &LcmField::name);
  if (field == type.fields.end() || !field->dimensions.empty()) return {};
  if (dot == std::string_view::npos) {
    if (field->type != nullptr) return {};
    return LcmNumber{sizeof type.fingerprint + field->offset, field->primitive};
  }
  if (field->type == nullptr) return {};
  auto inner = locate(*field->type, path.substr(dot + 1));
  if (inner) inner->offset += field->offset;
  return inner;
}

std::int64_t integer_at(std::span<const std::uint8_t> payload, const LcmNumber& number) {
  switch (number.primitive) {
    case Primitive::kInt8:
      return static_cast<std::int8_t>(payload[number.offset]);
    case Primitive::kInt16:
      return static_cast<std::int16_t>(big_endian<std::uint16_t>(payload, number.offset));
    case Primitive::kInt32:
      return static_cast<std::int32_t>(big_endian<std::uint32_t>(payload, number.offset));
    case Primitive::kInt64:
      return static_cast<std::int64_t>(big_endian<std::uint64_t>(payload, number.offset));
    case Primitive::kByte:
    case Primitive::kBoolean:
      return payload[number.offset];
    case Primitive::kFloat:
    case Primitive::kDouble:
      break;
  }
  return 0;
}

double number_at(std::span<const std::uint8_t> payload, const LcmNumber& number) {
  if (number.primitive == Primitive::kFloat) {
    return std::bit_cast<float>(big_endian<std::uint32_t>(payload, number.offset));
  }
  if (number.primitive == Primitive::kDouble) {
    return std::bit_cast<double>(big_endian<std::uint64_t>(payload, number.offset));
  }
  return static_cast<double>(integer_at(payload, number));
}

LcmTypes::LcmTypes(std::span<const std::string> sources) {
  for (const std::string& source : sources) {
    for (LcmStruct& parsed : parse_lcm(source)) {
      std::string name = parsed.name;
      structs_.insert_or_assign(std::move(name), std::move(parsed));
    }
  }
  for (const auto& entry : structs_) resolve(entry.first, 0);
}

const LcmType* LcmTypes::find(std::string_view name) const {
  const auto found = types_.find(name);
  return found == types_.end() ? nullptr : found->second.get();
}

const LcmType* LcmTypes::find(std::uint64_t fingerprint) const {
  return find_if([fingerprint](const LcmType& type) { return type.fingerprint == fingerprint; });
}

/// Lays a type out. @return null where something is missing, goes in circles or has no one size
const LcmType* LcmTypes::resolve(const std::string& name, int depth) {
  if (const auto known = types_.find(name); known != types_.end()) return known->second.get();
  const auto parsed = structs_.find(name);
  types_.insert_or_assign(name, nullptr);  // what goes in circles meets this
  if (parsed == structs_.end() || !parsed->second.one_size || depth > kDeepest) return nullptr;

  auto type = std::make_unique<LcmType>(
      LcmType{name, hash_of(parsed->second), 0, {}, parsed->second.constants});
  for (const LcmMember& member : parsed->second.members) {
    const PrimitiveName* primitive = find_primitive(member.type);
    LcmField field{
        .name = member.name,
        .offset = type->size,
        .primitive = primitive != nullptr ? primitive->primitive : Primitive::kByte,
        .type = primitive != nullptr ? nullptr : resolve(member.type, depth + 1),
        .dimensions = member.dimensions,
        .is_text = member.is_text && member.type == "byte" && member.dimensions.size() == 1,
        .comment = member.comment};
    if (primitive == nullptr && field.type == nullptr) return nullptr;
    if (field.type != nullptr) type->fingerprint += field.type->fingerprint;
    // Dimensions are at most kLargest each, and few.
    for (std::size_t size = field.element_size(); const std::size_t n : field.dimensions) {
      if ((size *= n) > kLargest) return nullptr;
    }
    type->size += field.element_size() * field.count();
    if (type->size > kLargest) return nullptr;
    type->fields.push_back(std::move(field));
  }
  if (type->size == 0) return nullptr;  // a row of nothing could be endless
  type->fingerprint = std::rotl(type->fingerprint, 1);
  return types_.insert_or_assign(name, std::move(type)).first->second.get();
}

}  // namespace gyrotwin
