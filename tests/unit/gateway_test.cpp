// What the gateway answers, sends on and leaves out; without a socket.
#include "services/gateway/gateway.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/gateway/metrics.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/distinct.hpp"

namespace gyrotwin {
namespace {

using nlohmann::json;

constexpr std::int64_t kMs = 1'000'000;

class GatewayTest : public testing::Test {
 protected:
  std::vector<json> texts(Client& client) {
    std::vector<json> all;
    while (!client.outbox.empty()) {
      const Outgoing message = client.outbox.take();
      if (message.is_text) all.push_back(json::parse(*message.body));
    }
    return all;
  }
  /// The only text that a client is told; its level where it is a status.
  json told(Client& client, const std::string& text) {
    texts(client);
    gateway_.on_text(client, text);
    const auto all = texts(client);
    return all.size() == 1 ? all[0] : json(all);
  }
  Client& joined(Role role) {
    Client& client = gateway_.join(role);
    texts(client);
    return client;
  }
  template <class Message>
  void hear(Channel channel, const Message& message) {
    const auto payload = encoded(message);
    gateway_.on_reception({channel, false, payload}, now_, 1'700'000'000'000'000'000);
  }
  void hear_owner() {
    status_t status{};
    status.header.epoch = 77;
    status.header.tick = 5;
    set_text(status.host, "lab");
    hear(Channel::kIntegratorStatus, status);
  }
  void publish(Client& client, std::uint8_t channel, const std::string& text) {
    std::vector<std::uint8_t> bytes{1, channel, 0, 0, 0};
    bytes.insert(bytes.end(), text.begin(), text.end());
    gateway_.on_binary(client, bytes, now_);
  }
  void advertise(Client& client) {
    gateway_.on_text(client, R"({"op":"advertise","channels":[{"id":9,"topic":"PROTOTYPE_B/REQUEST",
                                "encoding":"json","schemaName":"x"}]})");
  }

  Rig rig_ = load_rig("prototype_b");
  std::vector<request_t> sent_;
  std::int64_t now_ = 0;
  std::vector<bool> wishes_;
  Gateway gateway_{rig_, print_rig("prototype_b", {}),
                   [this](const request_t& request, std::int64_t) { sent_.push_back(request); },
                   [this](bool on) {
                     wishes_.push_back(on);
                     return foxglove::Json{{"on", on}, {"file", "a.lcm"}};
                   }};
};

TEST_F(GatewayTest, GreetsWithEveryChannel) {
  Client& client = gateway_.join(Role::kOperator);
  const auto all = texts(client);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0]["op"], "serverInfo");
  EXPECT_EQ(all[0]["metadata"]["role"], "operator");
  ASSERT_EQ(all[1]["channels"].size(), kChannels.size());
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    const json& channel = all[1]["channels"][i];
    EXPECT_EQ(channel["id"], i);
    EXPECT_EQ(channel["topic"], "PROTOTYPE_B/" + std::string(kChannels[i].suffix));
    EXPECT_EQ(channel["encoding"], "cdr");
    EXPECT_EQ(channel["schemaEncoding"], "ros2msg");
  }
}

TEST_F(GatewayTest, SendsToSubscribersAlone) {
  Client& first = joined(Role::kObserver);
  Client& second = joined(Role::kObserver);
  gateway_.on_text(first, R"({"op":"subscribe","subscriptions":[{"id":300,"channelId":0}]})");
  hear(Channel::kState, distinct<state_t>());
  hear(Channel::kCommand, distinct<command_t>());
  EXPECT_TRUE(second.outbox.empty());
  const Outgoing message = first.outbox.take();
  EXPECT_TRUE(first.outbox.empty());
  EXPECT_EQ(message.head[0], 1);
  EXPECT_EQ(message.head[1], 300 - 256);
  EXPECT_EQ(message.head[2], 1);
  std::uint64_t time = 0;
  for (int i = 0; i < 8; ++i) time |= std::uint64_t{message.head[5 + i]} << 8 * i;
  EXPECT_EQ(time, 1'700'000'000'000'000'000u);
  EXPECT_EQ((*message.body)[1], 1);  // CDR, little endian

  gateway_.on_text(first, R"({"op":"unsubscribe","subscriptionIds":[300]})");
  hear(Channel::kState, distinct<state_t>());
  EXPECT_TRUE(first.outbox.empty());
}

TEST_F(GatewayTest, AnswersNonsenseAndGoesOn) {
  Client& client = joined(Role::kObserver);
  for (const char* text :
       {"", "{", "[]", "1", R"({"op":7})", R"({"op":"fly"})", R"({"op":"subscribe"})",
        R"({"op":"subscribe","subscriptions":[7]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":0}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":4000000000}]})",
        R"({"op":"unsubscribe","subscriptionIds":[1]})", R"({"op":"getParameters"})",
        R"({"op":"subscribeParameterUpdates","parameterNames":[1]})",
        R"({"op":"setParameters","parameters":[{"name":"structure.mass_kg","value":1}]})",
        "{\"op\":\"\xff\"}"}) {
    const json answer = told(client, text);
    EXPECT_EQ(answer.value("op", ""), "status") << text << answer;
    EXPECT_EQ(answer.value("level", 0), 2) << text;
  }
  EXPECT_EQ(gateway_.counters().client_errors, 15);
  gateway_.on_text(client, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})");
  hear(Channel::kState, distinct<state_t>());
  EXPECT_FALSE(client.outbox.empty());
}

TEST_F(GatewayTest, HandsRequestsOfOperatorsToTheOwner) {
  Client& client = joined(Role::kOperator);
  advertise(client);
  EXPECT_TRUE(texts(client).empty());
  publish(client, 9, R"({"verb":"ARM"})");
  EXPECT_TRUE(sent_.empty());  // nobody is there
  EXPECT_NE(texts(client).at(0)["message"].get<std::string>().find("no owner"), std::string::npos);

  hear_owner();
  publish(client, 9, R"({"verb":"ARM"})");
  ASSERT_EQ(sent_.size(), 1u);
  EXPECT_EQ(sent_[0].verb, request_t::ARM);
  EXPECT_EQ(sent_[0].owner_epoch, 77);
  EXPECT_NE(sent_[0].writer, 0);
  EXPECT_EQ(sent_[0].counter, 1);

  // The next one waits until the first is answered; what is not answered is sent again.
  publish(client, 9, R"({"verb":"PAUSE","writer":5,"counter":8})");
  EXPECT_EQ(sent_.size(), 1u);
  now_ += 250 * kMs;
  gateway_.on_timer(now_, 0);
  ASSERT_EQ(sent_.size(), 2u);
  EXPECT_EQ(sent_[1].verb, request_t::ARM);
  reply_t reply{};
  reply.request_writer = sent_[0].writer;
  reply.request_counter = 1;
  hear(Channel::kReply, reply);
  ASSERT_EQ(sent_.size(), 3u);
  EXPECT_EQ(sent_[2].writer, 5);
  EXPECT_EQ(sent_[2].counter, 8);

  texts(client);
  for (int i = 0; i < 2 * kMostAsks; ++i) gateway_.on_timer(now_ += kAskAgain, 0);
  EXPECT_EQ(sent_.size(), 2u + kMostAsks);
  const auto all = texts(client);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_NE(all[0]["message"].get<std::string>().find("does not answer"), std::string::npos);
}

TEST_F(GatewayTest, DisarmWaitsForNobodyAndNothingComesAfterIt) {
  Client& client = joined(Role::kOperator);
  hear_owner();
  advertise(client);
  publish(client, 9, R"({"verb":"ARM","writer":5,"counter":1})");
  publish(client, 9, R"({"verb":"PAUSE","writer":6,"counter":1})");
  publish(client, 9, R"({"verb":"DISARM","writer":7,"counter":1})");
  publish(client, 9, R"({"verb":"DISARM","writer":8,"counter":1})");
  ASSERT_EQ(sent_.size(), 2u);
  EXPECT_EQ(sent_[1].writer, 7);
  const auto told_of = texts(client);
  ASSERT_EQ(told_of.size(), 1u);
  EXPECT_NE(told_of[0]["message"].get<std::string>().find("forgets 2"), std::string::npos);

  const auto answer = [&](std::int64_t writer) {
    reply_t reply{};
    reply.request_writer = writer;
    reply.request_counter = 1;
    hear(Channel::kReply, reply);
  };
  answer(5);  // the ARM had arrived after all
  EXPECT_EQ(sent_.size(), 2u);
  answer(7);
  ASSERT_EQ(sent_.size(), 3u);
  EXPECT_EQ(sent_[2].writer, 8);
  answer(8);
  for (int i = 0; i < 2 * kMostAsks; ++i) gateway_.on_timer(now_ += kAskAgain, 0);
  EXPECT_EQ(sent_.size(), 3u);
  EXPECT_TRUE(texts(client).empty());
}

TEST_F(GatewayTest, DisarmFindsRoomWhereNothingElseDoes) {
  Client& client = joined(Role::kOperator);
  hear_owner();
  advertise(client);
  for (std::size_t i = 0; i < Requests::kMost; ++i) publish(client, 9, R"({"verb":"PAUSE"})");
  EXPECT_TRUE(texts(client).empty());
  publish(client, 9, R"({"verb":"ARM"})");
  EXPECT_EQ(texts(client).size(), 1u);  // too many
  publish(client, 9, R"({"verb":"DISARM"})");
  ASSERT_EQ(sent_.size(), 2u);
  EXPECT_EQ(sent_[1].verb, request_t::DISARM);
}

TEST_F(GatewayTest, ObserversOnlyLook) {
  Client& client = joined(Role::kObserver);
  hear_owner();
  advertise(client);
  publish(client, 9, R"({"verb":"ARM"})");
  EXPECT_TRUE(sent_.empty());
  EXPECT_EQ(gateway_.counters().requests_denied, 1);
  told(client, R"({"op":"setParameters","parameters":[{"name":"recording","value":true}]})");
  EXPECT_TRUE(wishes_.empty());
  EXPECT_EQ(gateway_.counters().requests_denied, 2);
}

TEST_F(GatewayTest, RefusesRequestsThatCannotBeMeant) {
  Client& client = joined(Role::kOperator);
  hear_owner();
  advertise(client);
  for (const char* text : {"", "NaN", R"({"verb":1e999})", R"({"moment_nm":[NaN,0,0]})",
                           R"({"verb":"FLY"})", R"({"moment_nm":[1e999,0,0]})"}) {
    publish(client, 9, text);
    const auto all = texts(client);
    ASSERT_EQ(all.size(), 1u) << text;
    EXPECT_EQ(all[0]["level"], 2) << text;
  }
  publish(client, 10, R"({"verb":"ARM"})");  // never advertised
  gateway_.on_binary(client, {}, now_);
  EXPECT_TRUE(sent_.empty());
}

TEST_F(GatewayTest, ParametersAreTheRigFile) {
  Client& client = joined(Role::kObserver);
  const json answer = told(
      client,
      R"({"op":"getParameters","id":"q","parameterNames":["structure.mass_kg","initial.q","no"]})");
  EXPECT_EQ(answer["id"], "q");
  ASSERT_EQ(answer["parameters"].size(), 2u);
  EXPECT_EQ(answer["parameters"][0]["value"], 2.5);
  EXPECT_EQ(answer["parameters"][1]["type"], "float64_array");
  EXPECT_GT(told(client, R"({"op":"getParameters","parameterNames":[]})")["parameters"].size(),
            50u);
}

TEST_F(GatewayTest, NamesThatAreNoParametersAreNotKept) {
  Client& watcher = joined(Role::kObserver);
  gateway_.on_text(watcher, R"({"op":"subscribeParameterUpdates","parameterNames":["recording",")" +
                                std::string(60'000, 'x') + R"("]})");
  EXPECT_EQ(watcher.watched.size(), 1u);
}

TEST_F(GatewayTest, WatchersHearOfARecording) {
  Client& watcher = joined(Role::kObserver);
  Client& other = joined(Role::kOperator);
  gateway_.on_text(watcher, R"({"op":"subscribeParameterUpdates","parameterNames":["recording"]})");
  gateway_.on_text(other,
                   R"({"op":"setParameters","parameters":[{"name":"recording","value":true}]})");
  EXPECT_EQ(wishes_, std::vector<bool>{true});
  EXPECT_TRUE(texts(other).empty());
  const auto all = texts(watcher);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0]["parameters"][0]["value"]["file"], "a.lcm");
}

TEST_F(GatewayTest, ASlowClientLosesItsOldestAndIsTold) {
  Client& slow = joined(Role::kObserver);
  Client& quick = joined(Role::kObserver);
  for (Client* client : {&slow, &quick}) {
    gateway_.on_text(*client, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})");
  }
  std::int64_t heard = 0;
  for (int i = 0; i < 20'000; ++i) {
    hear(Channel::kState, distinct<state_t>());
    while (!quick.outbox.empty()) heard += quick.outbox.take().is_data;
  }
  EXPECT_EQ(heard, 20'000);
  EXPECT_LE(slow.outbox.size(), Outbox::kRoom);
  EXPECT_GT(slow.outbox.dropped(), 1000);
  gateway_.on_timer(now_, 0);
  const auto all = texts(slow);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0]["level"], 1);
  EXPECT_NE(all[0]["message"].get<std::string>().find("too slow"), std::string::npos);
}

TEST_F(GatewayTest, AnAnswerIsNotLeftOutForASlowClient) {
  Client& slow = joined(Role::kObserver);
  const int reply_channel = static_cast<int>(Channel::kReply);
  gateway_.on_text(slow, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0},)"
                         R"({"id":2,"channelId":)" +
                             std::to_string(reply_channel) + "}]}");
  hear(Channel::kReply, distinct<reply_t>());
  for (int i = 0; i < 20'000; ++i) hear(Channel::kState, distinct<state_t>());
  EXPECT_GT(slow.outbox.dropped(), 1000);
  const Outgoing oldest = slow.outbox.take();
  EXPECT_FALSE(oldest.is_data);
  EXPECT_EQ(oldest.head[1], 2);
}

TEST_F(GatewayTest, MetricsHaveEveryDaemonThatWasHeard) {
  hear_owner();
  joined(Role::kObserver);
  const std::string text = metrics_text(gateway_, {.refused_busy = 3}, {});
  EXPECT_NE(text.find("gyrotwin_mode{rig=\"prototype_b\",service=\"integrator\"} 0\n"),
            std::string::npos);
  EXPECT_EQ(text.find("service=\"mirror\""), std::string::npos);
  EXPECT_NE(text.find("gyrotwin_gateway_clients{rig=\"prototype_b\"} 1\n"), std::string::npos);
  EXPECT_NE(text.find("reason=\"busy\"} 3\n"), std::string::npos);
}

}  // namespace
}  // namespace gyrotwin
