// What systemd hears of a daemon, on a socket in its place.
#include "services/runtime/service_manager.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "services/runtime/daemon.hpp"

namespace gyrotwin {
namespace {

using namespace std::chrono_literals;
using Messages = std::vector<std::string>;

/// The other end of $NOTIFY_SOCKET while it lives, with a watchdog of 4 s.
class FakeSystemd {
 public:
  FakeSystemd() : path_(testing::TempDir() + "gyrotwin_notify_" + std::to_string(getpid())) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
    set_watchdog(4s);
  }
  ~FakeSystemd() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
    close(socket_);
    std::filesystem::remove(path_);
  }
  FakeSystemd(const FakeSystemd&) = delete;
  FakeSystemd& operator=(const FakeSystemd&) = delete;

  static void set_watchdog(std::chrono::microseconds time) {
    setenv("WATCHDOG_USEC", std::to_string(time.count()).c_str(), 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  }

  /// What has come since the last time.
  Messages heard() const {
    Messages messages;
    char text[512];
    for (ssize_t n; (n = recv(socket_, text, sizeof text, MSG_DONTWAIT)) >= 0;) {
      messages.emplace_back(text, static_cast<std::size_t>(n));
    }
    return messages;
  }

  /// Up to and with a message that begins so; the limit is only met when the test fails.
  Messages heard_until(const std::string& begin, const std::function<void()>& meanwhile) const {
    Messages all;
    for (int i = 0; i < 20'000; ++i) {
      for (const std::string& message : heard()) all.push_back(message);
      for (const std::string& message : all) {
        if (message.starts_with(begin)) return all;
      }
      meanwhile();
      std::this_thread::sleep_for(1ms);
    }
    ADD_FAILURE() << "no " << begin;
    return all;
  }

 private:
  std::string path_;
  int socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

constexpr ServiceManager::Time kStart{100s};

TEST(ServiceManager, IsSilentWithoutSystemd) {
  unsetenv("NOTIFY_SOCKET");
  ServiceManager manager;
  EXPECT_FALSE(manager.listens());
  manager.hear_rounds(1, kStart);
  manager.show("RUNNING", kStart);
  manager.stopping();
}

TEST(ServiceManager, TheFirstRoundIsReady) {
  const FakeSystemd systemd;
  ServiceManager manager;
  EXPECT_TRUE(manager.listens());
  manager.hear_rounds(0, kStart);
  EXPECT_EQ(systemd.heard(), Messages{});
  manager.hear_rounds(3, kStart + 1h);
  EXPECT_EQ(systemd.heard(), Messages{"READY=1"});
}

TEST(ServiceManager, FeedsTheWatchdogFourTimesInItsTime) {
  const FakeSystemd systemd;
  ServiceManager manager;
  for (std::uint64_t round = 1; round <= 80; ++round) {
    manager.hear_rounds(round, kStart + round * 100ms);
  }
  // Ready at 0.1 s, then each full second of the 7.9 that follow.
  EXPECT_EQ(systemd.heard(), (Messages{"READY=1", "WATCHDOG=1", "WATCHDOG=1", "WATCHDOG=1",
                                       "WATCHDOG=1", "WATCHDOG=1", "WATCHDOG=1", "WATCHDOG=1"}));
}

TEST(ServiceManager, AStuckTickThreadIsNotFed) {
  const FakeSystemd systemd;
  ServiceManager manager;
  manager.hear_rounds(1, kStart);
  manager.hear_rounds(2, kStart + 2s);
  EXPECT_EQ(systemd.heard(), (Messages{"READY=1", "WATCHDOG=1"}));
  for (int s = 3; s < 60; ++s) manager.hear_rounds(2, kStart + std::chrono::seconds(s));
  EXPECT_EQ(systemd.heard(), Messages{});
  manager.hear_rounds(3, kStart + 60s);
  EXPECT_EQ(systemd.heard(), Messages{"WATCHDOG=1"});
}

TEST(ServiceManager, AnothersWatchdogIsNotFed) {
  const FakeSystemd systemd;
  setenv("WATCHDOG_PID", "1", 1);
  ServiceManager manager;
  manager.hear_rounds(1, kStart);
  manager.hear_rounds(2, kStart + 1h);
  EXPECT_EQ(systemd.heard(), Messages{"READY=1"});
}

TEST(ServiceManager, ShowsNewsOnceASecondAtMost) {
  const FakeSystemd systemd;
  ServiceManager manager;
  manager.show("HELD", kStart);
  manager.show("HELD", kStart + 5s);
  EXPECT_EQ(systemd.heard(), Messages{"STATUS=HELD"});
  manager.show("RUNNING", kStart + 900ms);
  EXPECT_EQ(systemd.heard(), Messages{});
  manager.show("RUNNING", kStart + 1s);
  EXPECT_EQ(systemd.heard(), Messages{"STATUS=RUNNING"});
}

// libsystemd's own function waits then, and with it the log and the signals would.
TEST(ServiceManager, AManagerThatDoesNotReadHoldsUpNothing) {
  const FakeSystemd systemd;
  ServiceManager full, late;
  for (std::uint64_t round = 1; round < 10'000; ++round) {
    full.hear_rounds(round, kStart + round * 1s);
  }
  late.hear_rounds(1, kStart);
  late.show("HELD", kStart);
  late.stopping();
  EXPECT_EQ(systemd.heard().front(), "READY=1");
  // Once there is room it is told all the same.
  late.hear_rounds(2, kStart);
  late.show("HELD", kStart);
  late.stopping();
  EXPECT_EQ(systemd.heard(), (Messages{"READY=1", "STATUS=HELD", "STOPPING=1"}));
}

TEST(ServiceManager, AnAddressMayBeAbstract) {
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const std::string name = "gyrotwin_" + std::to_string(getpid());
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  ASSERT_EQ(bind(socket, reinterpret_cast<sockaddr*>(&address), size), 0);
  setenv("NOTIFY_SOCKET", ("@" + name).c_str(), 1);
  ServiceManager().stopping();
  unsetenv("NOTIFY_SOCKET");
  char text[32];
  EXPECT_EQ(recv(socket, text, sizeof text, MSG_DONTWAIT), 10);
  close(socket);
}

TEST(ServiceManager, SaysOnceThatItEnds) {
  const FakeSystemd systemd;
  ServiceManager manager;
  manager.stopping();
  manager.stopping();
  EXPECT_EQ(systemd.heard(), Messages{"STOPPING=1"});
}

TEST(DaemonUnderSystemd, IsReadyFedShownAndStopping) {
  const FakeSystemd systemd;
  systemd.set_watchdog(4ms);  // each turn of the housekeeping thread may feed
  Daemon daemon("prog");
  systemd.heard_until("READY=1", [&] { EXPECT_TRUE(daemon.next_round()); });
  for (int fed = 0; fed < 3; ++fed) {
    systemd.heard_until("WATCHDOG=1", [&] { daemon.next_round(); });
  }
  systemd.heard_until("STATUS=RUNNING: 3 clients?",
                      [&] { daemon.show("{}: {} clients\n", "RUNNING", 3); });
  daemon.stop();
  systemd.heard_until("STOPPING=1", [] {});
  EXPECT_FALSE(daemon.next_round());
}

// Its housekeeping thread lives: three texts are shown while the tick thread goes round no more.
TEST(DaemonUnderSystemd, IsNotFedWhileTheTickThreadIsStuck) {
  const FakeSystemd systemd;
  systemd.set_watchdog(4ms);
  Daemon daemon("prog");
  systemd.heard_until("READY=1", [&] { daemon.next_round(); });
  systemd.heard_until("WATCHDOG=1", [&] { daemon.next_round(); });
  Messages since;
  for (int i = 0; i < 3; ++i) {
    const std::string text = "turn " + std::to_string(i);
    const auto heard = systemd.heard_until("STATUS=" + text, [&] { daemon.show("{}", text); });
    since.insert(since.end(), heard.begin(), heard.end());
  }
  // One is due when it gets stuck, for the rounds before.
  EXPECT_LE(std::ranges::count(since, "WATCHDOG=1"), 1);
}

}  // namespace
}  // namespace gyrotwin
