// The device's end of the line: a pseudo-terminal of its own, or a tty that is there. Nothing
// blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

class Terminal {
 public:
  /// A new pseudo-terminal, raw.
  /// @param link where a symbolic link to it shall be while it lives; empty: none. One that is
  /// there is replaced, anything else is not.
  /// @throws Error
  static Terminal pseudo(const std::filesystem::path& link);
  /// A tty, made raw; its rate is left as it is.
  /// @throws Error
  static Terminal device(const std::filesystem::path& path);
  ~Terminal();
  Terminal(Terminal&& other) noexcept;
  Terminal& operator=(Terminal&&) = delete;

  /// What the host opens.
  const std::string& path() const noexcept { return path_; }
  int descriptor() const noexcept { return near_.get(); }

  /// What has come, at most the size of `room`; empty when nothing waits.
  std::span<const std::uint8_t> read(std::span<std::uint8_t> room) noexcept;
  /// @return how many of the bytes it takes now
  std::size_t write(std::span<const std::uint8_t> bytes) noexcept;
  /// The tty is gone.
  bool lost() const noexcept { return lost_; }
  /// A host that opened a pseudo-terminal for itself alone keeps it beyond its own end, since ours
  /// is still open; whoever comes next may open it after this.
  void share() noexcept;

 private:
  Terminal(Descriptor near, Descriptor far, std::string path, std::filesystem::path link);

  Descriptor near_, far_;  // far_: a pseudo-terminal's other side, so that it is never hung up
  std::string path_;
  std::filesystem::path link_;
  bool lost_ = false;
};

}  // namespace gyrotwin
