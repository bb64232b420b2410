#include "clients/log/log_line.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "services/schema/lcm_text.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kShownOfUnknown = 32;  // [byte]

}  // namespace

std::string short_line(const Catalog& catalog, const LogEvent& event, double seconds) {
  if (is_log_channel(event.channel)) {
    return std::string(opening_text(event));
  }
  std::string line = fmt::format("{:12.6f}  {}", seconds, event.channel);
  if (const LcmType* type = catalog.type_of(event)) {
    append_short(line, *type, event.data);
    return line;
  }
  line += fmt::format(" {} bytes ", event.data.size());
  append_hex(line, event.data.first(std::min(event.data.size(), kShownOfUnknown)));
  if (event.data.size() > kShownOfUnknown) line += "...";
  return line;
}

std::string json_line(const Catalog& catalog, const LogEvent& event, double seconds) {
  std::string line =
      fmt::format(R"({{"time_us":{},"seconds":{:.6f},"channel":)", event.time_us, seconds);
  append_json_string(line, event.channel);
  if (is_log_channel(event.channel)) {
    line += R"(,"text":)";
    append_json_string(line, opening_text(event));
  } else if (const LcmType* type = catalog.type_of(event)) {
    line += R"(,"type":)";
    append_json_string(line, type->name);
    line += R"(,"message":)";
    append_json(line, *type, event.data);
  } else {
    line += R"(,"data":")";
    append_hex(line, event.data);
    line += '"';
  }
  return line += '}';
}

}  // namespace gyrotwin
