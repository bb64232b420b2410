#include "clients/log/catalog.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "messages/big_endian.hpp"
#include "services/runtime/datagram.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kOwn = "gyrotwin/log/";
constexpr std::string_view kAbout = "gyrotwin/log/about";
constexpr std::string_view kType = "gyrotwin/log/type";
constexpr std::string_view kRig = "gyrotwin/log/rig";

constexpr std::size_t kMostTypes = 256;
constexpr std::size_t kSumSize = 17;  // 16 hex digits and a newline

std::string_view text_of(std::span<const std::uint8_t> data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// First line of an opening event: tells whether name and text are what they were.
std::string sum_of(std::string_view channel, std::string_view text) {
  return fmt::format("{:016x}\n",
                     digest(bytes_of(std::string(channel) + '\0' + std::string(text))));
}

std::string about_text(const About& about) {
  Json channels = Json::object();
  for (const auto& [name, channel] : about.channels) {
    channels[name] = {{"type", channel.type},
                      {"fingerprint", fmt::format("{:016x}", channel.fingerprint)},
                      {"size", channel.size}};
  }
  const Json text{{"program", about.program}, {"host", about.host},     {"part", about.part},
                  {"rig", about.rig},         {"prefix", about.prefix}, {"rig_id", about.rig_id},
                  {"key", about.key},         {"channels", channels}};
  return text.dump(2) + "\n";
}

/// Whether an event is one of the log's own whose channel is damaged.
bool is_opening(const LogEvent& event) {
  const std::string_view all = text_of(event.data);
  if (all.size() < kSumSize || all[kSumSize - 1] != '\n') return false;
  return std::ranges::any_of(std::array{kAbout, kType, kRig}, [all](std::string_view channel) {
    return all.starts_with(sum_of(channel, all.substr(kSumSize)));
  });
}

/// @throws nlohmann::json::exception, std::exception where it is not what about_text() writes
About read_about(std::string_view text) {
  const Json json = Json::parse(text);
  About about;
  json.at("program").get_to(about.program);
  json.at("host").get_to(about.host);
  json.at("part").get_to(about.part);
  json.at("rig").get_to(about.rig);
  json.at("prefix").get_to(about.prefix);
  json.at("rig_id").get_to(about.rig_id);
  json.at("key").get_to(about.key);
  for (const auto& [name, channel] : json.at("channels").items()) {
    about.channels[name] = {
        .type = channel.at("type"),
        .fingerprint = std::stoull(std::string(channel.at("fingerprint")), nullptr, 16),
        .size = channel.at("size")};
  }
  return about;
}

/// "// state_t, fingerprint ..., 304 bytes", which keeps the text what it is: an .lcm file.
std::string title(const LcmType& type) {
  return fmt::format("// {}, fingerprint {:016x}, {} bytes\n", type.name, type.fingerprint,
                     type.payload_size());
}

}  // namespace

bool is_log_channel(std::string_view channel) { return channel.starts_with(kOwn); }

std::string_view opening_text(const LogEvent& event) {
  return text_of(event.data.subspan(kSumSize));
}

std::map<std::string, LoggedChannel, std::less<>> channels_of(const std::string& prefix) {
  const LcmTypes types(lcm_sources());
  std::map<std::string, LoggedChannel, std::less<>> channels;
  for (const ChannelSpec& row : kChannels) {
    const LcmType& type = *types.find(row.type);
    channels[prefix + "/" + std::string(row.suffix)] = {type.name, type.fingerprint,
                                                        type.payload_size()};
  }
  return channels;
}

LogBytes opening_events(const About& about, std::span<const std::string> sources,
                        std::string_view rig_file, std::int64_t time_us) {
  LogBytes events;
  const auto add = [&](std::string_view channel, std::string_view text) {
    const std::string data = sum_of(channel, text) + std::string(text);
    append_event(events, {.time_us = time_us, .channel = channel, .data = bytes_of(data)});
  };
  add(kAbout, about_text(about));
  const LcmTypes types(sources);
  for (const std::string& source : sources) {
    add(kType, title(*types.find(parse_lcm(source).front().name)) + source);
  }
  add(kRig, rig_file);
  return events;
}

Catalog::Catalog(FindKey find_key)
    : find_key_(std::move(find_key)),
      sources_(lcm_sources().begin(), lcm_sources().end()),
      types_(sources_) {}

bool Catalog::take(const LogEvent& event) {
  const std::string_view text = opening_text(event);
  if (event.channel == kRig) rig_file_ = text;
  if (event.channel == kType) return take_type(text);
  if (event.channel != kAbout) return true;
  try {
    about_ = read_about(text);
  } catch (const std::exception&) {
    return false;
  }
  key_ = about_->key.empty() ? std::nullopt : find_key_(*about_);
  // A key made anew since cannot tell right from wrong here.
  if (key_ && fingerprint(*key_) != about_->key) key_.reset();
  return true;
}

bool Catalog::take_type(std::string_view text) {
  const auto is_title_of = [text](const LcmType& type) {
    return text.starts_with("// " + type.name) && text.starts_with(title(type));
  };
  if (types_.find_if(is_title_of) != nullptr) return true;  // known as it is
  if (sources_.size() >= kMostTypes) return false;          // all are read anew for each
  sources_.emplace_back(text);
  try {
    LcmTypes types(sources_);
    // Whoever reads the text otherwise than lcm-gen does should not decode by it.
    if (types.find_if(is_title_of) != nullptr) {
      types_ = std::move(types);
      return true;
    }
  } catch (const Error&) {
  }
  sources_.pop_back();
  return false;
}

const LcmType* Catalog::type_of(const LogEvent& event) const {
  if (event.data.size() < sizeof(LcmType::fingerprint)) return nullptr;
  const LcmType* type = types_.find(big_endian<std::uint64_t>(event.data, 0));
  return type != nullptr && type->payload_size() == event.data.size() ? type : nullptr;
}

Soundness Catalog::examine(const LogEvent& event) const {
  if (is_log_channel(event.channel)) {
    const std::string_view all = text_of(event.data);
    if (all.size() < kSumSize) return Soundness::kWrongShape;
    return all.starts_with(sum_of(event.channel, all.substr(kSumSize))) ? Soundness::kAuthentic
                                                                        : Soundness::kWrongShape;
  }
  if (about_) {
    const auto channel = about_->channels.find(event.channel);
    if (channel != about_->channels.end()) return examine_rig_message(event, channel->second);
  }
  if (event.data.size() < sizeof(LcmType::fingerprint)) return Soundness::kUnknown;
  const LcmType* type = types_.find(big_endian<std::uint64_t>(event.data, 0));
  if (type == nullptr) return is_opening(event) ? Soundness::kWrongShape : Soundness::kUnknown;
  if (type->payload_size() != event.data.size()) return Soundness::kWrongShape;
  // The rig's messages are on its channels: here the name is damaged.
  return about_ && is_of_rig(event, *type) ? Soundness::kWrongShape : Soundness::kRightShape;
}

Soundness Catalog::examine_rig_message(const LogEvent& event, const LoggedChannel& channel) const {
  if (event.data.size() != channel.size || event.data.size() < sizeof(LcmType::fingerprint) ||
      big_endian<std::uint64_t>(event.data, 0) != channel.fingerprint) {
    return Soundness::kWrongShape;
  }
  const LcmType* type = type_of(event);
  if (type != nullptr && !is_of_rig(event, *type)) return Soundness::kWrongShape;
  if (!key_) return Soundness::kRightShape;
  return signed_with(*key_, event.channel, event.data) ? Soundness::kAuthentic
                                                       : Soundness::kWrongSignature;
}

bool Catalog::is_of_rig(const LogEvent& event, const LcmType& type) const {
  const auto rig_id = locate(type, "header.rig_id");
  return !rig_id || integer_at(event.data, *rig_id) == about_->rig_id;
}

}  // namespace gyrotwin
