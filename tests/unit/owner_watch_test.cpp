// An owner that is waited for, heard, silent and heard again, by the clock of whoever depends on
// it.
#include "services/runtime/owner_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "services/runtime/text.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// What the own STATUS says at a time; empty: nothing, the owner is there.
std::string said(OwnerWatch& watch, std::int64_t now) {
  status_t own{};
  const bool lost = watch.lost(now, own);
  EXPECT_EQ(lost, own.text[0] != 0);
  return get_text(own.text);
}

TEST(OwnerWatch, NamesWhomToStart) {
  Daemon daemon("owner_watch_test");
  OwnerWatch watch(daemon);
  EXPECT_EQ(said(watch, kSecond),
            "no owner is heard: start gyrotwin-integrator or gyrotwin-hardware with the same rig "
            "file");
  status_t status{};
  for (const auto& [service, program] : {std::pair{+status_t::HARDWARE, "gyrotwin-hardware"},
                                         {+status_t::INTEGRATOR, "gyrotwin-integrator"}}) {
    status.service = service;
    watch.hear(status, 10 * kSecond);
    EXPECT_EQ(said(watch, 10 * kSecond + kSecond / 2), "");
    EXPECT_EQ(said(watch, 10 * kSecond + kSecond / 2 + 1),
              std::string("no owner is heard: start ") + program + " with the same rig file");
    EXPECT_EQ(watch.last().service, service);
  }
}

// Two owners of one rig are heard by turns, ten times a second each.
TEST(OwnerWatch, WritesAboutTwoOwnersOnceEach) {
  testing::internal::CaptureStderr();
  {
    Daemon daemon("owner_watch_test");
    OwnerWatch watch(daemon);
    for (int i = 0; i < 100; ++i) {
      status_t status{};
      status.header.epoch = 1 + i % 2;
      status.pid = 1000 + i % 2;
      status.mode = i < 50 ? +status_t::MODE_RUNNING : +status_t::MODE_SAFE_STOP;
      watch.hear(status, i * kSecond / 20);
    }
  }
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 4) << log;  // two modes of each
}

}  // namespace
}  // namespace gyrotwin
