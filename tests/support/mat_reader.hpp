// A reader of MAT 5 files, written from "MAT-File Format" (The MathWorks): what exports hold, no
// more. Link ZLIB.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace gyrotwin::support {

/// A matrix, a text, a struct of one element or a column of cells.
struct MatValue {
  std::string name;
  std::size_t rows = 0, columns = 0;
  std::vector<double> numbers;         ///< column after column
  std::vector<std::int64_t> integers;  ///< likewise, of an int64 matrix
  std::string text;
  std::map<std::string, MatValue> fields;
  std::vector<MatValue> cells;
};

class MatReader {
 public:
  explicit MatReader(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)) {}

  /// Variables by their names.
  std::map<std::string, MatValue> file() {
    std::map<std::string, MatValue> all;
    if (number<std::uint16_t>(124) != 0x0100 || number<std::uint16_t>(126) != 0x4D49) {
      throw std::runtime_error("no MAT 5 file of this byte order");
    }
    at_ = 128;
    while (at_ < bytes_.size()) {
      const Tag tag = next_tag();
      MatValue value;
      if (tag.kind == kCompressed) {
        value = MatReader(inflated(tag)).element();
      } else {
        at_ = tag.begin - 8;
        value = element();
      }
      at_ = tag.begin + tag.size;
      all[value.name] = value;
    }
    return all;
  }

 private:
  static constexpr std::uint32_t kDouble = 9, kInt64 = 12, kMatrix = 14, kCompressed = 15;
  static constexpr std::uint8_t kCellClass = 1, kStructClass = 2, kCharClass = 4, kDoubleClass = 6,
                                kInt64Class = 14;
  struct Tag {
    std::uint32_t kind;
    std::size_t size, begin;  // of the data
  };

  template <class Number>
  Number number(std::size_t at) const {
    if (at + sizeof(Number) > bytes_.size()) throw std::runtime_error("cut");
    Number value;
    std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }

  /// Small elements have tag and data in 8 bytes; others are padded to 8.
  Tag next_tag() {
    const auto word = number<std::uint32_t>(at_);
    if (word >> 16 != 0) {
      const Tag tag{word & 0xFFFF, word >> 16, at_ + 4};
      at_ += 8;
      return tag;
    }
    const Tag tag{word, number<std::uint32_t>(at_ + 4), at_ + 8};
    if (tag.begin + tag.size > bytes_.size()) throw std::runtime_error("cut");
    at_ = tag.begin + (tag.size + 7) / 8 * 8;
    return tag;
  }

  std::string text_of(const Tag& tag) const {
    return {reinterpret_cast<const char*>(bytes_.data()) + tag.begin, tag.size};
  }

  std::vector<std::uint8_t> inflated(const Tag& tag) const {
    std::vector<std::uint8_t> out(1 << 16);
    z_stream stream{};
    inflateInit(&stream);
    stream.next_in = const_cast<std::uint8_t*>(bytes_.data() + tag.begin);
    stream.avail_in = static_cast<unsigned>(tag.size);
    int result = Z_OK;
    while (result == Z_OK) {
      if (stream.total_out == out.size()) out.resize(2 * out.size());
      stream.next_out = out.data() + stream.total_out;
      stream.avail_out = static_cast<unsigned>(out.size() - stream.total_out);
      result = inflate(&stream, Z_NO_FLUSH);
    }
    out.resize(stream.total_out);
    inflateEnd(&stream);
    if (result != Z_STREAM_END) throw std::runtime_error("not inflated");
    return out;
  }

  template <class Number>
  std::vector<Number> numbers_of(const Tag& tag, std::uint32_t kind) const {
    if (tag.kind != kind) throw std::runtime_error("numbers of another kind");
    std::vector<Number> numbers(tag.size / sizeof(Number));
    std::memcpy(numbers.data(), bytes_.data() + tag.begin, tag.size);
    return numbers;
  }

  MatValue element() {
    if (next_tag_is_not(kMatrix)) throw std::runtime_error("no matrix");
    const std::size_t end = end_;
    MatValue value;
    if (at_ == end) return value;
    const Tag flags = next_tag();
    const auto kind = number<std::uint8_t>(flags.begin);
    const Tag dimensions = next_tag();
    value.rows = number<std::uint32_t>(dimensions.begin);
    value.columns = number<std::uint32_t>(dimensions.begin + 4);
    value.name = text_of(next_tag());
    switch (kind) {
      case kStructClass: {
        const auto width = number<std::uint32_t>(next_tag().begin);
        const std::string names = text_of(next_tag());
        for (std::size_t i = 0; i < names.size(); i += width) {
          value.fields[names.substr(i, width).c_str()] = element();
        }
        break;
      }
      case kCellClass:
        while (value.cells.size() < value.rows * value.columns) value.cells.push_back(element());
        break;
      case kCharClass:
        value.text = text_of(next_tag());
        break;
      case kDoubleClass:
        value.numbers = numbers_of<double>(next_tag(), kDouble);
        break;
      case kInt64Class:
        value.integers = numbers_of<std::int64_t>(next_tag(), kInt64);
        break;
      default:
        throw std::runtime_error("an array of another class");
    }
    at_ = end;
    return value;
  }

  /// Enters the data of the next element.
  bool next_tag_is_not(std::uint32_t kind) {
    const Tag tag = next_tag();
    end_ = at_;
    at_ = tag.begin;
    return tag.kind != kind;
  }

  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0, end_ = 0;
};

inline std::map<std::string, MatValue> read_mat(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return MatReader({std::istreambuf_iterator<char>(file), {}}).file();
}

}  // namespace gyrotwin::support
