#include "clients/log/export_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kPiece = 1 << 18;  // written at once [byte]

}  // namespace

PartFile::PartFile(std::filesystem::path name, bool overwrite)
    : name_(std::move(name)), part_(name_.string() + ".part") {
  std::error_code none;
  if (!overwrite && std::filesystem::exists(name_, none)) {
    throw Error(name_.string() + ": exists already; give another name, or --force to replace it");
  }
}

PartFile::~PartFile() {
  std::error_code none;
  if (!part_.empty()) std::filesystem::remove(part_, none);
}

void PartFile::keep() {
  std::error_code error;
  std::filesystem::rename(part_, name_, error);
  if (error) throw NotDone(name_.string() + ": cannot be given its name: " + error.message());
  part_.clear();
}

OutputFile::OutputFile(std::filesystem::path name, bool overwrite)
    : file_(std::move(name), overwrite),
      descriptor_(::open(file_.part().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (!descriptor_.valid()) {
    throw Error(file_.part().string() + ": cannot be made: " + std::strerror(errno));
  }
}

void OutputFile::write(std::string_view bytes) {
  buffer_ += bytes;
  size_ += static_cast<std::int64_t>(bytes.size());
  if (buffer_.size() >= kPiece) flush();
}

void OutputFile::finish() {
  flush();
  if (::fsync(descriptor_.get()) != 0) give_up(errno);
  descriptor_ = Descriptor();
  file_.keep();
}

void OutputFile::flush() {
  for (std::size_t at = 0; at < buffer_.size();) {
    const ssize_t count = ::write(descriptor_.get(), buffer_.data() + at, buffer_.size() - at);
    if (count < 0 && errno != EINTR) give_up(errno);
    at += count < 0 ? 0 : static_cast<std::size_t>(count);
  }
  buffer_.clear();
}

void OutputFile::give_up(int error) const {
  throw NotDone(name().string() + ": cannot be written whole: " + std::strerror(error) +
                "; what was written is removed");
}

}  // namespace gyrotwin
