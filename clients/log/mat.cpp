#include "clients/log/mat.hpp"

#include <matio.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clients/log/export_field.hpp"
#include "clients/log/export_file.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kLargest = (std::size_t{1} << 31) - 1;  // of a variable [byte]
constexpr std::size_t kLongestName = 63;                      // of a field
constexpr std::size_t kCell = 56;                             // of a text, beside it [byte]

struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

Variable created(matvar_t* variable) {
  if (variable == nullptr) throw std::bad_alloc();
  return Variable(variable);
}

/// A matrix of these numbers, doubles or int64, which outlive it.
Variable matrix(bool is_int64, std::size_t rows, std::size_t columns, void* numbers) {
  std::array<std::size_t, 2> size{rows, columns};
  return created(Mat_VarCreate(nullptr, is_int64 ? MAT_C_INT64 : MAT_C_DOUBLE,
                               is_int64 ? MAT_T_INT64 : MAT_T_DOUBLE, 2, size.data(), numbers,
                               MAT_F_DONT_COPY_DATA));
}

Variable text(std::string value) {
  std::array<std::size_t, 2> size{value.empty() ? std::size_t{0} : 1, value.size()};
  return created(Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, size.data(), value.data(), 0));
}

/// A struct of one element.
Variable structure(const std::string& name, const std::vector<std::string>& fields,
                   std::vector<Variable> values) {
  std::vector<const char*> names;
  for (const std::string& field : fields) names.push_back(field.c_str());
  std::array<std::size_t, 2> one{1, 1};
  Variable made = created(Mat_VarCreateStruct(name.c_str(), 2, one.data(), names.data(),
                                              static_cast<unsigned>(names.size())));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Mat_VarSetStructFieldByIndex(made.get(), i, 0, values[i].release());
  }
  return made;
}

/// "header_tick" for "header.tick".
std::string matlab_name(std::string_view field) {
  std::string name(field.substr(0, kLongestName));
  std::ranges::replace_if(
      name, [](char c) { return c == '.' || c == '[' || c == ']'; }, '_');
  return name;
}

/// One field of a stream: numbers, a matrix column an element; or texts.
class Column {
 public:
  Column(TableField field, std::size_t rows) : field_(std::move(field)), rows_(rows) {
    if (field_.is_text) {
      texts_.reserve(rows_ * (field_.size + 1));
    } else {
      numbers_ = std::make_unique_for_overwrite<std::uint64_t[]>(rows_ * field_.elements.size());
    }
  }

  void set(std::size_t row, Bytes payload) {
    if (field_.is_text) {
      texts_ += text_in(field_, payload) + '\0';
      return;
    }
    for (std::size_t i = 0; i < field_.elements.size(); ++i) {
      const LcmNumber number = field_.number(i);
      numbers_[i * rows_ + row] = is_int64()
                                      ? std::bit_cast<std::uint64_t>(integer_at(payload, number))
                                      : std::bit_cast<std::uint64_t>(number_at(payload, number));
    }
  }

  /// Lives on this column's numbers.
  Variable variable() {
    return field_.is_text ? cells()
                          : matrix(is_int64(), rows_, field_.elements.size(), numbers_.get());
  }

  const TableField& field() const { return field_; }

 private:
  bool is_int64() const { return field_.primitive == Primitive::kInt64; }

  Variable cells() const {
    std::array<std::size_t, 2> size{rows_, 1};
    Variable column =
        created(Mat_VarCreate(nullptr, MAT_C_CELL, MAT_T_CELL, 2, size.data(), nullptr, 0));
    std::size_t at = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
      const std::size_t end = texts_.find('\0', at);
      Mat_VarSetCell(column.get(), static_cast<int>(row),
                     text(texts_.substr(at, end - at)).release());
      at = end + 1;
    }
    return column;
  }

  TableField field_;
  std::size_t rows_;
  std::unique_ptr<std::uint64_t[]> numbers_;
  std::string texts_;  // each with a NUL behind it
};

/// The struct of one stream, filled row by row.
class Table {
 public:
  Table(const LogStream& stream, const LcmType& type)
      : name_(stream.name), seconds_(rows_of(stream)), received_us_(rows_of(stream)) {
    for (TableField& field : table_fields(type)) {
      columns_.emplace_back(std::move(field), rows_of(stream));
    }
  }

  static std::size_t rows_of(const LogStream& stream) {
    return static_cast<std::size_t>(stream.messages);
  }

  /// Bytes in the file, before they are compressed.
  static std::size_t size(const LogStream& stream, const std::vector<TableField>& fields) {
    std::size_t row = 2 * sizeof(double);
    for (const TableField& field : fields) {
      row += field.is_text ? kCell + field.size : sizeof(double) * field.elements.size();
    }
    return rows_of(stream) * row;
  }

  void add(const LogMessage& message) {
    if (row_ == seconds_.size()) return;  // what a log that grows has got since it was counted
    seconds_[row_] = message.seconds;
    received_us_[row_] = message.event.time_us;
    for (Column& column : columns_) column.set(row_, message.event.data);
    ++row_;
  }

  const std::string& name() const { return name_; }

  /// Lives on this table's numbers.
  Variable variable() {
    std::vector<std::string> names{"time_s", "received_us"};
    std::vector<Variable> values, units;
    values.push_back(matrix(false, row_, 1, seconds_.data()));
    values.push_back(matrix(true, row_, 1, received_us_.data()));
    units.push_back(text("s"));
    units.push_back(text("us"));
    for (Column& column : columns_) {
      names.push_back(matlab_name(column.field().name));
      values.push_back(column.variable());
      units.push_back(text(column.field().unit));
    }
    values.push_back(structure("units", names, std::move(units)));
    names.emplace_back("units");
    return structure(name_, names, std::move(values));
  }

 private:
  std::string name_;
  std::vector<double> seconds_;
  std::vector<std::int64_t> received_us_;
  std::vector<Column> columns_;
  std::size_t row_ = 0;
};

/// How many messages each stream has. @throws NotDone when one is too many for the format
void count(LogScan& scan, const std::filesystem::path& out) {
  std::vector<std::vector<TableField>> fields;
  scan.read([&](const LogMessage& message) {
    if (message.stream == fields.size()) fields.push_back(table_fields(message.type));
  });
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const LogStream& stream = scan.streams()[i];
    const std::size_t size = Table::size(stream, fields[i]);
    if (size <= kLargest) continue;
    throw NotDone(fmt::format(
        "{}: {} would take {:.1f} GB, and a struct in a MAT 5 file holds 2 GB: take less by "
        "--channel, --from, --to or --every; or a .mcap, which has no such limit",
        out.string(), stream.name, 1e-9 * static_cast<double>(size)));
  }
}

/// libmatio does not tell of a disk that is full: here the lengths in the file are followed to its
/// end.
bool is_whole(const std::filesystem::path& path, std::size_t variables) {
  constexpr std::uintmax_t kHeader = 128, kTag = 8;
  std::ifstream file(path, std::ios::binary);
  std::uintmax_t at = kHeader;
  for (; variables > 0; --variables) {
    std::array<std::uint32_t, 2> tag{};  // kind, length; in the byte order of this machine
    file.seekg(static_cast<std::streamoff>(at));
    if (!file.read(reinterpret_cast<char*>(tag.data()), kTag)) return false;
    at += kTag + tag[1];
  }
  return at == std::filesystem::file_size(path);
}

/// Where libmatio writes to.
class MatFile {
 public:
  explicit MatFile(std::filesystem::path path) : path_(std::move(path)) {
    const std::string title = "MATLAB 5.0 MAT-file, written by gyrotwin-log " GYROTWIN_VERSION;
    file_ = Mat_CreateVer(path_.c_str(), title.c_str(), MAT_FT_MAT5);
    if (file_ == nullptr) {
      throw Error(path_.string() + ": cannot be made; give a file in a folder that exists");
    }
  }
  MatFile(const MatFile&) = delete;
  MatFile& operator=(const MatFile&) = delete;
  ~MatFile() {
    if (file_ != nullptr) Mat_Close(file_);
  }

  void write(matvar_t* variable, bool compress) {
    good_ &=
        Mat_VarWrite(file_, variable, compress ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE) == 0;
    ++variables_;
  }
  /// @return whether all of it is in the file
  bool close() {
    good_ &= Mat_Close(std::exchange(file_, nullptr)) == 0;
    return good_ && is_whole(path_, variables_);
  }

 private:
  std::filesystem::path path_;
  mat_t* file_;
  std::size_t variables_ = 0;
  bool good_ = true;
};

}  // namespace

void export_mat(LogScan& scan, const std::filesystem::path& out, bool overwrite, bool compress) {
  PartFile part(out, overwrite);
  MatFile file(part.part());
  count(scan, out);
  const std::vector<LogStream> counted = scan.streams();
  std::vector<std::unique_ptr<Table>> tables(counted.size());
  scan.read([&](const LogMessage& message) {
    if (message.stream >= counted.size()) return;
    auto& table = tables[message.stream];
    if (!table) table = std::make_unique<Table>(counted[message.stream], message.type);
    table->add(message);
  });
  for (auto& table : tables) {
    if (!table) continue;  // a log that has been cut since it was counted
    scan.show(out.string() + ": writing " + table->name());
    file.write(table->variable().get(), compress);
    table.reset();
  }
  if (!file.close()) {
    throw NotDone(out.string() +
                  ": cannot be written whole, the disk is likely full; what was "
                  "written is removed");
  }
  part.keep();
}

}  // namespace gyrotwin
