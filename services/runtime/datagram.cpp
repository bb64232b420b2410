#include "services/runtime/datagram.hpp"

#include <sodium.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "messages/big_endian.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

constexpr std::uint32_t kShortMagic = 0x4c433032;     // "LC02"
constexpr std::uint32_t kFragmentMagic = 0x4c433033;  // "LC03"
constexpr std::size_t kPrologue = 8;                  // magic and packet number

// In a payload: the fingerprint, then header_t. tests/protocol holds these to the generated code.
constexpr std::size_t kRigIdAt = 8;
constexpr std::size_t kEpochAt = 16;
constexpr std::size_t kSequenceAt = 24;

/// BLAKE2b-256, keyed.
void hash(std::uint8_t* mac, std::span<const std::uint8_t> bytes, const Key& key) noexcept {
  crypto_generichash(mac, kMacSize, bytes.data(), bytes.size(), key.data(), key.size());
}

void check_prefix(const std::string& prefix) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_/";
  const auto longest =
      std::ranges::max(kChannels, {}, [](const auto& s) { return s.suffix.size(); });
  const std::size_t room = kMaxChannelName - 1 - longest.suffix.size();
  if (prefix.empty() || prefix.size() > room ||
      prefix.find_first_not_of(alphabet) != std::string::npos) {
    throw Error("network.prefix is `" + prefix + "`; expected 1 to " + std::to_string(room) +
                " characters of [A-Z0-9_/], e.g. \"PROTOTYPE_B\"");
  }
}

}  // namespace

void Refusals::count(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kGood:
      break;
    case Verdict::kMalformed:
      ++malformed;
      break;
    case Verdict::kForeign:
      ++foreign;
      break;
    case Verdict::kOtherRig:
      ++other_rig;
      break;
    case Verdict::kUnauthentic:
      ++unauthentic;
      break;
  }
}

bool signed_with(const Key& key, std::string_view channel,
                 std::span<const std::uint8_t> payload) noexcept {
  if (payload.size() < kMacSize) return false;
  const auto content = payload.first(payload.size() - kMacSize);
  crypto_generichash_state state;
  crypto_generichash_init(&state, key.data(), key.size(), kMacSize);
  crypto_generichash_update(&state, reinterpret_cast<const std::uint8_t*>(channel.data()),
                            channel.size());
  crypto_generichash_update(&state, reinterpret_cast<const std::uint8_t*>(""), 1);  // the NUL
  crypto_generichash_update(&state, content.data(), content.size());
  std::array<std::uint8_t, kMacSize> expected;
  crypto_generichash_final(&state, expected.data(), expected.size());
  return sodium_memcmp(expected.data(), payload.last<kMacSize>().data(), kMacSize) == 0;
}

DatagramFormat::DatagramFormat(const std::string& prefix, std::int32_t rig_id,
                               const std::optional<Key>& key)
    : rig_id_(rig_id), key_(key) {
  if (sodium_init() < 0) throw Error("libsodium does not start: no source of randomness");
  check_prefix(prefix);
  for (const ChannelSpec& row : kChannels) {
    names_[static_cast<std::size_t>(row.channel)] = prefix + "/" + std::string(row.suffix);
  }
  const std::array fingerprints{state_t::getHash(),  command_t::getHash(),  request_t::getHash(),
                                reply_t::getHash(),  truth_t::getHash(),    status_t::getHash(),
                                status_t::getHash(), sensors_t::getHash(),  status_t::getHash(),
                                link_t::getHash(),   status_t::getHash(),   state_t::getHash(),
                                health_t::getHash(), forecast_t::getHash(), status_t::getHash()};
  static_assert(fingerprints.size() == kChannels.size());
  std::ranges::copy(fingerprints, fingerprints_.begin());
}

Parsed DatagramFormat::parse(std::span<const std::uint8_t> datagram) const noexcept {
  if (datagram.size() < kPrologue) return {Verdict::kMalformed};
  const auto magic = big_endian<std::uint32_t>(datagram, 0);
  if (magic == kFragmentMagic) return {Verdict::kForeign};
  if (magic != kShortMagic) return {Verdict::kMalformed};

  // The name ends with a NUL, and liblcm knows none longer than 63 characters.
  const auto rest = datagram.subspan(kPrologue);
  const std::string_view text(reinterpret_cast<const char*>(rest.data()), rest.size());
  const std::string_view channel = text.substr(0, text.find('\0'));
  if (channel.size() == text.size() || channel.empty() || channel.size() > kMaxChannelName) {
    return {Verdict::kMalformed};
  }
  const auto name = std::ranges::find(names_, channel);
  const auto payload = rest.subspan(channel.size() + 1);
  if (name == names_.end()) {
    return {.verdict = Verdict::kForeign, .payload = payload, .name = channel};
  }

  // From here on it claims to be ours: the right type in every byte that says so.
  const auto index = static_cast<std::size_t>(name - names_.begin());
  if (payload.size() != kChannels[index].size) return {Verdict::kMalformed};
  if (big_endian<std::uint64_t>(payload, 0) != fingerprints_[index]) {
    return {Verdict::kMalformed};
  }
  if (static_cast<std::int32_t>(big_endian<std::uint32_t>(payload, kRigIdAt)) != rig_id_) {
    return {Verdict::kOtherRig};
  }
  const auto epoch = static_cast<std::int64_t>(big_endian<std::uint64_t>(payload, kEpochAt));
  const auto sequence = static_cast<std::int64_t>(big_endian<std::uint64_t>(payload, kSequenceAt));
  if (epoch < 0 || sequence < 0) return {Verdict::kMalformed};
  if (!authentic(datagram)) return {Verdict::kUnauthentic};
  return {Verdict::kGood, kChannels[index].channel, epoch, sequence, payload, channel};
}

std::size_t DatagramFormat::begin(Frame& frame, Channel channel,
                                  std::uint32_t packet_number) const noexcept {
  return begin(frame, names_[static_cast<std::size_t>(channel)], packet_number);
}

std::size_t DatagramFormat::begin(Frame& frame, std::string_view channel,
                                  std::uint32_t packet_number) noexcept {
  put_big_endian(kShortMagic, frame.data());
  put_big_endian(packet_number, frame.data() + 4);
  std::memcpy(frame.data() + kPrologue, channel.data(), channel.size());
  frame[kPrologue + channel.size()] = 0;
  return kPrologue + channel.size() + 1;
}

void DatagramFormat::sign(Frame& frame, std::size_t size) const noexcept {
  std::uint8_t* mac = frame.data() + size - kMacSize;
  if (key_) {
    hash(mac, {frame.data() + kPrologue, mac}, *key_);
  } else {
    std::fill_n(mac, kMacSize, std::uint8_t{0});
  }
}

bool DatagramFormat::authentic(std::span<const std::uint8_t> datagram) const noexcept {
  if (!key_) return true;
  const auto mac = datagram.last<kMacSize>();
  std::array<std::uint8_t, kMacSize> expected;
  hash(expected.data(), datagram.subspan(kPrologue, datagram.size() - kPrologue - kMacSize), *key_);
  return sodium_memcmp(expected.data(), mac.data(), kMacSize) == 0;
}

}  // namespace gyrotwin
