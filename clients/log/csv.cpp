#include "clients/log/csv.hpp"

#include <charconv>
#include <cmath>
#include <memory>
#include <string>

#include "clients/log/export_field.hpp"
#include "clients/log/export_file.hpp"

namespace gyrotwin {

namespace {

using Bytes = std::span<const std::uint8_t>;

template <class Number>
void append_digits(std::string& to, Number number) {
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, number);
  to.append(digits, end);
}

/// The fewest digits from which the same number is read.
template <class Real>
void append_real(std::string& to, Real real) {
  if (std::isfinite(real)) return append_digits(to, real);
  to += std::isnan(real) ? "NaN" : real > 0 ? "Inf" : "-Inf";
}

void append_quoted(std::string& to, std::string_view text) {
  to += '"';
  for (const char c : text) to.append(c == '"' ? 2 : 1, c);
  to += '"';
}

void append_number(std::string& to, Bytes payload, const LcmNumber& number) {
  switch (number.primitive) {
    case Primitive::kDouble:
      return append_real(to, number_at(payload, number));
    case Primitive::kFloat:
      return append_real(to, static_cast<float>(number_at(payload, number)));
    default:
      return append_digits(to, integer_at(payload, number));
  }
}

/// The file of one stream.
class Table {
 public:
  Table(std::filesystem::path name, bool overwrite, const LcmType& type)
      : file_(std::move(name), overwrite), fields_(table_fields(type)) {
    row_ = "time_s,received_us";
    for (const TableField& field : fields_) {
      for (const std::string& element : field.elements) row_ += ',' + element;
    }
    end_row();
  }

  void add(const LogMessage& message) {
    append_real(row_, message.seconds);
    row_ += ',';
    append_digits(row_, message.event.time_us);
    for (const TableField& field : fields_) {
      for (std::size_t i = 0; i < field.elements.size(); ++i) {
        row_ += ',';
        if (field.is_text) {
          append_quoted(row_, text_in(field, message.event.data));
        } else {
          append_number(row_, message.event.data, field.number(i));
        }
      }
    }
    end_row();
  }

  std::filesystem::path finish() {
    file_.finish();
    return file_.name();
  }

 private:
  void end_row() {
    file_.write(row_ += "\r\n");
    row_.clear();
  }

  OutputFile file_;
  std::vector<TableField> fields_;
  std::string row_;
};

}  // namespace

std::vector<std::filesystem::path> export_csv(LogScan& scan, const std::filesystem::path& out,
                                              bool overwrite) {
  std::vector<std::unique_ptr<Table>> tables;
  const std::filesystem::path stem = out.extension() == ".csv" ? out.stem() : out.filename();
  scan.read([&](const LogMessage& message) {
    if (message.stream == tables.size()) {
      const std::string name = scan.streams()[message.stream].name;
      tables.push_back(std::make_unique<Table>(
          out.parent_path() / (stem.string() + '.' + name + ".csv"), overwrite, message.type));
    }
    tables[message.stream]->add(message);
  });
  std::vector<std::filesystem::path> files;
  for (const auto& table : tables) files.push_back(table->finish());
  return files;
}

}  // namespace gyrotwin
