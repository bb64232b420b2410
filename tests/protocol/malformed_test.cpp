// Everything that is not a message of this rig lands in its counter, and nothing of it is
// delivered.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "services/runtime/bus.hpp"
#include "services/runtime/datagram.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kPrologue = 8;

Bytes text(std::string_view characters) { return {characters.begin(), characters.end()}; }

std::string name_of(Channel channel) { return "TEST/" + std::string(spec(channel).suffix); }

Bytes state_payload() { return distinct_payload(Channel::kState, kTestRig); }

/// A STATE whose bytes from `at` on are these.
Bytes patched_state(std::size_t at, const Bytes& bytes) {
  Bytes payload = state_payload();
  std::ranges::copy(bytes, payload.begin() + static_cast<std::ptrdiff_t>(at));
  return short_message(name_of(Channel::kState), payload);
}

Bytes resized_state(std::size_t size) {
  Bytes payload = state_payload();
  payload.resize(size);
  return short_message(name_of(Channel::kState), payload);
}

/// A datagram of the channel's distinct message, signed when there is a key.
Bytes good(Channel channel, const std::optional<Key>& key) {
  const DatagramFormat format("TEST", kTestRig, key);
  const Bytes payload = distinct_payload(channel, kTestRig);
  Frame frame{};
  const std::size_t at = format.begin(frame, channel, 0);
  std::ranges::copy(payload, frame.begin() + static_cast<std::ptrdiff_t>(at));
  format.sign(frame, at + payload.size());
  return {frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(at + payload.size())};
}

struct Case {
  std::string name;
  Bytes datagram;
  Verdict verdict;
};

std::vector<Case> cases() {
  const std::string state = name_of(Channel::kState);
  const Bytes negative{0x80, 0, 0, 0, 0, 0, 0, 0};
  const Bytes request = distinct_payload(Channel::kRequest, kTestRig);
  const Bytes other = distinct_payload(Channel::kState, kTestRig + 1);
  Bytes no_nul = text("LC02....");
  no_nul.insert(no_nul.end(), state.begin(), state.end());
  Bytes no_nul_long = text("LC02....");
  no_nul_long.resize(60000, 'A');
  Bytes wrong_magic = short_message(state, state_payload());
  wrong_magic[3] = '1';

  return {
      {"nothing at all", {}, Verdict::kMalformed},
      {"one byte", text("L"), Verdict::kMalformed},
      {"seven bytes", text("LC02..."), Verdict::kMalformed},
      {"magic and packet number only", text("LC02...."), Verdict::kMalformed},
      {"another magic", wrong_magic, Verdict::kMalformed},
      {"name without NUL", no_nul, Verdict::kMalformed},
      {"60,000 bytes without NUL", no_nul_long, Verdict::kMalformed},
      {"empty name", short_message("", state_payload()), Verdict::kMalformed},
      {"name of 64 characters", short_message(std::string(64, 'A'), state_payload()),
       Verdict::kMalformed},
      {"no payload", resized_state(0), Verdict::kMalformed},
      {"fingerprint only", resized_state(8), Verdict::kMalformed},
      {"one byte short", resized_state(kWireSize<state_t> - 1), Verdict::kMalformed},
      {"one byte long", resized_state(kWireSize<state_t> + 1), Verdict::kMalformed},
      {"60,000 bytes long", resized_state(60000), Verdict::kMalformed},
      {"type of the same size", short_message(state, request), Verdict::kMalformed},
      {"wrong fingerprint", patched_state(0, negative), Verdict::kMalformed},
      {"negative epoch", patched_state(16, negative), Verdict::kMalformed},
      {"negative sequence", patched_state(24, negative), Verdict::kMalformed},

      {"whole fragment", text("LC03....\0\0\0\4\0\0\0\0\0\0\0\1"sv), Verdict::kForeign},
      {"fragment beyond its message", text("LC03....\0\0\0\4\x7f\xff\xff\xff\0\1\0\2abcd"sv),
       Verdict::kForeign},
      {"fragment of twelve bytes that asks for 16 GB", text("LC03....\xff\xff\xff\xff"sv),
       Verdict::kForeign},
      {"fragment of eight bytes", text("LC03...."sv), Verdict::kForeign},
      {"LCM's self-test", short_message("LCM_SELF_TEST", text("lcm self test")), Verdict::kForeign},
      {"unknown channel", short_message("TEST/LIVE/ELSE", state_payload()), Verdict::kForeign},
      {"another prefix", short_message("REST/LIVE/STATE", state_payload()), Verdict::kForeign},
      {"name that a regex would match", short_message("TEST.LIVE.STATE", state_payload()),
       Verdict::kForeign},
      {"name cut", short_message("TEST/LIVE/STAT", state_payload()), Verdict::kForeign},
      {"name with more", short_message("TEST/LIVE/STATES", state_payload()), Verdict::kForeign},
      {"name of 63 characters", short_message(std::string(63, 'A'), {}), Verdict::kForeign},
      {"unknown channel, 60,000 bytes", short_message("MAP", Bytes(60000)), Verdict::kForeign},

      {"another rig", short_message(state, other), Verdict::kOtherRig},
  };
}

std::vector<Case> cases_of_a_signed_rig() {
  Key wrong = test_key();
  wrong[31] ^= 1;
  // Same type, same rig, same bytes: only the name tells whose status it is.
  Bytes borrowed = good(Channel::kIntegratorStatus, test_key());
  const std::size_t payload_at = kPrologue + name_of(Channel::kIntegratorStatus).size() + 1;
  borrowed =
      short_message(name_of(Channel::kControllerStatus), std::span(borrowed).subspan(payload_at));
  return {
      {"unsigned", good(Channel::kState, {}), Verdict::kUnauthentic},
      {"signed with another key", good(Channel::kState, wrong), Verdict::kUnauthentic},
      {"signature of another channel", borrowed, Verdict::kUnauthentic},
  };
}

TEST(Parser, GivesEveryKindItsVerdict) {
  const DatagramFormat open("TEST", kTestRig, {});
  const DatagramFormat with_key("TEST", kTestRig, test_key());
  for (const Case& c : cases()) {
    EXPECT_EQ(open.parse(c.datagram).verdict, c.verdict) << c.name;
    EXPECT_EQ(with_key.parse(c.datagram).verdict, c.verdict) << c.name;
  }
  for (const Case& c : cases_of_a_signed_rig()) {
    EXPECT_EQ(with_key.parse(c.datagram).verdict, c.verdict) << c.name;
  }
  for (const ChannelSpec& row : kChannels) {
    EXPECT_EQ(open.parse(good(row.channel, {})).verdict, Verdict::kGood);
    EXPECT_EQ(open.parse(good(row.channel, test_key())).verdict, Verdict::kGood) << "mac unread";
    EXPECT_EQ(with_key.parse(good(row.channel, test_key())).verdict, Verdict::kGood);
  }
}

TEST(Bus, CountsEveryKindAndDeliversNothing) {
  const BusConfig config = test_config(test_key());
  Bus bus(config);
  RawPeer peer(config);
  std::map<Verdict, std::int64_t> expected;
  auto all = cases();
  std::ranges::move(cases_of_a_signed_rig(), std::back_inserter(all));
  for (const Case& c : all) {
    peer.send(c.datagram);
    ++expected[c.verdict];
  }
  // Datagrams of one socket stay in order: with the good one, all before it have been judged.
  peer.send(good(Channel::kCommand, test_key()));
  const auto reception = receive_soon(bus);
  ASSERT_TRUE(reception);
  EXPECT_EQ(reception->channel, Channel::kCommand);
  EXPECT_FALSE(bus.receive());

  const BusCounters& counters = bus.counters();
  EXPECT_EQ(counters.malformed, expected[Verdict::kMalformed]);
  EXPECT_EQ(counters.foreign, expected[Verdict::kForeign]);
  EXPECT_EQ(counters.other_rig, expected[Verdict::kOtherRig]);
  EXPECT_EQ(counters.unauthentic, expected[Verdict::kUnauthentic]);
  EXPECT_EQ(counters.kernel_dropped, 0);
}

TEST(Parser, AnyFlippedBitUnderTheSignatureIsNotDelivered) {
  const DatagramFormat format("TEST", kTestRig, test_key());
  for (const ChannelSpec& row : kChannels) {
    const Bytes original = good(row.channel, test_key());
    for (std::size_t bit = 8 * kPrologue; bit < 8 * original.size(); ++bit) {
      Bytes flipped = original;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      EXPECT_NE(format.parse(flipped).verdict, Verdict::kGood) << row.suffix << " bit " << bit;
    }
    // LCM's packet number alone is outside the signature, and nobody reads it.
    for (std::size_t bit = 32; bit < 8 * kPrologue; ++bit) {
      Bytes flipped = original;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      EXPECT_EQ(format.parse(flipped).verdict, Verdict::kGood);
    }
  }
}

/// Random damage: a few bytes changed, cut off, or appended.
void mutate(Bytes& datagram, std::mt19937_64& random) {
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const auto byte = [&random] { return static_cast<std::uint8_t>(random()); };
  switch (below(8)) {
    case 0:
      datagram.resize(below(datagram.size()));
      break;
    case 1:
      for (std::size_t n = 1 + below(40); n > 0; --n) datagram.push_back(byte());
      break;
    case 2:  // where magic, name, fingerprint and header are
      datagram[below(70)] = byte();
      break;
    case 3:
      datagram[below(70)] ^= static_cast<std::uint8_t>(1U << below(8));
      break;
    default:
      for (std::size_t n = 1 + below(4); n > 0; --n) datagram[below(datagram.size())] = byte();
  }
}

/// Whether a mutant of `original` is good to an unsigned rig, told without parsing: it may differ
/// in the packet number and, past the rig id, wherever no sign bit is set.
bool still_good(const Bytes& mutant, const Bytes& original, std::size_t payload_at) {
  if (mutant.size() != original.size()) return false;
  const auto same = [&](std::size_t from, std::size_t to) {
    const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
    return std::equal(mutant.begin() + at(from), mutant.begin() + at(to),
                      original.begin() + at(from));
  };
  return same(0, 4) && same(kPrologue, payload_at + 12) && mutant[payload_at + 16] < 0x80 &&
         mutant[payload_at + 24] < 0x80;
}

TEST(Parser, AMillionMutantsAreJudgedRight) {
  const DatagramFormat open("TEST", kTestRig, {});
  const DatagramFormat with_key("TEST", kTestRig, test_key());
  std::array<Bytes, kChannels.size()> originals;
  for (const ChannelSpec& row : kChannels) {
    originals[static_cast<std::size_t>(row.channel)] = good(row.channel, test_key());
  }

  std::mt19937_64 random(20240229);
  std::map<Verdict, int> seen;
  for (int i = 0; i < 1'000'000; ++i) {
    const std::size_t channel = random() % originals.size();
    const Bytes& original = originals[channel];
    const std::size_t payload_at = original.size() - kChannels[channel].size;
    Bytes mutant = original;
    mutate(mutant, random);
    mutant.shrink_to_fit();  // so that a sanitizer sees a read beyond the end

    const Parsed unsigned_rig = open.parse(mutant);
    ASSERT_EQ(unsigned_rig.verdict == Verdict::kGood, still_good(mutant, original, payload_at))
        << i;
    if (unsigned_rig.verdict == Verdict::kGood) {
      ASSERT_EQ(unsigned_rig.channel, kChannels[channel].channel) << i;
      ASSERT_EQ(unsigned_rig.payload.data(), mutant.data() + payload_at) << i;
      ASSERT_EQ(unsigned_rig.payload.size(), kChannels[channel].size) << i;
    }

    const bool intact =
        mutant.size() == original.size() &&
        std::equal(mutant.begin(), mutant.begin() + 4, original.begin()) &&
        std::equal(mutant.begin() + kPrologue, mutant.end(), original.begin() + kPrologue);
    const Parsed signed_rig = with_key.parse(mutant);
    ASSERT_EQ(signed_rig.verdict == Verdict::kGood, intact) << i;
    ++seen[signed_rig.verdict];
  }
  // The mutants reach every verdict often enough to mean something.
  for (const Verdict verdict : {Verdict::kGood, Verdict::kMalformed, Verdict::kForeign,
                                Verdict::kOtherRig, Verdict::kUnauthentic}) {
    EXPECT_GT(seen[verdict], 1000) << static_cast<int>(verdict);
  }
}

}  // namespace
}  // namespace gyrotwin
