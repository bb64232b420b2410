// Files that programs leave only when they are whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

/// A name for a file that is written as NAME.part and gets its name when it is whole. If it does
/// not, the part is removed.
class PartFile {
 public:
  /// @param overwrite whether a file of that name may be replaced
  /// @throws Error when there is one and it may not
  PartFile(std::filesystem::path name, bool overwrite);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile();

  const std::filesystem::path& name() const { return name_; }
  const std::filesystem::path& part() const { return part_; }

  /// Gives the file its name. @throws NotDone
  void keep();

 private:
  std::filesystem::path name_, part_;  // part_ is empty when there is nothing left to remove
};

/// Such a file, written from its start to its end.
class OutputFile {
 public:
  /// @throws Error when it exists already and may not be replaced, or cannot be made
  OutputFile(std::filesystem::path name, bool overwrite);

  /// @throws NotDone when the disk takes no more
  void write(std::string_view bytes);
  void write(std::span<const std::uint8_t> bytes) {
    write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  /// @throws NotDone when the disk did not keep it
  void finish();

  const std::filesystem::path& name() const { return file_.name(); }
  std::int64_t size() const { return size_; }  ///< written so far [byte]

 private:
  void flush();
  [[noreturn]] void give_up(int error) const;

  PartFile file_;
  Descriptor descriptor_;
  std::string buffer_;
  std::int64_t size_ = 0;
};

}  // namespace gyrotwin
