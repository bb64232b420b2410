#include "services/schema/lcm_json.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "messages/big_endian.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

using nlohmann::json;

constexpr std::size_t kShown = 40;  // characters of a value in a message

[[noreturn]] void refuse(const std::string& path, const json& found, const std::string& wanted) {
  std::string text = found.dump(-1, ' ', true, json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  throw Error(path + ": expected " + wanted + ", found " + text);
}

std::int64_t whole_number(std::string_view digits, bool& good) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  good = error == std::errc() && end == digits.data() + digits.size();
  return value;
}

/// Writes the fields of one object into the bytes of one type.
class Writer {
 public:
  Writer(const LcmType& type, std::uint8_t* to, std::string path)
      : type_(type), to_(to), path_(std::move(path)) {}

  void object(const json& object) {
    if (!object.is_object()) refuse(path_.empty() ? type_.name : path_, object, "an object");
    for (const auto& [name, value] : object.items()) field(name, value);
  }

 private:
  void field(const std::string& name, const json& value) {
    const std::string path = path_.empty() ? name : path_ + '.' + name;
    const auto field = std::ranges::find(type_.fields, name, &LcmField::name);
    if (field == type_.fields.end()) {
      std::vector<std::string_view> names;
      for (const LcmField& f : type_.fields) names.push_back(f.name);
      throw Error(path + ": " + type_.name + " has no such field" +
                  did_you_mean(nearest(name, names)));
    }
    std::uint8_t* at = to_ + field->offset;
    if (field->is_text) return text(path, *field, value, at);
    if (field->dimensions.empty()) return element(path, *field, value, at);
    if (!value.is_array() || value.size() != field->count()) {
      refuse(path, value, "an array of " + std::to_string(field->count()));
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
      element(path + '[' + std::to_string(i) + ']', *field, value[i],
              at + i * field->element_size());
    }
  }

  static void text(const std::string& path, const LcmField& field, const json& value,
                   std::uint8_t* at) {
    const auto* text = value.get_ptr<const std::string*>();
    // The last byte stays NUL.
    if (text == nullptr || text->size() >= field.count()) {
      refuse(path, value, "a text of at most " + std::to_string(field.count() - 1) + " bytes");
    }
    std::ranges::copy(*text, at);
  }

  void element(const std::string& path, const LcmField& field, const json& value,
               std::uint8_t* at) {
    if (field.type != nullptr) return Writer(*field.type, at, path).object(value);
    switch (field.primitive) {
      case Primitive::kDouble:
        return put_big_endian(std::bit_cast<std::uint64_t>(number(path, value)), at);
      case Primitive::kFloat:
        return put_big_endian(std::bit_cast<std::uint32_t>(static_cast<float>(number(path, value))),
                              at);
      case Primitive::kInt64:
        return put_big_endian(static_cast<std::uint64_t>(integer<std::int64_t>(path, value)), at);
      case Primitive::kInt32:
        return put_big_endian(static_cast<std::uint32_t>(integer<std::int32_t>(path, value)), at);
      case Primitive::kInt16:
        return put_big_endian(static_cast<std::uint16_t>(integer<std::int16_t>(path, value)), at);
      case Primitive::kInt8:
        return put_big_endian(static_cast<std::uint8_t>(integer<std::int8_t>(path, value)), at);
      case Primitive::kByte:
        return put_big_endian(integer<std::uint8_t>(path, value), at);
      case Primitive::kBoolean:
        break;
    }
    if (!value.is_boolean()) refuse(path, value, "true or false");
    *at = value.get<bool>() ? 1 : 0;
  }

  static double number(const std::string& path, const json& value) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      refuse(path, value, "a finite number");
    }
    return value.get<double>();
  }

  template <class Integer>
  Integer integer(const std::string& path, const json& value) const {
    bool good = false;
    std::int64_t whole = 0;
    if (const auto* word = value.get_ptr<const std::string*>()) {
      const auto constant = std::ranges::find(type_.constants, *word, &LcmConstant::name);
      whole = whole_number(constant != type_.constants.end() ? constant->value : *word, good);
    } else if (value.is_number_unsigned()) {
      const auto large = value.get<std::uint64_t>();
      good = large <= std::uint64_t{std::numeric_limits<std::int64_t>::max()};
      whole = static_cast<std::int64_t>(large);
    } else if (value.is_number_integer()) {
      good = true;
      whole = value.get<std::int64_t>();
    }
    if (!good || whole < std::int64_t{std::numeric_limits<Integer>::min()} ||
        whole > std::int64_t{std::numeric_limits<Integer>::max()}) {
      refuse(path, value, "a whole number of this field's size, or a constant of " + type_.name);
    }
    return static_cast<Integer>(whole);
  }

  const LcmType& type_;
  std::uint8_t* to_;
  std::string path_;
};

}  // namespace

std::vector<std::uint8_t> payload_from_json(const LcmType& type, const json& object) {
  std::vector<std::uint8_t> payload(type.payload_size());
  put_big_endian(type.fingerprint, payload.data());
  Writer(type, payload.data() + sizeof type.fingerprint, "").object(object);
  return payload;
}

}  // namespace gyrotwin
