// The wire does not change unseen: fingerprint, size and bytes of every type are those of
// tests/data/wire.lock, and the datagram worked out in messages/README.md is the one we send.
//
// `wire_lock_test --write FILE` writes the lock anew. Allowed for a type that was never released;
// a released type is not edited, a new one gets `_v2` (messages/README.md, "Evolution").
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "services/runtime/datagram.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

const std::string kLock = GYROTWIN_SOURCE_DIR "/tests/data/wire.lock";
const std::string kReadme = GYROTWIN_SOURCE_DIR "/messages/README.md";

std::string hex(std::span<const std::uint8_t> bytes) {
  std::ostringstream text;
  for (const int byte : bytes) text << std::hex << std::setfill('0') << std::setw(2) << byte;
  return text.str();
}

template <class Message>
std::string lock_line() {
  const Message message = distinct<Message>();
  std::ostringstream line;
  line << Message::getTypeName() << ' ' << message.getEncodedSize() << ' ' << std::hex
       << std::setfill('0') << std::setw(16) << static_cast<std::uint64_t>(Message::getHash())
       << ' ' << hex(encoded(message)) << '\n';
  return line.str();
}

std::string lock() {
  return lock_line<state_t>() + lock_line<command_t>() + lock_line<request_t>() +
         lock_line<reply_t>() + lock_line<truth_t>() + lock_line<status_t>() +
         lock_line<sensors_t>() + lock_line<beat_t>() + lock_line<link_t>() +
         lock_line<health_t>() + lock_line<forecast_t>();
}

std::string content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// The datagram of messages/README.md: lines of four digits of offset, two blanks, up to eight
/// bytes.
Bytes readme_datagram() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  Bytes bytes;
  std::istringstream lines(content(kReadme));
  for (std::string line; std::getline(lines, line);) {
    if (line.size() < 8 || line.find_first_not_of(kDigits) != 4 || line.substr(4, 2) != "  ")
      continue;
    std::istringstream pairs(line.substr(6, 23));
    for (unsigned byte = 0; pairs >> std::hex >> byte;) {
      bytes.push_back(static_cast<std::uint8_t>(byte));
    }
  }
  return bytes;
}

TEST(WireLock, TypesAreThoseOfTheLock) {
  EXPECT_EQ(content(kLock), lock()) << "a released type was edited; see messages/README.md";
}

template <class Message>
class TypeTest : public ::testing::Test {};
using Types = ::testing::Types<state_t, command_t, request_t, reply_t, truth_t, status_t, sensors_t,
                               beat_t, link_t, health_t, forecast_t>;
TYPED_TEST_SUITE(TypeTest, Types);

TYPED_TEST(TypeTest, EncodedSizeIsThatOfTheTable) {
  EXPECT_EQ(kWireSize<TypeParam>, static_cast<std::size_t>(TypeParam{}.getEncodedSize()));
  for (const ChannelSpec& row : kChannels) {
    if (row.type != TypeParam::getTypeName()) continue;
    EXPECT_EQ(row.size, kWireSize<TypeParam>) << row.suffix;
  }
}

TYPED_TEST(TypeTest, EveryFieldIsInTheGoldenBytes) {
  // A field that `fill` forgets keeps the background and tells the two apart.
  TypeParam zeros;
  TypeParam ones;
  std::memset(&zeros, 0x00, sizeof zeros);
  std::memset(&ones, 0xff, sizeof ones);
  Distinct set_zeros;
  Distinct set_ones;
  fill(zeros, set_zeros);
  fill(ones, set_ones);
  EXPECT_EQ(hex(encoded(zeros)), hex(encoded(ones)));
}

TYPED_TEST(TypeTest, DecodesToTheSameMessage) {
  const Bytes bytes = encoded(distinct<TypeParam>());
  TypeParam decoded;
  ASSERT_EQ(decoded.decode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
  EXPECT_EQ(hex(encoded(decoded)), hex(bytes));
}

TYPED_TEST(TypeTest, SignatureIsTheLastField) {
  const auto message = distinct<TypeParam>();
  const Bytes bytes = encoded(message);
  EXPECT_EQ(hex(std::span(bytes).last(kMacSize)), hex(message.mac));
}

TEST(DatagramFormat, ReadsTheHeaderFieldsOfEveryChannel) {
  const DatagramFormat format("TEST", kTestRig, {});
  for (const ChannelSpec& row : kChannels) {
    const Bytes datagram =
        short_message("TEST/" + std::string(row.suffix), distinct_payload(row.channel, kTestRig));
    const Parsed parsed = format.parse(datagram);
    ASSERT_EQ(parsed.verdict, Verdict::kGood) << row.suffix;
    EXPECT_EQ(parsed.channel, row.channel);
    const auto header = distinct<state_t>().header;
    EXPECT_EQ(parsed.epoch, header.epoch);
    EXPECT_EQ(parsed.sequence, header.sequence);
  }
}

TEST(DatagramFormat, SendsTheDatagramOfTheReadme) {
  command_t command{};
  command.header = {.rig_id = 7,
                    .source = header_t::CONTROLLER,
                    .epoch = 81985529216486895,
                    .sequence = 41,
                    .tick = 40,
                    .sim_time_ns = 40'000'000,
                    .sender_mono_ns = 1'000'000'000};
  command.mode = command_t::TORQUE_NM;
  command.valid_ticks = 5;
  command.value[0] = -0.5;
  command.for_tick = 40;
  command.owner_epoch = 1234567890123456789;
  command.writer = 1311768467463790320;
  command.counter = 42;

  const DatagramFormat format("DEMO", 7, test_key());
  Frame frame{};
  const std::size_t at = format.begin(frame, Channel::kCommand, 3);
  const std::size_t size = at + kWireSize<command_t>;
  command.encode(frame.data() + at, 0, kWireSize<command_t>);
  format.sign(frame, size);
  EXPECT_EQ(hex(std::span(frame).first(size)), hex(readme_datagram()));
  EXPECT_EQ(format.parse(readme_datagram()).verdict, Verdict::kGood);
}

}  // namespace
}  // namespace gyrotwin

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  if (argc == 3 && std::string(argv[1]) == "--write") {
    std::ofstream(argv[2]) << gyrotwin::lock();
    std::cout << "wrote " << argv[2] << "; read messages/README.md, \"Evolution\"\n";
    return 0;
  }
  return RUN_ALL_TESTS();
}
