// Types from their text: the same fingerprints, sizes and values as lcm-gen's code.
#include "services/schema/lcm_type.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "services/runtime/error.hpp"
#include "services/schema/lcm_text.hpp"
#include "tests/support/distinct.hpp"

namespace gyrotwin {
namespace {

using nlohmann::json;

LcmTypes types_of(const std::vector<std::string>& sources) { return LcmTypes(sources); }

LcmTypes own_types() { return types_of({lcm_sources().begin(), lcm_sources().end()}); }

template <class Message>
json decoded(const LcmTypes& types, const std::string& name, const Message& message) {
  const std::vector<std::uint8_t> payload = encoded(message);
  std::string text;
  append_json(text, *types.find(name), payload);
  return json::parse(text);
}

template <class Message>
class GeneratedType : public testing::Test {};
using Generated = testing::Types<header_t, state_t, command_t, request_t, reply_t, truth_t,
                                 status_t, sensors_t, beat_t, link_t, health_t, forecast_t>;
TYPED_TEST_SUITE(GeneratedType, Generated);

TYPED_TEST(GeneratedType, HasTheSameFingerprintAndSize) {
  const LcmTypes types = own_types();
  const LcmType* type = types.find(std::string_view(TypeParam::getTypeName()));
  ASSERT_NE(type, nullptr);
  EXPECT_EQ(type->fingerprint, static_cast<std::uint64_t>(TypeParam::getHash()));
  EXPECT_EQ(type->payload_size(), static_cast<std::size_t>(TypeParam{}.getEncodedSize()));
  EXPECT_EQ(types.find(type->fingerprint), type);
}

TEST(LcmType, DecodesEveryFieldAsTheGeneratedCodeDoes) {
  const LcmTypes types = own_types();
  const auto state = distinct<state_t>();
  const json j = decoded(types, "state_t", state);
  EXPECT_EQ(j["header"]["rig_id"], state.header.rig_id);
  EXPECT_EQ(j["header"]["sender_mono_ns"], state.header.sender_mono_ns);
  EXPECT_EQ(j["mode"], state.mode);
  EXPECT_EQ(j["tilt_rad"], json(state.tilt_rad));
  EXPECT_EQ(j["drive_torque_nm"], json(state.drive_torque_nm));
  std::string mac;
  append_hex(mac, state.mac);
  EXPECT_EQ(j["mac"], mac);

  auto status = distinct<status_t>();
  std::copy_n("a \"name\"", 9, status.host);
  const json s = decoded(types, "status_t", status);
  EXPECT_EQ(s["host"], "a \"name\"");
  EXPECT_EQ(s["speed_factor"], status.speed_factor);
  EXPECT_EQ(s["reordered"], json(status.reordered));

  const auto reply = distinct<reply_t>();
  const json r = decoded(types, "reply_t", reply);
  EXPECT_EQ(r["request_writer"], reply.request_writer);
  EXPECT_EQ(r["applied_tick"], reply.applied_tick);
}

TEST(LcmType, EveryDigitOfADoubleComesThrough) {
  const LcmTypes types = own_types();
  command_t command{};
  command.value[0] = 0.1 + 0.2;
  command.value[1] = std::numeric_limits<double>::denorm_min();
  command.value[2] = -std::numeric_limits<double>::infinity();
  command.value[3] = std::numeric_limits<double>::quiet_NaN();
  const json j = decoded(types, "command_t", command);
  EXPECT_EQ(j["value"][0].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(j["value"][1].get<double>(), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(j["value"][2], "-inf");
  EXPECT_EQ(j["value"][3], "nan");
}

TEST(LcmType, LocatesNumbers) {
  const LcmTypes types = own_types();
  const auto request = distinct<request_t>();
  const std::vector<std::uint8_t> payload = encoded(request);
  const LcmType& type = *types.find("request_t");
  EXPECT_EQ(integer_at(payload, locate(type, "header.epoch").value()), request.header.epoch);
  EXPECT_EQ(integer_at(payload, locate(type, "counter").value()), request.counter);
  EXPECT_EQ(number_at(payload, locate(type, "speed_factor").value()), request.speed_factor);
  EXPECT_FALSE(locate(type, "header"));
  EXPECT_FALSE(locate(type, "header.nothing"));
  EXPECT_FALSE(locate(type, "initial_q"));
  EXPECT_FALSE(locate(type, "mac.epoch"));
}

TEST(LcmType, ReadsWhatTheLanguageAllows) {
  const LcmTypes types = types_of({R"(package other; /* a comment; */
    struct inner_t { int8_t a; boolean b, c; }
    struct outer_t { const int32_t N = 3, M = 4;
      int16_t grid[2][3]; // one // two
      other.inner_t pair[2]; float f; byte name[4]; // ASCII
    })"});
  const LcmType* type = types.find("outer_t");
  ASSERT_NE(type, nullptr);
  EXPECT_EQ(type->size, 12U + 6U + 4U + 4U);
  const std::vector<std::uint8_t> payload{0, 0, 0,    0,    0, 0, 0,   0,   0,   1, 0, 2,
                                          0, 3, 0,    4,    0, 5, 0,   6,   255, 1, 0, 2,
                                          0, 1, 0x3F, 0x80, 0, 0, 'h', 'i', 0,   0};
  std::string text;
  append_json(text, *type, payload);
  EXPECT_EQ(text, R"({"grid":[[1,2,3],[4,5,6]],"pair":[{"a":-1,"b":true,"c":false},)"
                  R"({"a":2,"b":false,"c":true}],"f":1,"name":"hi"})");
}

TEST(LcmType, LeavesOutWhatHasNoOneSize) {
  const LcmTypes types = types_of(
      {"struct a_t { string s; } struct b_t { int32_t n; double x[n]; } struct c_t { a_t a; }"
       "struct d_t { d_t again; } struct e_t { f_t f; } struct f_t { e_t e; int8_t x; }"
       "struct g_t { missing_t m; } struct h_t { double x[1000][1000]; }"});
  for (const std::string_view name : {"a_t", "b_t", "c_t", "d_t", "e_t", "f_t", "g_t", "h_t"}) {
    EXPECT_EQ(types.find(name), nullptr) << name;
  }
}

TEST(LcmType, ARowOfNothingIsNoType) {
  const LcmTypes types = types_of(
      {"struct a_t { }", "struct b_t { a_t x[1048576][1048576]; }", "struct c_t { b_t b; }"});
  for (const std::string_view name : {"a_t", "b_t", "c_t"}) EXPECT_EQ(types.find(name), nullptr);
}

TEST(LcmType, SaysWhereTheTextGoesWrong) {
  const auto refusal = [](const std::string& text) {
    try {
      types_of({text});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal("package x;\nstruct a_t {\n  double x\n}"), "line 4: expected `;`, found `}`");
  EXPECT_EQ(refusal("struct a_t { double x[0]; }"),
            "line 1: expected a length from 1 to 1048576, found `0`");
  EXPECT_EQ(refusal("enum e { A }"), "line 1: expected `struct`, found `enum`");
  EXPECT_EQ(refusal("struct a_t {"), "line 1: expected a type, found the end");
}

TEST(LcmType, OfTwoWithOneNameTheLaterCounts) {
  const LcmTypes types =
      types_of({"struct a_t { b_t b; }", "struct b_t { int8_t x; }", "struct b_t { int64_t x; }"});
  EXPECT_EQ(types.find("a_t")->size, 8U);
}

TEST(LcmText, ShortFormLeavesOutZerosAndBytes) {
  const LcmTypes types = own_types();
  state_t state{};
  state.header.sequence = 5;
  state.header.tick = 4;
  state.tilt_rad[1] = 0.25;
  state.mac[0] = 1;
  std::string text;
  append_short(text, *types.find("state_t"), encoded(state));
  EXPECT_EQ(text, " sequence 5 tick 4 tilt_rad 0,0.25");
}

}  // namespace
}  // namespace gyrotwin
