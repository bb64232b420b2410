#include "services/schema/ros2_message.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "services/schema/little_endian.hpp"

namespace gyrotwin {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 4> kEncapsulation{0, 1, 0, 0};  // CDR, little endian
constexpr std::size_t kRule = 80;                                  // characters between definitions

std::string_view ros2_name(Primitive primitive) {
  switch (primitive) {
    case Primitive::kInt8:
      return "int8";
    case Primitive::kInt16:
      return "int16";
    case Primitive::kInt32:
      return "int32";
    case Primitive::kInt64:
      return "int64";
    case Primitive::kByte:
      return "uint8";
    case Primitive::kBoolean:
      return "bool";
    case Primitive::kFloat:
      return "float32";
    case Primitive::kDouble:
      break;
  }
  return "float64";
}

/// "twin_state_t" becomes "TwinState".
std::string camel(std::string_view lcm_name) {
  if (lcm_name.ends_with("_t")) lcm_name.remove_suffix(2);
  std::string name;
  bool begins = true;
  for (const char c : lcm_name) {
    if (c != '_') {
      name += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    }
    begins = c == '_';
  }
  return name;
}

/// "int32_t" of the LCM text becomes "int32".
std::string ros2_constant_type(std::string_view lcm_type) {
  if (lcm_type == "double") return "float64";
  if (lcm_type == "float") return "float32";
  if (lcm_type.ends_with("_t")) lcm_type.remove_suffix(2);
  return std::string(lcm_type);
}

std::string fields_text(const LcmType& type) {
  std::string text;
  for (const LcmConstant& constant : type.constants) {
    text += ros2_constant_type(constant.type) + ' ' + constant.name + '=' + constant.value + '\n';
  }
  for (const LcmField& field : type.fields) {
    if (field.is_text) {
      text += "string";
    } else {
      text += field.type != nullptr ? "gyrotwin/" + camel(field.type->name)
                                    : std::string(ros2_name(field.primitive));
      if (!field.dimensions.empty()) text += '[' + std::to_string(field.count()) + ']';
    }
    text += ' ' + field.name;
    if (!field.comment.empty()) text += "  # " + field.comment;
    text += '\n';
  }
  return text;
}

/// The types within a type, each once, outer ones first.
void gather(const LcmType& type, std::vector<const LcmType*>& to) {
  for (const LcmField& field : type.fields) {
    if (field.type == nullptr || std::ranges::find(to, field.type) != to.end()) continue;
    to.push_back(field.type);
    gather(*field.type, to);
  }
}

/// Pads to a multiple of `size` behind the encapsulation header at `begin`.
void align(std::vector<std::uint8_t>& to, std::size_t begin, std::size_t size) {
  const std::size_t body = to.size() - begin - kEncapsulation.size();
  to.resize(to.size() + (size - body % size) % size);
}

}  // namespace

Ros2Message::Ros2Message(const LcmType& type)
    : name_("gyrotwin/msg/" + camel(type.name)), definition_(fields_text(type)) {
  std::vector<const LcmType*> inner;
  gather(type, inner);
  for (const LcmType* other : inner) {
    definition_ += std::string(kRule, '=') + "\nMSG: gyrotwin/" + camel(other->name) + '\n' +
                   fields_text(*other);
  }
  plan(type, sizeof type.fingerprint);
}

void Ros2Message::plan(const LcmType& type, std::size_t offset) {
  for (const LcmField& field : type.fields) {
    const std::size_t begin = offset + field.offset;
    if (field.type == nullptr) {
      runs_.push_back({begin, field.element_size(), field.count(), field.is_text});
      continue;
    }
    for (std::size_t i = 0; i < field.count(); ++i) plan(*field.type, begin + i * field.type->size);
  }
}

void Ros2Message::encode(Bytes payload, std::vector<std::uint8_t>& to) const {
  const std::size_t begin = to.size();
  to.insert(to.end(), kEncapsulation.begin(), kEncapsulation.end());
  for (const Run& run : runs_) {
    const Bytes bytes = payload.subspan(run.offset, run.size * run.count);
    if (run.is_text) {
      const auto end = std::ranges::find(bytes, 0);
      align(to, begin, sizeof(std::uint32_t));
      append_little_endian(to, static_cast<std::uint32_t>(end - bytes.begin() + 1));
      to.insert(to.end(), bytes.begin(), end);
      to.push_back(0);
      continue;
    }
    align(to, begin, run.size);
    for (std::size_t i = 0; i < run.count; ++i) {
      const Bytes number = bytes.subspan(i * run.size, run.size);
      to.insert(to.end(), number.rbegin(), number.rend());
    }
  }
}

}  // namespace gyrotwin
