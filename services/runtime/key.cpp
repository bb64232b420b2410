#include "services/runtime/key.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "messages/big_endian.hpp"
#include "services/runtime/descriptor.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

constexpr std::size_t kHexDigits = 2 * std::tuple_size_v<Key>;

std::string reason() { return std::strerror(errno); }

/// Value of an environment variable; empty when unset.
std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// The command that makes the key of `path`.
std::string make_it(const std::filesystem::path& path) {
  return "`gyrotwin key new --rig " + path.stem().string() + "`";
}

void refuse_if_exposed(int file, const std::filesystem::path& path) {
  struct stat status {};
  if (fstat(file, &status) != 0) throw Error(path.string() + ": " + reason());
  if (!S_ISREG(status.st_mode)) throw Error(path.string() + ": expected a regular file");
  // Of what systemd hands over the group's bits may be the mask of an access list with one user.
  const std::string credentials = environment("CREDENTIALS_DIRECTORY");
  const bool credential = !credentials.empty() && path.parent_path() == credentials;
  if ((status.st_mode & (credential ? S_IRWXO : S_IRWXG | S_IRWXO)) != 0) {
    throw Error(path.string() + ": others than its owner have access to this key; if nobody " +
                "copied it: `chmod 600 " + path.string() + "`, otherwise remove it and " +
                make_it(path));
  }
}

}  // namespace

std::filesystem::path key_path(std::string_view rig_name) {
  const std::string file = std::string(rig_name) + ".key";
  if (const std::string keys = environment("GYROTWIN_KEYS"); !keys.empty()) {
    return std::filesystem::path(keys) / file;
  }
  if (const std::string config = environment("XDG_CONFIG_HOME"); !config.empty()) {
    return std::filesystem::path(config) / "gyrotwin" / file;
  }
  if (const std::string home = environment("HOME"); !home.empty()) {
    return std::filesystem::path(home) / ".config" / "gyrotwin" / file;
  }
  throw Error("no place for keys: HOME is not set; set GYROTWIN_KEYS to the folder of the keys");
}

Key load_key(const std::filesystem::path& path) {
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.valid()) {
    const int error = errno;
    const std::string found = path.string() + ": no key to read: " + reason();
    throw Error(error == ENOENT ? found + "; make one with " + make_it(path) : found);
  }
  refuse_if_exposed(file.get(), path);

  // One byte more than a key has, so that a longer file is seen.
  std::array<char, kHexDigits + 2> text{};
  const ssize_t size = read(file.get(), text.data(), text.size());
  Key key{};
  std::size_t key_size = 0;
  const char* end = nullptr;
  const bool good = size == static_cast<ssize_t>(kHexDigits) + 1 && text[kHexDigits] == '\n' &&
                    sodium_hex2bin(key.data(), key.size(), text.data(), kHexDigits, nullptr,
                                   &key_size, &end) == 0 &&
                    key_size == key.size() && end == text.data() + kHexDigits;
  sodium_memzero(text.data(), text.size());
  if (!good) {
    throw Error(path.string() + ": expected 64 hex digits and a newline; remove it and " +
                make_it(path));
  }
  return key;
}

void create_key(const std::filesystem::path& path) {
  if (sodium_init() < 0) throw Error("libsodium does not start: no source of randomness");
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  std::error_code error;
  std::filesystem::create_directories(folder.parent_path(), error);
  if (mkdir(folder.c_str(), S_IRWXU) != 0 && errno != EEXIST) {
    throw Error(folder.string() + ": cannot make the folder of the key: " + reason());
  }

  const Descriptor file(
      open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.valid()) {
    if (errno != EEXIST) throw Error(path.string() + ": cannot write the key: " + reason());
    throw Error(path.string() + ": exists already and is kept; whoever uses it could no longer " +
                "be heard. To replace it, remove it first and give the new one to every host");
  }

  Key key;
  randombytes_buf(key.data(), key.size());
  std::array<char, kHexDigits + 1> text;
  sodium_bin2hex(text.data(), text.size(), key.data(), key.size());
  text[kHexDigits] = '\n';
  const bool written =
      write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      fsync(file.get()) == 0;
  const std::string why = reason();
  sodium_memzero(key.data(), key.size());
  sodium_memzero(text.data(), text.size());
  if (!written) {
    unlink(path.c_str());
    throw Error(path.string() + ": cannot write the key: " + why);
  }
}

std::string fingerprint(const Key& key) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(digest(key)));
  std::string text = digits;
  for (const std::size_t at : {12, 8, 4}) text.insert(at, 1, '-');
  return text;
}

std::uint64_t digest(std::span<const std::uint8_t> bytes) noexcept {
  std::array<std::uint8_t, crypto_generichash_BYTES> hash;
  crypto_generichash(hash.data(), hash.size(), bytes.data(), bytes.size(), nullptr, 0);
  return big_endian<std::uint64_t>(hash, 0);
}

std::int64_t random_id() noexcept {
  // Before sodium_init only the first draw of a process is not thread-safe; a second call is cheap.
  if (sodium_init() < 0) std::abort();
  std::uint64_t bits = 0;
  randombytes_buf(&bits, sizeof bits);
  return static_cast<std::int64_t>(bits >> 1);
}

}  // namespace gyrotwin
