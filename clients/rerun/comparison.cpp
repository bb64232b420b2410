#include "clients/rerun/comparison.hpp"

#include <spdlog/fmt/fmt.h>

#include <sstream>

#include "clients/common/run_name.hpp"
#include "services/schema/lcm_text.hpp"

namespace gyrotwin {

namespace {

// A counterpart comes sooner, or never.
constexpr std::size_t kPatience = 20'000;

/// The parts of an object, one a field.
std::vector<std::string> fields(const LcmType& type, const Comparison::Payload& payload) {
  std::string text;
  append_json(text, type, payload);
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += c == '{' || c == '[';
    depth -= c == '}' || c == ']';
    if (c == ',' && depth == 1) {
      parts.emplace_back();
    } else if (!(depth == 1 && c == '{') && depth > 0) {
      parts.back() += c;
    }
  }
  return parts;
}

}  // namespace

void Comparison::Waiting::keep(const Key& key, const Payload& payload) {
  if (const auto repeated = place_.find(key); repeated != place_.end()) {
    order_.erase(repeated->second);
    place_.erase(repeated);
  }
  place_.emplace(key, order_.emplace(order_.end(), key, payload));
  if (order_.size() <= kPatience) return;
  place_.erase(order_.front().first);
  order_.pop_front();
}

bool Comparison::Waiting::take(const Key& key, Payload& payload) {
  const auto found = place_.find(key);
  if (found == place_.end()) return false;
  payload = std::move(found->second->second);
  order_.erase(found->second);
  place_.erase(found);
  return true;
}

void Comparison::made(Channel channel, std::int64_t epoch, std::int64_t sequence,
                      const Payload& payload) {
  const Key key{channel, epoch, sequence};
  Payload counterpart;
  if (!recorded_.take(key, counterpart)) return made_.keep(key, payload);
  compare(key, counterpart, payload);
}

void Comparison::recorded(Channel channel, std::int64_t epoch, std::int64_t sequence,
                          const Payload& payload) {
  const Key key{channel, epoch, sequence};
  Payload counterpart;
  if (!made_.take(key, counterpart)) return recorded_.keep(key, payload);
  compare(key, payload, counterpart);
}

void Comparison::compare(const Key& key, const Payload& recorded, const Payload& made) {
  ++compared_;
  if (recorded == made) return;
  ++different_;
  if (!first_difference_.empty()) return;
  const auto& [channel, epoch, sequence] = key;
  static const LcmTypes types(lcm_sources());
  const LcmType& type = *types.find(spec(channel).type);
  const auto was = fields(type, recorded), is = fields(type, made);
  std::size_t i = 0;
  while (i + 1 < was.size() && was[i] == is[i]) ++i;
  first_difference_ = fmt::format("{}, sequence {} of run {}: recorded {}, now {}",
                                  spec(channel).suffix, sequence, run_name(epoch), was[i], is[i]);
}

}  // namespace gyrotwin
