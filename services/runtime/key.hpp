// The secret that a rig's messages are signed with, and random identities.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace gyrotwin {

using Key = std::array<std::uint8_t, 32>;

/// Where the key of a rig lives: `$GYROTWIN_KEYS/<rig>.key`, else
/// `$XDG_CONFIG_HOME/gyrotwin/<rig>.key`, else `~/.config/gyrotwin/<rig>.key`.
/// @throws Error when none of these variables and no HOME is set
std::filesystem::path key_path(std::string_view rig_name);

/// Reads a key: 64 hex digits and a newline, in a file that nobody but its user can read.
/// @throws Error naming the file, what is wrong with it and the fix
Key load_key(const std::filesystem::path& path);

/// Draws a new key into a new file of mode 0600; a folder that is missing is made with mode 0700.
/// @throws Error when the file exists already or cannot be written
void create_key(const std::filesystem::path& path);

/// 64 bits that tell keys apart and do not lead back to them: "3f2a-91c0-77de-0b15".
std::string fingerprint(const Key& key);

/// First 64 bits of BLAKE2b-256.
std::uint64_t digest(std::span<const std::uint8_t> bytes) noexcept;

/// A random non-negative 63-bit number: an epoch, or a writer's identity. One system call.
std::int64_t random_id() noexcept;

}  // namespace gyrotwin
