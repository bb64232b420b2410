// Types as a log tells them, any text; and messages of those types, any bytes, as JSON and as ROS 2
// has them. The input: .lcm text, NUL, JSON of a message of its last type, NUL, bytes of one.
#include <string>
#include <vector>

#include "services/runtime/error.hpp"
#include "services/schema/lcm_json.hpp"
#include "services/schema/lcm_text.hpp"
#include "services/schema/lcm_type.hpp"
#include "services/schema/ros2_message.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace gyrotwin {
namespace {

using fuzz::Bytes;
using fuzz::require;
using nlohmann::json;

constexpr std::size_t kLargest = 4096;  // of a type whose messages are tried [byte]

/// Everything that is made of one message.
void show(const LcmType& type, const std::vector<std::uint8_t>& payload) {
  std::string text;
  append_json(text, type, payload);
  const json shown = json::parse(text, nullptr, false);
  require(shown.is_object());
  std::string line;
  append_short(line, type, payload);
  for (const LcmField& field : type.fields) {
    require(field.offset + field.element_size() * field.count() <= type.size);
    text_at(type, payload, field.name);
    if (const auto number = locate(type, field.name)) number_at(payload, *number);
  }
  std::vector<std::uint8_t> cdr;
  const Ros2Message message(type);
  message.encode(payload, cdr);
  require(cdr.size() >= 4);
}

void write(const LcmType& type, std::string_view text) {
  try {
    const auto payload = payload_from_json(type, json::parse(text));
    require(payload.size() == type.payload_size());
    show(type, payload);
  } catch (const json::exception&) {
  } catch (const Error&) {
  }
}

void read(Bytes bytes) {
  const std::vector<std::string> sources{std::string(fuzz::text_of(fuzz::cut(bytes, 0)))};
  try {
    const LcmTypes types(sources);
    const auto structs = parse_lcm(sources[0]);
    if (structs.empty()) return;
    const LcmType* type = types.find(structs.back().name);
    if (type == nullptr) return;
    require(types.find(type->fingerprint) != nullptr);
    if (type->payload_size() > kLargest) return;
    write(*type, fuzz::text_of(fuzz::cut(bytes, 0)));
    std::vector<std::uint8_t> payload(bytes.begin(), bytes.end());
    payload.resize(type->payload_size());
    show(*type, payload);
  } catch (const Error& error) {
    require(!std::string_view(error.what()).empty());
  }
}

}  // namespace
}  // namespace gyrotwin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gyrotwin::read({data, size});
  return 0;
}
