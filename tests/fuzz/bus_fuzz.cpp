// Any bytes go through the parser: none may be read out of bounds, and what it calls good is a
// message of the channel, whole, and never one that nobody signed.
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <span>

#include "services/runtime/datagram.hpp"
#include "tests/support/distinct.hpp"

namespace gyrotwin {
namespace {

void check(bool invariant) {
  if (!invariant) std::abort();
}

class Target {
 public:
  void parse(std::span<const std::uint8_t> bytes) const {
    check(with_key_.parse(bytes).verdict != Verdict::kGood);
    const Parsed parsed = open_.parse(bytes);
    if (parsed.verdict != Verdict::kGood) return;
    check(parsed.payload.size() == spec(parsed.channel).size);
    check(parsed.payload.data() + parsed.payload.size() == bytes.data() + bytes.size());
    check(parsed.epoch >= 0 && parsed.sequence >= 0);
  }

  /// The bytes as damage to a good datagram of the channel that the first of them names: each is
  /// added to one byte of it with exclusive or, and those beyond its end lengthen it.
  void parse_damaged(std::span<const std::uint8_t> bytes) const {
    if (bytes.empty()) return;
    const Channel channel = kChannels[bytes[0] % kChannels.size()].channel;
    const auto damage = bytes.subspan(1);
    Frame frame{};
    const std::size_t at = open_.begin(frame, channel, 0);
    std::ranges::copy(distinct_payload(channel, 7),
                      frame.begin() + static_cast<std::ptrdiff_t>(at));
    const std::size_t size = std::max(at + spec(channel).size, damage.size());
    if (size > frame.size()) return;
    std::ranges::transform(damage, frame, frame.begin(), std::bit_xor<>());
    parse({frame.data(), size});
  }

 private:
  DatagramFormat open_{"RIG", 7, {}};
  DatagramFormat with_key_{"RIG", 7, Key{1, 2, 3}};
};

}  // namespace
}  // namespace gyrotwin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const gyrotwin::Target target;
  target.parse({data, size});
  target.parse_damaged({data, size});
  return 0;
}
