// Messages as text: JSON with everything, and a short form for people.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "services/schema/lcm_type.hpp"

namespace gyrotwin {

/// Appends the fields of a payload of this type, fingerprint included, as a JSON object: every
/// digit of every number; inf and nan as strings; bytes as hex digits, but text as a string.
void append_json(std::string& to, const LcmType& type, std::span<const std::uint8_t> payload);

/// Appends ` name value` for every field that is not zero, numbers with 6 digits; of the header
/// sequence and tick; no bytes but text.
void append_short(std::string& to, const LcmType& type, std::span<const std::uint8_t> payload);

/// The text in a byte field of the type, characters that no terminal should see as '?'; empty where
/// there is no such field.
std::string text_at(const LcmType& type, std::span<const std::uint8_t> payload,
                    std::string_view field);

/// Appends a JSON string.
void append_json_string(std::string& to, std::string_view text);

/// Appends two hex digits a byte.
void append_hex(std::string& to, std::span<const std::uint8_t> bytes);

}  // namespace gyrotwin
