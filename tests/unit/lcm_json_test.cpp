// Messages from JSON: what is meant, and what is refused.
#include "services/schema/lcm_json.hpp"

#include <gtest/gtest.h>

#include <string>

#include "messages/channels.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

const LcmType& request_type() {
  static const LcmTypes types(lcm_sources());
  return *types.find("request_t");
}

request_t read(const std::string& text) {
  const auto payload = payload_from_json(request_type(), nlohmann::json::parse(text));
  request_t request;
  EXPECT_EQ(request.decode(payload.data(), 0, static_cast<int>(payload.size())),
            static_cast<int>(payload.size()));
  return request;
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LcmJson, TakesNumbersConstantsAndLongDigits) {
  const request_t request = read(
      R"({"verb": "DISTURB", "kind": "LOAD", "moment_nm": [250, -1.5, 0], "duration_ns": 20000000,
          "writer": "9007199254740993", "counter": 7, "header": {"rig_id": 3}})");
  EXPECT_EQ(request.verb, request_t::DISTURB);
  EXPECT_EQ(request.kind, request_t::LOAD);
  EXPECT_EQ(request.moment_nm[0], 250.0);
  EXPECT_EQ(request.moment_nm[1], -1.5);
  EXPECT_EQ(request.duration_ns, 20'000'000);
  EXPECT_EQ(request.writer, 9007199254740993);
  EXPECT_EQ(request.counter, 7);
  EXPECT_EQ(request.header.rig_id, 3);
  EXPECT_EQ(request.speed_factor, 0.0);
}

TEST(LcmJson, NamesWhatIsWrongAndWhere) {
  EXPECT_EQ(refusal(R"({"moment": 1})"),
            "moment: request_t has no such field; did you mean `moment_nm`?");
  EXPECT_EQ(refusal(R"({"header": {"tick": 1.5}})"),
            "header.tick: expected a whole number of this field's size, or a constant of header_t, "
            "found 1.5");
  EXPECT_EQ(refusal(R"({"force_n": [0, 0]})"), "force_n: expected an array of 3, found [0,0]");
  EXPECT_EQ(refusal(R"({"force_n": [0, "x", 0]})"),
            "force_n[1]: expected a finite number, found \"x\"");
  EXPECT_EQ(refusal(R"({"force_n": [0, null, 0]})"),
            "force_n[1]: expected a finite number, found null");
  EXPECT_EQ(refusal(R"({"verb": 2147483648})").substr(0, 29), "verb: expected a whole number");
  EXPECT_EQ(refusal(R"({"counter": 9223372036854775808})").substr(0, 32),
            "counter: expected a whole number");
  EXPECT_EQ(refusal(R"({"verb": "ARMED"})").substr(0, 29), "verb: expected a whole number");
  EXPECT_EQ(refusal("[]"), "request_t: expected an object, found []");
}

TEST(LcmJson, ATextLeavesRoomForItsEnd) {
  static const std::vector<std::string> kSource{"struct t { byte word[4];  // ASCII\n }"};
  const LcmTypes types(kSource);
  const auto payload =
      payload_from_json(*types.find("t"), nlohmann::json::parse(R"({"word": "abc"})"));
  EXPECT_EQ(std::string(payload.begin() + 8, payload.end()), std::string("abc\0", 4));
  EXPECT_THROW(payload_from_json(*types.find("t"), nlohmann::json::parse(R"({"word": "abcd"})")),
               Error);
}

}  // namespace
}  // namespace gyrotwin
