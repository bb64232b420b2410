// LCM types as ROS 2 tools read them.
#include "services/schema/ros2_message.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <string>

#include "messages/big_endian.hpp"

namespace gyrotwin {
namespace {

using Bytes = std::vector<std::uint8_t>;

LcmTypes types_of(std::string source) {
  const std::vector<std::string> sources{std::move(source)};
  return LcmTypes(sources);
}

TEST(Ros2Message, NamesFieldsConstantsAndUnits) {
  const LcmTypes types = types_of(
      "struct inner_t { int32_t a; }\n"
      "struct two_words_t { const int32_t ON = 1, OFF = -2;\n"
      "  inner_t one;  // the first\n"
      "  inner_t many[2];\n"
      "  double x[2][3];  // [m] places\n"
      "  byte text[8];  // ASCII\n"
      "  byte raw[4];\n"
      "  boolean flag; float f; int8_t c; int16_t s; int64_t l; }\n");
  const Ros2Message message(*types.find("two_words_t"));
  EXPECT_EQ(message.name(), "gyrotwin/msg/TwoWords");
  EXPECT_EQ(message.definition(),
            "int32 ON=1\n"
            "int32 OFF=-2\n"
            "gyrotwin/Inner one  # the first\n"
            "gyrotwin/Inner[2] many\n"
            "float64[6] x  # [m] places\n"
            "string text  # ASCII\n"
            "uint8[4] raw\n"
            "bool flag\n"
            "float32 f\n"
            "int8 c\n"
            "int16 s\n"
            "int64 l\n" +
                std::string(80, '=') + "\nMSG: gyrotwin/Inner\nint32 a\n");
}

// Bytes counted by hand from the CDR rules: header 00 01 00 00, each number at a multiple of its
// size from the header's end on, texts with their length and NUL.
TEST(Ros2Message, AlignsAndTurnsEveryNumber) {
  const LcmTypes types = types_of(
      "struct t { byte b; double d; int16_t s; byte text[8];  // ASCII\n"
      " int32_t i; byte c; int64_t l; }\n");
  const LcmType& type = *types.find("t");
  Bytes payload(type.payload_size());
  std::uint8_t* at = payload.data() + 8;
  const auto put = [&at](auto unsigned_value) {
    put_big_endian(unsigned_value, at);
    at += sizeof unsigned_value;
  };
  put(std::uint8_t{0x11});
  put(std::bit_cast<std::uint64_t>(1.0));
  put(std::uint16_t{0x2122});
  for (const char c : {'o', 'k', '\0', 'x', '\0', '\0', '\0', '\0'}) {
    put(static_cast<std::uint8_t>(c));
  }
  put(std::uint32_t{0x31323334});
  put(std::uint8_t{0x41});
  put(std::uint64_t{0x5152535455565758});

  Bytes out{0xaa};  // what is there stays
  Ros2Message(type).encode(payload, out);
  const Bytes expected{0xaa, 0,    1,    0,    0,                        // encapsulation
                       0x11, 0,    0,    0,    0,    0,    0,    0,      // b, padded
                       0,    0,    0,    0,    0,    0,    0xf0, 0x3f,   // d
                       0x22, 0x21, 0,    0,                              // s, padded
                       3,    0,    0,    0,    'o',  'k',  0,    0,      // text, padded
                       0x34, 0x33, 0x32, 0x31,                           // i
                       0x41, 0,    0,    0,    0,    0,    0,    0,      // c, padded
                       0x58, 0x57, 0x56, 0x55, 0x54, 0x53, 0x52, 0x51};  // l
  EXPECT_EQ(out, expected);
}

TEST(Ros2Message, EveryTypeOfTheWireHasOne) {
  const LcmTypes types(lcm_sources());
  for (const std::string_view name :
       {"state_t", "command_t", "request_t", "reply_t", "truth_t", "status_t", "sensors_t",
        "link_t", "health_t", "forecast_t"}) {
    const LcmType* type = types.find(name);
    ASSERT_NE(type, nullptr) << name;
    const Ros2Message message(*type);
    EXPECT_TRUE(message.definition().find("gyrotwin/Header header") != std::string::npos) << name;
    Bytes out;
    message.encode(Bytes(type->payload_size()), out);
    EXPECT_GT(out.size(), 4u) << name;
  }
}

}  // namespace
}  // namespace gyrotwin
