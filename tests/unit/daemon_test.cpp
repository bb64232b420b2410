#include "services/runtime/daemon.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/support/allocation_counter.hpp"

namespace gyrotwin {
namespace {

/// Standard error is somebody else's while this lives.
class Stderr {
 public:
  explicit Stderr(int descriptor) : before_(dup(STDERR_FILENO)) { dup2(descriptor, STDERR_FILENO); }
  ~Stderr() {
    dup2(before_, STDERR_FILENO);
    close(before_);
  }
  Stderr(const Stderr&) = delete;
  Stderr& operator=(const Stderr&) = delete;

 private:
  int before_;
};

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

std::vector<std::string> lines_of(int descriptor) {
  std::string all;
  char buffer[4096];
  lseek(descriptor, 0, SEEK_SET);
  for (ssize_t n; (n = read(descriptor, buffer, sizeof buffer)) > 0;) {
    all.append(buffer, static_cast<std::size_t>(n));
  }
  std::vector<std::string> lines;
  std::istringstream stream(all);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The lines that a daemon called `prog` writes while `use` has it and when it ends.
std::vector<std::string> logged(const std::function<void(Daemon&)>& use) {
  const File file(std::tmpfile(), &std::fclose);
  {
    const Stderr redirected(fileno(file.get()));
    Daemon daemon("prog");
    use(daemon);
  }
  return lines_of(fileno(file.get()));
}

/// Sleeps until it is so; the limit is only met when the test fails.
bool comes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 20'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST(DaemonLog, LinesCarryTimeProgramAndLevel) {
  const auto lines = logged([](Daemon& daemon) {
    daemon.log(LogLevel::kInfo, "tick {} took {:.1f} us", 7, 12.34);
    daemon.log(LogLevel::kWarning, "{}", "late");
    daemon.log(LogLevel::kError, "over");
  });
  ASSERT_EQ(lines.size(), 3u);
  const std::size_t time = std::string_view("2030-01-02 03:04:05.678 ").size();
  EXPECT_EQ(lines[0].substr(time), "prog info: tick 7 took 12.3 us");
  EXPECT_EQ(lines[1].substr(time), "prog warning: late");
  EXPECT_EQ(lines[2].substr(time), "prog error: over");
  EXPECT_EQ(lines[0][10], ' ');
  EXPECT_EQ(lines[0][19], '.');
}

// The journal adds time and program by itself.
TEST(DaemonLog, ForTheJournalALineHasItsPriorityAlone) {
  const File file(std::tmpfile(), &std::fclose);
  struct stat journal {};
  fstat(fileno(file.get()), &journal);
  {
    const Stderr redirected(fileno(file.get()));
    const std::string stream =
        std::to_string(journal.st_dev) + ':' + std::to_string(journal.st_ino);
    setenv("JOURNAL_STREAM", stream.c_str(), 1);
    Daemon daemon("prog");
    daemon.log(LogLevel::kInfo, "RUNNING");
    daemon.log(LogLevel::kWarning, "late");
    daemon.log(LogLevel::kError, "over");
  }
  unsetenv("JOURNAL_STREAM");
  EXPECT_EQ(lines_of(fileno(file.get())),
            (std::vector<std::string>{"<6>RUNNING", "<4>late", "<3>over"}));
}

// Who has sent it elsewhere reads it there.
TEST(DaemonLog, AnotherStreamThanTheJournalsHasTheWholeLine) {
  setenv("JOURNAL_STREAM", "1:1", 1);
  const auto lines = logged([](Daemon& daemon) { daemon.log(LogLevel::kInfo, "here"); });
  unsetenv("JOURNAL_STREAM");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].ends_with(" prog info: here")) << lines[0];
}

// As many as the ring holds, so that none may be lost; some are written at the end.
TEST(DaemonLog, LinesArriveInOrderAlsoAtTheEnd) {
  constexpr int kLines = Daemon::kLogLines;
  const auto lines = logged([](Daemon& daemon) {
    for (int i = 0; i < kLines; ++i) daemon.log(LogLevel::kInfo, "line {}", i);
  });
  ASSERT_EQ(lines.size(), std::size_t{kLines});
  for (int i = 0; i < kLines; ++i) {
    EXPECT_TRUE(lines[static_cast<std::size_t>(i)].ends_with("info: line " + std::to_string(i)));
  }
}

TEST(DaemonLog, LinesAreWrittenWhileTheDaemonRuns) {
  const File file(std::tmpfile(), &std::fclose);
  const Stderr redirected(fileno(file.get()));
  Daemon daemon("prog");
  daemon.log(LogLevel::kInfo, "soon");
  EXPECT_TRUE(comes_true([&] { return lseek(fileno(file.get()), 0, SEEK_END) > 0; }));
}

TEST(DaemonLog, LongLinesAreCut) {
  const auto lines = logged([](Daemon& daemon) {
    daemon.log(LogLevel::kInfo, "{}{}", std::string(Daemon::kLogText - 1, 'x'), "yz");
  });
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].ends_with(": " + std::string(Daemon::kLogText - 1, 'x') + "y"));
}

struct Unprintable {};

}  // namespace
}  // namespace gyrotwin

template <>
struct fmt::formatter<gyrotwin::Unprintable> {
  constexpr auto parse(format_parse_context& context) { return context.begin(); }
  auto format(const gyrotwin::Unprintable&, format_context& context) -> decltype(context.out()) {
    throw std::runtime_error("cannot be printed");
  }
};

namespace gyrotwin {
namespace {

TEST(DaemonLog, AnExceptionWhileFormattingLeavesTheFormat) {
  const auto lines =
      logged([](Daemon& daemon) { daemon.log(LogLevel::kError, "it is {} here", Unprintable{}); });
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].ends_with("error: it is {} here")) << lines[0];
}

TEST(DaemonLog, AllocatesNothing) {
  const File file(std::tmpfile(), &std::fclose);
  const Stderr redirected(fileno(file.get()));
  Daemon daemon("prog");
  const std::string text(1000, 'x');
  const AllocationCounter allocations;
  for (int i = 0; i < 1000; ++i) {
    daemon.log(LogLevel::kWarning, "tick {} {} {:.17g} {}", i, "text", 1.0 / (i + 1), text);
  }
  EXPECT_EQ(allocations.count(), 0);
}

/// A pipe that takes nothing more.
class FullPipe {
 public:
  FullPipe() {
    EXPECT_EQ(pipe2(ends_, O_NONBLOCK), 0);
    const std::string page(4096, '\n');
    while (write(ends_[1], page.data(), page.size()) > 0) {
    }
    fcntl(ends_[1], F_SETFL, 0);  // a log that is a pipe blocks its writer
  }
  ~FullPipe() {
    close_reader();
    close(ends_[1]);
  }
  FullPipe(const FullPipe&) = delete;
  FullPipe& operator=(const FullPipe&) = delete;

  int writer() const { return ends_[1]; }
  void close_reader() {
    if (ends_[0] >= 0) close(ends_[0]);
    ends_[0] = -1;
  }
  /// Empties it; what was in it.
  std::string read_all() {
    std::string all;
    char buffer[4096];
    for (ssize_t n; (n = read(ends_[0], buffer, sizeof buffer)) > 0;) {
      all.append(buffer, static_cast<std::size_t>(n));
    }
    return all;
  }

 private:
  int ends_[2];
};

TEST(DaemonLog, CountsAndSaysWhatAFullRingLost) {
  FullPipe pipe;
  const Stderr redirected(pipe.writer());
  Daemon daemon("prog");
  for (std::size_t i = 0; i < Daemon::kLogLines + 44; ++i)
    daemon.log(LogLevel::kInfo, "line {}", i);

  std::string all;
  EXPECT_TRUE(comes_true([&] {
    all += pipe.read_all();
    return all.find("lost") != std::string::npos;
  })) << all;
  const auto last = "info: line " + std::to_string(Daemon::kLogLines - 1) + "\n";
  EXPECT_NE(all.find(last), std::string::npos);
  EXPECT_EQ(all.find("line " + std::to_string(Daemon::kLogLines)), std::string::npos);
  EXPECT_NE(all.find("warning: 44 log lines lost"), std::string::npos);
}

TEST(DaemonLog, AReaderThatStopsReadingHoldsUpNothing) {
  FullPipe pipe;
  const Stderr redirected(pipe.writer());
  Daemon daemon("prog");
  daemon.log(LogLevel::kInfo, "unread");
  kill(getpid(), SIGTERM);
  EXPECT_TRUE(comes_true([&] { return daemon.stopping(); }));
  // ... and the daemon ends here, where it would hang for ever.
}

TEST(DaemonLog, AReaderThatIsGoneEndsNothing) {
  FullPipe pipe;
  const Stderr redirected(pipe.writer());
  pipe.close_reader();
  Daemon daemon("prog");
  daemon.log(LogLevel::kInfo, "unread");
  kill(getpid(), SIGTERM);
  EXPECT_TRUE(comes_true([&] { return daemon.stopping(); }));
}

class DaemonSignal : public ::testing::TestWithParam<int> {};

TEST_P(DaemonSignal, Stops) {
  logged([](Daemon& daemon) {
    EXPECT_FALSE(daemon.stopping());
    kill(getpid(), GetParam());
    EXPECT_TRUE(comes_true([&] { return daemon.stopping(); }));
  });
}

INSTANTIATE_TEST_SUITE_P(Each, DaemonSignal, ::testing::Values(SIGINT, SIGTERM),
                         [](const auto& test) { return test.param == SIGINT ? "INT" : "TERM"; });

TEST(Daemon, StopsWhenTold) {
  logged([](Daemon& daemon) {
    daemon.stop();
    EXPECT_TRUE(daemon.stopping());
  });
}

int policy() { return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; }

// On a thread of its own, so that the other tests keep a normal one. To be called in a process of
// its own, since limits and locked memory stay.
void realtime(const std::function<void(Daemon&)>& use) {
  // A daemon is made by its first thread, from which all others have their mask.
  sigset_t housekeepers;
  sigemptyset(&housekeepers);
  sigaddset(&housekeepers, SIGXCPU);
  pthread_sigmask(SIG_BLOCK, &housekeepers, nullptr);
  std::jthread([&] {
    Daemon daemon("prog");
    daemon.become_realtime(10);
    use(daemon);
  }).join();
  std::exit(0);
}

TEST(DaemonRealtime, TakesThePriorityOrSaysWhatToGrant) {
  EXPECT_EXIT(realtime([](Daemon&) {
                if (policy() == SCHED_FIFO) std::fprintf(stderr, "it has it");
              }),
              ::testing::ExitedWithCode(0),
              "it has it|sudo setcap cap_sys_nice,cap_ipc_lock.ep /.*daemon_test");
}

// As for any user: no capability and no realtime limit.
bool give_up_rights() {
  const rlimit none{};
  __user_cap_header_struct version{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  const __user_cap_data_struct no_capability[_LINUX_CAPABILITY_U32S_3]{};
  return setrlimit(RLIMIT_RTPRIO, &none) == 0 && setrlimit(RLIMIT_MEMLOCK, &none) == 0 &&
         syscall(SYS_capset, &version, no_capability) == 0;
}

// Under a sanitizer mlockall does nothing and succeeds.
TEST(DaemonRealtime, WarnsOnceWhereItIsNotPermitted) {
  EXPECT_EXIT(
      {
        if (!give_up_rights()) std::exit(3);
        realtime([](Daemon&) {
          if (policy() != SCHED_OTHER) std::exit(4);
        });
      },
      ::testing::ExitedWithCode(0),
      "^[^\n]*warning: ticks may be late under load: realtime priority 10: Operation not "
      "permitted, "
      "locked memory: (Operation not permitted|granted); "
      "grant both with: sudo setcap cap_sys_nice,cap_ipc_lock.ep /[^\n]*\n$");
}

TEST(DaemonRealtime, ATickThatNeverSleepsLosesThePriority) {
  bool permitted = false;
  std::jthread([&permitted] {
    const sched_param lowest{.sched_priority = 1};
    permitted = sched_setscheduler(0, SCHED_FIFO, &lowest) == 0;
  }).join();
  if (!permitted) GTEST_SKIP() << "realtime priorities are not permitted";

  EXPECT_EXIT(realtime([](Daemon& daemon) {
                if (policy() != SCHED_FIFO) std::exit(4);
                while (policy() == SCHED_FIFO) {
                }
                if (daemon.stopping()) std::exit(5);
              }),
              ::testing::ExitedWithCode(0),
              "error: the tick thread has not slept for 200 ms and loses its realtime priority");
}

TEST(DaemonRealtime, ALoopThatIsAlwaysBehindKeepsThePriority) {
  EXPECT_EXIT(realtime([](Daemon& daemon) {
                const int given = policy();
                const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
                while (std::chrono::steady_clock::now() < end) daemon.next_round();
                if (policy() != given) std::exit(4);
              }),
              ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace gyrotwin
