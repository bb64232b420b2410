#include "clients/log/export_field.hpp"

#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

/// "[N m] or [V] per drive" has the unit "N m or V".
std::string unit_of(std::string_view comment) {
  std::string unit;
  while (comment.starts_with('[')) {
    const std::size_t end = comment.find(']');
    if (end == std::string_view::npos) break;
    unit += (unit.empty() ? "" : " or ") + std::string(comment.substr(1, end - 1));
    comment.remove_prefix(end + 1);
    if (!comment.starts_with(" or ")) break;
    comment.remove_prefix(4);
  }
  return unit;
}

/// "[0][1]" for the second element of a 2 x 2 array.
std::string index_text(const std::vector<std::size_t>& dimensions, std::size_t element) {
  std::string text;
  for (std::size_t k = dimensions.size(); k-- > 0;) {
    text.insert(0, '[' + std::to_string(element % dimensions[k]) + ']');
    element /= dimensions[k];
  }
  return text;
}

void append_fields(const LcmType& type, const std::string& prefix, std::size_t offset,
                   std::vector<TableField>& to) {
  for (const LcmField& field : type.fields) {
    const std::string name = prefix + field.name;
    const std::size_t begin = offset + field.offset;
    if (field.type != nullptr) {
      for (std::size_t i = 0; i < field.count(); ++i) {
        append_fields(*field.type, name + index_text(field.dimensions, i) + '.',
                      begin + i * field.element_size(), to);
      }
      continue;
    }
    const bool is_bytes = field.primitive == Primitive::kByte && !field.dimensions.empty();
    if (is_bytes && !field.is_text) continue;
    TableField column{.name = name,
                      .unit = field.is_text ? "" : unit_of(field.comment),
                      .elements = {},
                      .offset = begin,
                      .size = field.element_size() * (field.is_text ? field.count() : 1),
                      .primitive = field.primitive,
                      .is_text = field.is_text};
    const std::size_t count = field.is_text ? 1 : field.count();
    for (std::size_t i = 0; i < count; ++i) {
      column.elements.push_back(field.is_text ? name : name + index_text(field.dimensions, i));
    }
    to.push_back(std::move(column));
  }
}

}  // namespace

std::vector<TableField> table_fields(const LcmType& type) {
  std::vector<TableField> fields;
  append_fields(type, "", sizeof type.fingerprint, fields);
  return fields;
}

std::string text_in(const TableField& field, std::span<const std::uint8_t> payload) {
  return get_text(payload.subspan(field.offset, field.size));
}

}  // namespace gyrotwin
