// gyrotwin netcheck between two hosts: what it finds is what the line between them has done,
// counted by the line itself. No figure here depends on how fast this machine is.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>

#include "services/runtime/probe.hpp"
#include "tests/support/bad_line.hpp"
#include "tests/support/lab.hpp"

namespace gyrotwin::netcheck {
namespace {

using Json = nlohmann::json;
using support::BadLine;
using support::Process;

constexpr int kPort = 8671;  // prototype_b's

/// Size of a probe's datagram on prototype_b's network.
int size_of(const Probe& probe) {
  Frame frame;
  return static_cast<int>(ProbeFormat("PROTOTYPE_B", 1, {}).write(frame, probe));
}

class NetcheckTest : public ::testing::Test {
 protected:
  NetcheckTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    ::setenv("GYROTWIN_KEYS", folder_.c_str(), 1);
    create_key(key_path("prototype_b"));
  }
  ~NetcheckTest() override { std::filesystem::remove_all(folder_); }

  /// `gyrotwin-netcheck ARGUMENTS` on a host of the line.
  std::unique_ptr<Process> start(int host, const std::vector<std::string>& arguments,
                                 const std::string& ttl = "1") {
    std::vector<std::string> words = line.on_host(host);
    words.push_back(std::string(GYROTWIN_BIN) + "/gyrotwin-netcheck");
    words.insert(words.end(), arguments.begin(), arguments.end());
    words.insert(words.end(), {"--rig", "prototype_b", "--set", "network.interface=lab0", "--set",
                               "network.ttl=" + ttl});
    return std::make_unique<Process>(words, folder_ / std::to_string(++started_));
  }

  static void expect_to_say(Process& process, const std::string& text) {
    for (int i = 0; i < 3000 && process.running(); ++i) {
      if (process.output().find(text) != std::string::npos) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_NE(process.output().find(text), std::string::npos) << process.output();
  }

  std::unique_ptr<Process> start_listener(const std::string& ttl = "1") {
    auto listener = start(1, {"listen"}, ttl);
    expect_to_say(*listener, "answers on");
    return listener;
  }

  /// What `--json` says where so many listen; `code` has the exit code. Its patience is longer than
  /// this machine may be held up; where nothing is lost it is not needed.
  Json check(int listeners, std::vector<std::string> arguments, const std::string& ttl = "1") {
    arguments.insert(arguments.end(),
                     {"--json", "--patience", "15", "--hosts", std::to_string(listeners)});
    return run(arguments, ttl);
  }

  /// What `--json` says where nobody answers.
  Json check_in_vain(const std::string& ttl = "1") {
    return run({"--json", "--duration", "0.2"}, ttl);
  }

  Json run(const std::vector<std::string>& arguments, const std::string& ttl) {
    const auto asker = start(0, arguments, ttl);
    code = asker->wait(120.0);
    Json json = Json::parse(asker->output(), nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << asker->output();
    return json;
  }

  static bool advises(const Json& json, const std::string& what) {
    for (const Json& advice : json["advice"]) {
      if (advice["text"].get<std::string>().find(what) != std::string::npos) return true;
    }
    return false;
  }

  std::filesystem::path folder_;
  int started_ = 0;
  BadLine line{kPort, {size_of(Ping{}), size_of(Answer{})}};
  int code = -1;
};

// 3 ms each way; each 20th ping and each 25th answer lost, each 30th ping and 35th answer twice,
// each 33rd ping and 40th answer overtaken.
TEST_F(NetcheckTest, FindsWhatTheLineHasDone) {
  constexpr std::int64_t kDelay = 3'000'000;
  line.start({{{.lose_each = 20, .double_each = 30, .hold_each = 33},
               {.lose_each = 25, .double_each = 35, .hold_each = 40}}},
             kDelay);
  const auto listener = start_listener();
  const Json json = check(1, {"--duration", "3", "--rate", "500"});
  const auto [out, back] = line.stop();
  ASSERT_EQ(json["lines"].size(), 1u) << json.dump(1) << listener->output();
  const Json& found = json["lines"][0];

  // The sockets have lost nothing, so that all of it is the line's.
  ASSERT_EQ(found["out"]["kernel_dropped"], 0);
  ASSERT_EQ(found["back"]["kernel_dropped"], 0);
  EXPECT_EQ(json["counters"]["send_failed"], 0);
  EXPECT_GT(out.lost, 0);
  EXPECT_GT(out.held, 0);
  EXPECT_GT(back.doubled, 0);
  // The last one may be held for good: nothing goes by any more that would free it.
  const auto expect_way = [](const Json& way, const support::LineCounts& did) {
    EXPECT_EQ(way["sent"], did.came);
    EXPECT_GE(way["lost"], did.lost);
    EXPECT_LE(way["lost"], did.lost + 1);
    EXPECT_GE(way["overtaken"], did.held - 1);
    EXPECT_LE(way["overtaken"], did.held);
    EXPECT_EQ(way["repeats"], did.doubled);
    EXPECT_EQ(way["ttl_arrived_min"], 1);
    EXPECT_EQ(way["ttl_arrived_max"], 1);
  };
  expect_way(found["out"], out);
  expect_way(found["back"], back);
  EXPECT_EQ(found["unanswered"].get<std::int64_t>(),
            found["out"]["lost"].get<std::int64_t>() + found["back"]["lost"].get<std::int64_t>());
  EXPECT_EQ(found["out"]["sent"].get<std::int64_t>() + found["slept_through"].get<std::int64_t>(),
            found["ticks"].get<std::int64_t>());

  // The delay is a lower bound, whatever else happens.
  EXPECT_GE(found["network_s"]["p50"].get<double>(), 2e-9 * kDelay);
  // Both hosts have one clock: what is said of its offset must hold for 0.
  EXPECT_LE(std::abs(found["clock_offset_s"].get<double>()),
            found["clock_uncertainty_s"].get<double>());
  EXPECT_GE(found["clock_uncertainty_s"].get<double>(), 1e-9 * kDelay);

  EXPECT_EQ(found["came_in_on"], "lab0");
  EXPECT_EQ(found["there"]["address"], "198.51.100.2");
  EXPECT_EQ(found["there"]["mtu"], 1500);
  EXPECT_EQ(found["good"], false);
  EXPECT_EQ(found["good_for_hz"], 0.0) << "9 % unanswered";
  EXPECT_TRUE(advises(json, "lost on the way"));
  EXPECT_TRUE(advises(json, "came twice"));
  EXPECT_TRUE(advises(json, "overtaken"));
  EXPECT_EQ(code, 1);
}

TEST_F(NetcheckTest, FindsNothingOnAGoodLine) {
  line.start({}, 0);
  const auto listener = start_listener();
  const Json json = check(1, {"--duration", "1", "--rate", "100"});
  const auto [out, back] = line.stop();
  ASSERT_EQ(json["lines"].size(), 1u) << json.dump(1) << listener->output();
  const Json& found = json["lines"][0];
  ASSERT_EQ(found["out"]["kernel_dropped"], 0);
  EXPECT_EQ(found["out"]["sent"], out.came);
  for (const char* way : {"out", "back"}) {
    EXPECT_EQ(found[way]["lost"], 0);
    EXPECT_EQ(found[way]["overtaken"], 0);
    EXPECT_EQ(found[way]["repeats"], 0);
  }
  EXPECT_EQ(back.came, out.came) << "one answer for each ping";
  EXPECT_EQ(code, found["good"].get<bool>() ? 0 : 1);
  EXPECT_EQ(found["good"], json["good"]);

  listener->signal(SIGINT);
  EXPECT_EQ(listener->wait(), 0);
  EXPECT_NE(listener->output().find("0 with a wrong signature"), std::string::npos)
      << listener->output();
}

TEST_F(NetcheckTest, SaysThatTheTtlsDiffer) {
  line.start({}, 0);
  const auto listener = start_listener("3");
  const Json json = check(1, {"--duration", "0.2"});
  ASSERT_EQ(json["lines"].size(), 1u) << json.dump(1);
  EXPECT_EQ(json["lines"][0]["back"]["ttl_arrived_min"], 3);
  EXPECT_TRUE(advises(json, "network.ttl is 1 on"));
}

TEST_F(NetcheckTest, ATtlOfZeroReachesNobody) {
  line.start({}, 0);
  const auto listener = start_listener();
  const Json json = check_in_vain("0");
  EXPECT_TRUE(json["lines"].empty());
  EXPECT_TRUE(advises(json, "network.ttl is 0"));
  EXPECT_EQ(code, 1);
  EXPECT_EQ(line.stop()[0].came, 0) << "nothing has left the host";
}

TEST_F(NetcheckTest, AnotherKeyIsNotAnsweredAndBothSidesSayWhy) {
  line.start({}, 0);
  const auto listener = start_listener();
  std::filesystem::remove(key_path("prototype_b"));
  create_key(key_path("prototype_b"));
  const Json json = check_in_vain();
  EXPECT_TRUE(json["lines"].empty());
  EXPECT_TRUE(advises(json, "another key"));
  EXPECT_EQ(code, 1);
  const auto [out, back] = line.stop();
  EXPECT_GT(out.others, 0) << "it has asked";
  EXPECT_EQ(back.came + back.others, 0) << "and was not answered";
  expect_to_say(*listener, "asks with another key");
  listener->signal(SIGINT);
  EXPECT_EQ(listener->wait(), 0);
}

TEST_F(NetcheckTest, SaysThatTheInterfaceIsDown) {
  std::string down;
  for (const std::string& word : line.on_host(0)) down += word + " ";
  ASSERT_EQ(std::system((down + "ip link set lab0 down").c_str()), 0);
  const Json json = check_in_vain();
  EXPECT_NE(json["broken"].get<std::string>().find("`ip link set lab0 up`"), std::string::npos);
  EXPECT_EQ(code, 1);
}

TEST_F(NetcheckTest, MeasuresTheLineToEachListener) {
  line.start({}, 0);
  const auto first = start_listener(), second = start_listener();
  const Json json = check(2, {"--duration", "0.2"});
  const auto [out, back] = line.stop();
  ASSERT_EQ(json["lines"].size(), 2u) << json.dump(1);
  std::int64_t answered = 0;
  for (const Json& found : json["lines"]) {
    EXPECT_EQ(found["out"]["lost"], 0);
    answered += found["back"]["sent"].get<std::int64_t>();
  }
  EXPECT_EQ(answered, out.came) << "each ping is for one of them";
  EXPECT_EQ(back.came, out.came);
}

TEST_F(NetcheckTest, MissesTheHostThatDoesNotListen) {
  line.start({}, 0);
  const auto listener = start_listener();
  const Json json = run({"--json", "--duration", "0.2", "--hosts", "2"}, "1");
  EXPECT_EQ(json["complete"], false);
  EXPECT_TRUE(advises(json, "nobody listens"));
  EXPECT_EQ(code, 1);
}

TEST_F(NetcheckTest, MeasuresOneHostAlone) {
  const Json json = check(1, {"--local", "--duration", "0.5", "--rate", "200"}, "0");
  ASSERT_EQ(json["lines"].size(), 1u) << json.dump(1);
  const Json& found = json["lines"][0];
  EXPECT_EQ(found["out"]["lost"], 0);
  EXPECT_EQ(found["back"]["lost"], 0);
  EXPECT_EQ(found["ticks"], 100);
  EXPECT_EQ(code, found["good"].get<bool>() ? 0 : 1);
}

TEST_F(NetcheckTest, IsAskedWronglyWithTwo) {
  EXPECT_EQ(start(0, {"--rate", "20000"})->wait(), 2);
  EXPECT_EQ(start(0, {"--hosts", "0"})->wait(), 2);
  EXPECT_EQ(start(0, {"listn"})->wait(), 2);
  EXPECT_EQ(start(0, {"--port", "7671"})->wait(), 2) << "the rig's own";
}

}  // namespace
}  // namespace gyrotwin::netcheck
