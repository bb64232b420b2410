// Who may look, and who may act.
#include <gtest/gtest.h>

#include "services/gateway/access.hpp"
#include "services/gateway/foxglove.hpp"

namespace gyrotwin {
namespace {

class GatewayAccess : public testing::Test {
 protected:
  Role role(const Caller& caller, bool any_program = false) const {
    return Access(tokens_, {"https://app.example"}, any_program).judge(caller).role;
  }
  std::string with(const std::string& token) const { return "/?token=" + token; }

  Tokens tokens_ = make_tokens(Key{1, 2, 3});
};

TEST_F(GatewayAccess, TokensFollowFromTheKey) {
  const Tokens again = make_tokens(Key{1, 2, 3});
  EXPECT_EQ(again.observer, tokens_.observer);
  EXPECT_EQ(again.operator_, tokens_.operator_);
  EXPECT_NE(again.observer, again.operator_);
  EXPECT_NE(make_tokens(Key{1, 2, 4}).operator_, tokens_.operator_);
  EXPECT_EQ(tokens_.operator_.size(), 32u);
}

TEST_F(GatewayAccess, FromThisHost) {
  const std::string op = with(tokens_.operator_), wrong = with("0000");
  EXPECT_EQ(role({.from_loopback = true, .host = "localhost:8765", .origin = {}, .target = "/"}),
            Role::kObserver);
  EXPECT_EQ(role({.from_loopback = true, .host = "[::1]:8765", .origin = {}, .target = op}),
            Role::kOperator);
  EXPECT_EQ(role({.from_loopback = true, .host = "127.0.0.1:8765", .origin = {}, .target = wrong}),
            Role::kNobody);
  EXPECT_EQ(role({.from_loopback = true, .host = "evil.example:8765", .origin = {}, .target = op}),
            Role::kNobody);
  EXPECT_EQ(role({.from_loopback = true, .host = "", .origin = {}, .target = op}), Role::kNobody);
}

TEST_F(GatewayAccess, PagesOfOtherSites) {
  const auto from = [&](std::string_view origin) {
    return role({.from_loopback = true, .host = "localhost:8765", .origin = origin, .target = "/"});
  };
  EXPECT_EQ(from("http://localhost:8765"), Role::kObserver);
  EXPECT_EQ(from("https://app.example"), Role::kObserver);
  EXPECT_EQ(from("https://evil.example"), Role::kNobody);
  EXPECT_EQ(from("https://app.example.evil.example"), Role::kNobody);
  EXPECT_EQ(from("http://localhost:8766"), Role::kNobody);
  EXPECT_EQ(from("null"), Role::kNobody);
  EXPECT_EQ(from(""), Role::kNobody);
}

TEST_F(GatewayAccess, FromAnotherHost) {
  const std::string observer = with(tokens_.observer);
  const Caller page{.from_loopback = false,
                    .host = "lab:8765",
                    .origin = "http://lab:8765",
                    .target = observer,
                    .wants_socket = true};
  EXPECT_EQ(role(page), Role::kObserver);
  Caller caller = page;
  caller.target = "/";
  EXPECT_EQ(role(caller), Role::kNobody);
  caller = page;
  caller.origin.reset();
  EXPECT_EQ(role(caller), Role::kNobody);
  EXPECT_EQ(role(caller, true), Role::kObserver);
  caller.wants_socket = false;  // a document: browsers send no Origin for it
  EXPECT_EQ(role(caller), Role::kObserver);
}

TEST(GatewayQuery, FindsAValue) {
  EXPECT_EQ(query_value("/?token=abc", "token"), "abc");
  EXPECT_EQ(query_value("/x?a=1&token=a%20b%2", "token"), "a b%2");
  EXPECT_EQ(query_value("/?token=%41", "token"), "A");
  EXPECT_EQ(query_value("/?tokens=1", "token"), "");
  EXPECT_EQ(query_value("/?token", "token"), "");
  EXPECT_EQ(query_value("/", "token"), "");
}

TEST(GatewaySubprotocol, TakesTheBest) {
  EXPECT_EQ(foxglove::choose_subprotocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(foxglove::choose_subprotocol("x, foxglove.websocket.v1 ,foxglove.sdk.v1"),
            "foxglove.sdk.v1");
  EXPECT_EQ(foxglove::choose_subprotocol("foxglove.websocket.v2"), "");
  EXPECT_EQ(foxglove::choose_subprotocol(""), "");
}

}  // namespace
}  // namespace gyrotwin
