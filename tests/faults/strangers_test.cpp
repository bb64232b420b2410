// Rows about strangers on the network: they flood it, and they play back what they have heard.
#include <signal.h>

#include <algorithm>
#include <chrono>

#include "services/runtime/text.hpp"
#include "tests/faults/fixture.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin::faults {

namespace {

/// Sends any bytes to a rig's group from the operators' host.
class Stranger {
 public:
  explicit Stranger(Hosts& hosts)
      : prefix_(hosts.rig.network.prefix + "/"), sockets_(hosts.at_operator.inside([&hosts] {
          return open_sockets(bus_config(hosts.rig, header_t::OPERATOR), 1 << 18);
        })) {}

  void send(const Bytes& bytes) {
    sent_ += ::send(sockets_.sender.get(), bytes.data(), bytes.size(), MSG_DONTWAIT) >= 0;
  }
  /// What was heard, byte for byte but for the packet number.
  void send_again(const Heard& heard) {
    send(short_message(prefix_ + std::string(spec(heard.channel).suffix), heard.payload));
  }
  std::int64_t sent() const { return sent_; }

 private:
  std::string prefix_;
  MulticastSockets sockets_;
  std::int64_t sent_ = 0;
};

/// A stranger's: random, cut short, unsigned; of one kind each.
std::vector<Bytes> garbage(const Rig& rig) {
  std::mt19937_64 random(Hosts::kSeed);
  const auto any = [&random] { return static_cast<std::uint8_t>(random()); };
  Bytes noise(700);
  std::generate(noise.begin(), noise.end(), any);
  std::vector<Bytes> all{Bytes{}, noise};
  for (const Channel channel :
       {Channel::kState, Channel::kCommand, Channel::kRequest, Channel::kIntegratorStatus}) {
    const std::string name = rig.network.prefix + "/" + std::string(spec(channel).suffix);
    Bytes payload = distinct_payload(channel, rig.id);
    all.push_back(short_message(name, payload));  // authentic but for the signature
    payload.pop_back();
    all.push_back(short_message(name, payload));
  }
  return all;
}

/// All requests and the newest commands of a record, in its order.
std::vector<Heard> orders(const std::vector<Heard>& record) {
  constexpr std::int64_t kNewest = 200;
  const auto commands = std::count_if(record.begin(), record.end(), [](const Heard& heard) {
    return heard.channel == Channel::kCommand;
  });
  std::vector<Heard> some;
  std::int64_t number = 0;
  for (const Heard& heard : record) {
    const bool command = heard.channel == Channel::kCommand && ++number > commands - kNewest;
    if (command || heard.channel == Channel::kRequest) some.push_back(heard);
  }
  return some;
}

}  // namespace

TEST_F(Patient, Flood) {
  row("a stranger's flood: 20,000 datagrams a second, malformed and unsigned", "balances on",
      "RUNNING; `ctl status`: \"without the right signature\", \"malformed\"; a push is answered",
      kNothing);
  constexpr int kBursts = 3000, kBurst = 20;
  std::atomic<bool> enough{false};
  Stranger stranger(hosts());
  const std::vector<Bytes> kinds = garbage(hosts().rig);
  std::thread flood([&] {
    auto next = std::chrono::steady_clock::now();
    for (int burst = 0; burst < kBursts && !enough; ++burst) {
      for (int i = 0; i < kBurst; ++i) {
        stranger.send(kinds[static_cast<std::size_t>(burst * kBurst + i) % kinds.size()]);
      }
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
    }
  });
  const status_t before = owner_status();
  EXPECT_NO_FATAL_FAILURE(keeps_balancing());
  EXPECT_EQ(hosts().ask("disturb", {"step", "--roll", "0.001", "--duration", "0.1"}), 0)
      << hosts().said;
  EXPECT_NO_FATAL_FAILURE(asks({"status"}, 0, "without the right signature"));
  EXPECT_NE(told_.find("malformed"), std::string::npos) << told_;
  const auto bad = [](const status_t& s) { return s.malformed + s.unauthentic; };
  EXPECT_TRUE(hosts().operator_ear.owner_status([&](const status_t& status) {
    return bad(status) - bad(before) > 10'000;
  })) << "it was no flood";
  enough = true;
  flood.join();
  const status_t after = owner_status();
  std::printf("%lld sent, %lld judged by the owner, %lld lost in its buffer\n",
              static_cast<long long>(stranger.sent()),
              static_cast<long long>(bad(after) - bad(before)),
              static_cast<long long>(after.kernel_dropped - before.kernel_dropped));
}

TEST_F(Patient, OldMessagesPlayedBack) {
  row("up to 200 recorded COMMANDs and all REQUESTs played back, in the same run and after a "
      "restart of "
      "the owner",
      "balances on; none of them acts",
      "RUNNING; `ctl status`: \"came too late\"; after the restart \"for another run\"", kNothing);
  Stranger stranger(hosts());
  const auto play = [&](const std::vector<Heard>& heard) {
    for (const Heard& message : heard) stranger.send_again(message);
  };
  // A push that was, among the requests; it is over, so that it would show again.
  ASSERT_EQ(hosts().ask("disturb", {"step", "--roll", "0.001"}), 0) << hosts().said;
  ASSERT_EQ(hosts().ask("disturb", {"clear"}), 0) << hosts().said;
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  const std::vector<Heard> recorded = orders(hosts().operator_ear.record());
  ASSERT_GT(recorded.size(), 100U);
  const status_t before = owner_status();
  play(recorded);
  ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));
  EXPECT_EQ(owner_status().disturbances, 0);
  constexpr auto kCommand = static_cast<std::size_t>(Channel::kCommand);
  EXPECT_GT(owner_status().reordered[kCommand], before.reordered[kCommand] + 50);
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "came too late"));

  hosts().owner->signal(SIGKILL);
  hosts().owner->wait();
  ASSERT_NO_FATAL_FAILURE(bring_back());
  play(recorded);
  ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));
  EXPECT_EQ(owner_status().disturbances, 0);
  EXPECT_GT(owner_status().refused_epoch, 0);
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "for another run"));
}

TEST_F(Patient, ARequestPlayedBackWhenItsAskerIsForgotten) {
  row("a recorded `disturb` played back after 70 others have asked",
      "balances on; it is not done "
      "again",
      "RUNNING; the stranger's is refused: \"the counter was used already\"", kNothing);
  Stranger stranger(hosts());
  ASSERT_EQ(hosts().ask("disturb", {"step", "--roll", "0.001"}), 0) << hosts().said;
  const std::vector<Heard> recorded = orders(hosts().operator_ear.record());
  for (int i = 0; i < 70; ++i) {
    ASSERT_EQ(hosts().ask("disturb", {"clear"}), 0) << hosts().said;
  }
  for (const Heard& heard : recorded) {
    if (heard.channel == Channel::kRequest) stranger.send_again(heard);
  }
  ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));
  EXPECT_EQ(owner_status().disturbances, 0);
  const std::vector<Heard> heard = hosts().operator_ear.record();
  EXPECT_TRUE(std::any_of(heard.begin(), heard.end(), [](const Heard& message) {
    return message.channel == Channel::kReply &&
           get_text(message.as<reply_t>().text).starts_with("the counter was used already");
  }));
}

}  // namespace gyrotwin::faults
