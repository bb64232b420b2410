#include "services/schema/lcm_text.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

using Bytes = std::span<const std::uint8_t>;

bool is_byte_array(const LcmField& field) {
  return field.type == nullptr && field.primitive == Primitive::kByte &&
         field.dimensions.size() == 1;
}

std::size_t size_of(const LcmField& field) { return field.element_size() * field.count(); }

void append_json_number(std::string& to, Primitive primitive, Bytes element) {
  const LcmNumber number{0, primitive};
  const auto out = std::back_inserter(to);
  if (primitive == Primitive::kBoolean) {
    to += element[0] != 0 ? "true" : "false";
  } else if (primitive != Primitive::kFloat && primitive != Primitive::kDouble) {
    fmt::format_to(out, "{}", integer_at(element, number));
  } else if (const double x = number_at(element, number); !std::isfinite(x)) {
    fmt::format_to(out, "\"{}\"", x);
  } else if (primitive == Primitive::kFloat) {
    fmt::format_to(out, "{}", static_cast<float>(x));
  } else {
    fmt::format_to(out, "{}", x);
  }
}

void append_json_fields(std::string& to, const LcmType& type, Bytes body);

/// The dimensions from `level` on of a field.
void append_json_value(std::string& to, const LcmField& field, std::size_t level, Bytes bytes) {
  if (level == field.dimensions.size()) {
    return field.type != nullptr ? append_json_fields(to, *field.type, bytes)
                                 : append_json_number(to, field.primitive, bytes);
  }
  const std::size_t step = bytes.size() / field.dimensions[level];
  for (std::size_t i = 0; i < field.dimensions[level]; ++i) {
    to += i == 0 ? '[' : ',';
    append_json_value(to, field, level + 1, bytes.subspan(i * step, step));
  }
  to += ']';
}

void append_json_fields(std::string& to, const LcmType& type, Bytes body) {
  to += '{';
  for (const LcmField& field : type.fields) {
    if (to.back() != '{') to += ',';
    append_json_string(to, field.name);
    to += ':';
    const Bytes bytes = body.subspan(field.offset, size_of(field));
    if (!is_byte_array(field)) {
      append_json_value(to, field, 0, bytes);
    } else if (field.is_text) {
      append_json_string(to, get_text(bytes));
    } else {
      to += '"';
      append_hex(to, bytes);
      to += '"';
    }
  }
  to += '}';
}

void append_short_fields(std::string& to, const LcmType& type, Bytes body);

void append_short_elements(std::string& to, const LcmField& field, Bytes bytes) {
  if (field.type != nullptr) {
    const std::size_t size = field.type->size;
    for (std::size_t at = 0; at < bytes.size(); at += size) {
      to += " {";
      append_short_fields(to, *field.type, bytes.subspan(at, size));
      to += " }";
    }
    return;
  }
  const std::size_t step = gyrotwin::size_of(field.primitive);
  const bool is_float =
      field.primitive == Primitive::kFloat || field.primitive == Primitive::kDouble;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    const LcmNumber number{at, field.primitive};
    to += at == 0 ? ' ' : ',';
    if (is_float) {
      fmt::format_to(std::back_inserter(to), "{:.6g}", number_at(bytes, number));
    } else {
      fmt::format_to(std::back_inserter(to), "{}", integer_at(bytes, number));
    }
  }
}

void append_short_fields(std::string& to, const LcmType& type, Bytes body) {
  for (const LcmField& field : type.fields) {
    const Bytes bytes = body.subspan(field.offset, size_of(field));
    if (std::ranges::all_of(bytes, [](std::uint8_t b) { return b == 0; })) continue;
    if (is_byte_array(field)) {
      if (field.is_text) {
        to.append(" ").append(field.name).append(" ");
        append_json_string(to, get_text(bytes));
      }
      continue;
    }
    to.append(" ").append(field.name);
    append_short_elements(to, field, bytes);
  }
}

}  // namespace

std::string text_at(const LcmType& type, Bytes payload, std::string_view field) {
  const auto found = std::ranges::find(type.fields, field, &LcmField::name);
  if (found == type.fields.end() || !is_byte_array(*found)) return "";
  return get_text(payload.subspan(sizeof type.fingerprint + found->offset, size_of(*found)));
}

void append_json_string(std::string& to, std::string_view text) {
  to += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') to += '\\';
    if (static_cast<unsigned char>(c) < ' ') {
      fmt::format_to(std::back_inserter(to), "\\u{:04x}", static_cast<unsigned>(c));
    } else {
      to += c;
    }
  }
  to += '"';
}

void append_hex(std::string& to, Bytes bytes) {
  for (const std::uint8_t b : bytes) fmt::format_to(std::back_inserter(to), "{:02x}", b);
}

void append_json(std::string& to, const LcmType& type, Bytes payload) {
  append_json_fields(to, type, payload.subspan(sizeof type.fingerprint));
}

void append_short(std::string& to, const LcmType& type, Bytes payload) {
  const auto sequence = locate(type, "header.sequence");
  const auto tick = locate(type, "header.tick");
  if (!sequence || !tick) {
    return append_short_fields(to, type, payload.subspan(sizeof type.fingerprint));
  }
  fmt::format_to(std::back_inserter(to), " sequence {} tick {}", integer_at(payload, *sequence),
                 integer_at(payload, *tick));
  LcmType rest = type;
  std::erase_if(rest.fields, [](const LcmField& field) { return field.name == "header"; });
  append_short_fields(to, rest, payload.subspan(sizeof type.fingerprint));
}

}  // namespace gyrotwin
