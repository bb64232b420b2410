#include "clients/common/asker.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "services/runtime/rig_bus.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/fake_owner.hpp"

namespace gyrotwin {
namespace {

reply_t applied() {
  reply_t reply{};
  reply.result = reply_t::APPLIED;
  return reply;
}

reply_t refused(std::string_view why) {
  reply_t reply{};
  reply.result = reply_t::REFUSED;
  set_text(reply.text, "{}", why);
  return reply;
}

request_t arm() {
  request_t request{};
  request.verb = request_t::ARM;
  return request;
}

BusConfig owner_config(const Rig& rig) { return bus_config(rig, header_t::SIMULATION); }

/// What `does` throws as NotDone.
template <class Does>
std::string not_done(Does does) {
  try {
    does();
  } catch (const NotDone& error) {
    return error.what();
  }
  return "done";
}

/// Requests without those that were sent again, which a slow machine may bring about.
std::vector<request_t> distinct_of(const std::vector<request_t>& requests) {
  std::vector<request_t> distinct;
  for (const request_t& request : requests) {
    if (distinct.empty() || distinct.back().counter != request.counter) distinct.push_back(request);
  }
  return distinct;
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

class AskerTest : public ::testing::Test {
 protected:
  Rig rig_ = fake_rig();
  MonotonicClock clock_;
};

TEST_F(AskerTest, SaysWhoAsksWhomAndTakesOnlyItsOwnAnswer) {
  FakeOwner owner(owner_config(rig_), [](const request_t&, std::int64_t&) { return applied(); });
  Asker asker(rig_, clock_);
  for (int i = 0; i < 2; ++i) {
    const reply_t reply = asker.ask(arm());
    EXPECT_EQ(reply.result, reply_t::APPLIED);
    EXPECT_EQ(reply.applied_tick, 5) << "an answer to somebody else was taken";
  }
  const auto requests = distinct_of(owner.stop());
  ASSERT_EQ(requests.size(), 2u);
  for (const request_t& request : requests) {
    EXPECT_EQ(request.verb, request_t::ARM);
    EXPECT_EQ(request.header.source, header_t::OPERATOR);
    EXPECT_EQ(request.owner_epoch, FakeOwner::kEpoch);
    EXPECT_EQ(request.writer, requests[0].writer);
  }
  EXPECT_GT(requests[1].counter, requests[0].counter);
}

TEST_F(AskerTest, SendsTheSameRequestUntilItIsAnswered) {
  int heard = 0;
  FakeOwner owner(owner_config(rig_),
                  [&](const request_t&, std::int64_t&) -> std::optional<reply_t> {
                    if (++heard < 3) return {};
                    return applied();
                  });
  Asker asker(rig_, clock_);
  EXPECT_EQ(asker.ask(arm()).result, reply_t::APPLIED);
  const auto& requests = owner.stop();
  ASSERT_GE(requests.size(), 3u);
  for (const request_t& request : requests) {
    EXPECT_EQ(request.counter, requests[0].counter);
    EXPECT_EQ(request.header.sequence, requests[0].header.sequence);
    EXPECT_EQ(request.header.epoch, requests[0].header.epoch);
  }
}

// As an integrator resets: the new run is said in STATUS before the request is answered.
TEST_F(AskerTest, DoesNotAskTwiceWhenTheRequestItselfBeginsANewRun) {
  FakeOwner owner(owner_config(rig_), [](const request_t&, std::int64_t& epoch) {
    ++epoch;
    return applied();
  });
  Asker asker(rig_, clock_);
  const reply_t reply = asker.ask(arm());
  EXPECT_EQ(reply.result, reply_t::APPLIED);
  EXPECT_EQ(reply.header.epoch, FakeOwner::kEpoch + 1);
  EXPECT_EQ(distinct_of(owner.stop()).size(), 1u);
}

TEST_F(AskerTest, AsksTheRunThatItHasBegun) {
  FakeOwner owner(owner_config(rig_), [](const request_t& request, std::int64_t& epoch) {
    if (request.owner_epoch != epoch) return refused("another run");
    ++epoch;
    return applied();
  });
  Asker asker(rig_, clock_);
  EXPECT_EQ(asker.ask(arm()).result, reply_t::APPLIED);
  EXPECT_EQ(asker.ask(arm()).result, reply_t::APPLIED);
  EXPECT_EQ(distinct_of(owner.stop()).size(), 2u) << "and nothing was refused on the way";
}

TEST_F(AskerTest, AsksTheNewRunWhenTheOldOneIsOver) {
  FakeOwner owner(owner_config(rig_), [](const request_t& request, std::int64_t& epoch) {
    epoch = FakeOwner::kEpoch + 1;
    return request.owner_epoch == epoch ? applied() : refused("another run");
  });
  Asker asker(rig_, clock_);
  EXPECT_EQ(asker.ask(arm()).result, reply_t::APPLIED);
  const auto requests = distinct_of(owner.stop());
  ASSERT_EQ(requests.size(), 2u);
  EXPECT_EQ(requests[1].owner_epoch, FakeOwner::kEpoch + 1);
  EXPECT_GT(requests[1].counter, requests[0].counter);
}

TEST_F(AskerTest, FollowsNewRunsOnlyOnce) {
  FakeOwner owner(owner_config(rig_), [](const request_t&, std::int64_t& epoch) {
    ++epoch;
    return refused("another run");
  });
  Asker asker(rig_, clock_);
  EXPECT_EQ(asker.ask(arm()).result, reply_t::REFUSED);
  EXPECT_EQ(distinct_of(owner.stop()).size(), 2u);
}

TEST_F(AskerTest, ARefusalIsNotDoneWithTheOwnersReason) {
  FakeOwner owner(owner_config(rig_),
                  [](const request_t&, std::int64_t&) { return refused("no controller"); });
  Asker asker(rig_, clock_);
  EXPECT_EQ(not_done([&] { ask_or_throw(asker, arm(), "arm"); }), "arm refused: no controller");
  EXPECT_EQ(distinct_of(owner.stop()).size(), 1u) << "a refusal by the run that was asked is final";
}

TEST_F(AskerTest, GivesUpOnAnOwnerThatDoesNotAnswer) {
  FakeOwner owner(owner_config(rig_));
  Asker asker(rig_, clock_);
  const std::string why = not_done([&] { asker.ask(arm()); });
  EXPECT_TRUE(contains(why, "process 4711") && contains(why, "does not answer")) << why;
  EXPECT_EQ(owner.stop().size(), static_cast<std::size_t>(kMostAsks));
}

TEST_F(AskerTest, NamesRigAddressAndFixWhenNoOwnerIsHeard) {
  Asker asker(rig_, clock_);
  const std::string why = not_done([&] { asker.owner(); });
  EXPECT_TRUE(contains(why, "rig fake") && contains(why, "this host only (lo, ") &&
              contains(why, "gyrotwin integrator --rig fake.toml"))
      << why;
  EXPECT_EQ(asker.suspicion(), "");
}

TEST_F(AskerTest, SuspectsTheRigWhenAnotherOneSpeaksThere) {
  Rig other = rig_;
  other.id = rig_.id + 1;
  FakeOwner owner(owner_config(other));
  Asker asker(rig_, clock_);
  const std::string why = not_done([&] { asker.owner(); });
  EXPECT_TRUE(contains(why, "messages of other rigs")) << why;
}

TEST_F(AskerTest, SuspectsTheKeyWhenSignaturesAreWrong) {
  const auto keys =
      std::filesystem::temp_directory_path() / ("gyrotwin_asker_test." + std::to_string(getpid()));
  setenv("GYROTWIN_KEYS", keys.c_str(), 1);
  create_key(key_path(rig_.name));
  rig_.network.sign = true;

  FakeOwner owner(test_config(test_key()));
  Asker asker(rig_, clock_);
  const std::string why = not_done([&] { asker.owner(); });
  EXPECT_TRUE(contains(why, "need the same key")) << why;
  EXPECT_TRUE(contains(why, key_path(rig_.name).string())) << why;
  std::filesystem::remove_all(keys);
}

}  // namespace
}  // namespace gyrotwin
