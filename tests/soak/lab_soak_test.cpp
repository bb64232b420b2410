// A whole lab for hours of its own time: what it holds and what it counts stays as it is.
//   GYROTWIN_SOAK_HOURS: simulated time of the cheapest rig; the others get a share of it
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "tests/soak/gateway_visit.hpp"
#include "tests/soak/process_watch.hpp"
#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::GatewayVisit;
using support::Lab;
using support::Process;
using support::ProcessWatch;

/// What the middle and the last third of a run may differ by: a few pages of the allocator's. A
/// leak of one byte a tick would be 1.8 MB an hour at 500 Hz.
constexpr long kGrowthKib = 256;
constexpr double kRotateMb = 8.0;
constexpr std::size_t kKept = 4;
constexpr int kQuietTurns = 5;  ///< STATUS messages to be heard in a quiet moment
constexpr int kTries = 5, kUnanswered = -1;
constexpr double kLulls = 40;  ///< of a run, in which nobody asks for anything

double hours() {
  const char* hours = std::getenv("GYROTWIN_SOAK_HOURS");
  return hours != nullptr ? std::atof(hours) : 0.02;
}

struct Soaked {
  const char* name;
  const char* rig;
  const char* clock;
  double share;  ///< of hours()
};

/// gtest's name of a parameter.
void PrintTo(const Soaked& soaked, std::ostream* to) { *to << soaked.name; }

/// What a daemon counts and must not count more of, whatever happens to it here.
std::map<std::string, std::int64_t> troubles(const status_t& status, bool lockstep) {
  std::map<std::string, std::int64_t> all{{"malformed", status.malformed},
                                          {"foreign", status.foreign},
                                          {"other_rig", status.other_rig},
                                          {"unauthentic", status.unauthentic},
                                          {"send_failed", status.send_failed}};
  const bool owner = status.service == status_t::INTEGRATOR;
  if (!lockstep || (!owner && status.service != status_t::CONTROLLER)) return all;
  // They wait for each other. A listener that is slower than they are loses, and counts it.
  // Overruns are no part: what is HELD or has stopped is paced by wall time in lockstep too.
  const auto heard = static_cast<std::size_t>(owner ? Channel::kCommand : Channel::kState);
  all["kernel_dropped"] = status.kernel_dropped;
  all["gaps"] = status.gaps[heard];
  return all;
}

/// Simulated time over all runs of an owner, one after the other.
class SimulatedTime {
 public:
  void hear(const status_t& owner) {
    if (owner.header.epoch != epoch_) {
      before_s_ += now_s_;
      now_s_ = 0.0;
      epoch_ = owner.header.epoch;
      ++runs;
    }
    const double heard_s = 1e-9 * static_cast<double>(owner.header.sim_time_ns);
    EXPECT_GE(heard_s, now_s_) << "time went back in run " << runs;
    now_s_ = heard_s;
  }
  double seconds() const { return before_s_ + now_s_; }

  int runs = 0;

 private:
  std::int64_t epoch_ = 0;
  double before_s_ = 0.0, now_s_ = 0.0;
};

class Soak : public testing::TestWithParam<Soaked> {
 protected:
  void start() {
    ASSERT_NO_FATAL_FAILURE(lab_.start_daemons());
    mirror_ = lab_.start("mirror");
    gateway_ = lab_.start("gateway", {"--recordings", lab_.folder() / "recordings"});
    std::filesystem::create_directory(records());
    recorder_ = lab_.start("log", {"record", "--rotate-mb", std::to_string(kRotateMb), "--keep",
                                   std::to_string(kKept), records() / "run.lcm"});
    ASSERT_TRUE(lab_.until([](const Reception& heard) {
      return heard.channel == Channel::kGatewayStatus && !heard.repeat;
    })) << gateway_->output();
    ASSERT_NO_FATAL_FAILURE(lab_.arm());
    processes_ = {{"integrator", lab_.owner.get()},
                  {"controller", lab_.controller.get()},
                  {"mirror", mirror_.get()},
                  {"gateway", gateway_.get()},
                  {"recorder", recorder_.get()}};
    for (const auto& [name, process] : processes_) watches_.emplace_back(name, process->pid());
  }

  /// What has come since the last time.
  void listen() {
    const bool any_owner = lab_.until([this](const Reception& heard) {
      status_t status{};
      if (!is_status(heard.channel)) return false;
      Bus::decode(heard, status);
      now_[status.service] = status;
      if (status.service != status_t::INTEGRATOR) return false;
      time_.hear(status);
      return true;
    });
    EXPECT_TRUE(any_owner) << lab_.owner->output();
  }

  static bool is_status(Channel channel) {
    return is_owner_status(channel) || channel == Channel::kControllerStatus ||
           channel == Channel::kMirrorStatus || channel == Channel::kGatewayStatus;
  }

  void done(const std::string& program, const std::vector<std::string>& words) {
    ASSERT_EQ(ask(program, words), 0) << lab_.said << lab_.owner->output();
    listen();
  }
  void refused(const std::string& program, const std::vector<std::string>& words) {
    ASSERT_EQ(ask(program, words), 1) << lab_.said;
    listen();
  }
  /// An answer is lost among the 60,000 messages a second of lockstep where the client that waits
  /// for it gets no processor: then once more, as an operator would, and counted.
  int ask(const std::string& program, const std::vector<std::string>& words) {
    for (int left = kTries;; --left) {
      const int code = lab_.run(program, words);
      const bool unheard = lab_.said.find("does not answer") != std::string::npos ||
                           lab_.said.find("no owner of rig") != std::string::npos;
      if (code != 1 || !unheard) return code;
      if (left == 1) return kUnanswered;
      ++unanswered_;
    }
  }

  /// A working day in the life of a lab.
  void cycle() {
    done("disturb", {"impulse", "--watch", "0"});
    refused("ctl", {"arm"});
    done("disturb", {"sensor", "gyro", "--noise", "0.01", "--duration", "2"});
    visit();
    done("disturb", {"drive", "all", "--strength", "0.9", "--duration", "2"});
    done("ctl", {"pause"});
    refused("ctl", {"arm"});
    done("ctl", {"step", "5"});
    lab_.await_mode(status_t::MODE_PAUSED);
    look();
    done("ctl", {"resume"});
    go_on();
    done("disturb", {"link", "--duration", "0.004"});
    done("disturb", {"step", "--roll", "0.01"});
    done("ctl", {"clear"});
    visit();
    done("ctl", {"disarm"});
    refused("disturb", {"cancel", "77"});
    done("ctl", {"reset"});
    ASSERT_NO_FATAL_FAILURE(lab_.arm());
    listen();
  }

  /// A page, a scrape, and a client that goes while it is spoken to.
  void visit() {
    const auto port = static_cast<std::uint16_t>(8764 + lab_.rig.id);
    EXPECT_NE(GatewayVisit(port).get("/").find("200 OK"), std::string::npos);
    EXPECT_NE(GatewayVisit(port).get("/metrics").find("gyrotwin_mode"), std::string::npos);
    EXPECT_NE(GatewayVisit(port).get("/nowhere").find("404"), std::string::npos);
    EXPECT_TRUE(GatewayVisit(port).listen(100'000));
    visits_ += 4;
  }

  /// It ticks again.
  void go_on() {
    const double from_s = time_.seconds();
    const bool went_on = lab_.until([&](const Reception& heard) {
      if (!is_owner_status(heard.channel)) return false;
      status_t status{};
      Bus::decode(heard, status);
      time_.hear(status);
      return time_.seconds() > from_s;
    });
    EXPECT_TRUE(went_on) << lab_.owner->output();
  }

  /// What everybody holds in a quiet moment. Descriptors of visitors and of files on their way to
  /// the disk go soon, as does what waits for the disk.
  void look() {
    if (first_) {
      for (int turn = 0; turn < kQuietTurns; ++turn) {
        listen();
        for (ProcessWatch& watch : watches_) watch.begin();
      }
      at_first_ = now_;
      first_ = false;
      return;
    }
    for (ProcessWatch& watch : watches_) {
      EXPECT_TRUE(lab_.until([&](const Reception&) { return watch.settled(); }))
          << watch.name() << " has other threads or descriptors than at first";
      watch.sample();
    }
    // Judged in the end; here they get the time to come down.
    lab_.until([this](const Reception&) {
      return std::ranges::all_of(watches_,
                                 [](ProcessWatch& watch) { return watch.relaxed(kGrowthKib); });
    });
    std::size_t files = 0;
    for (const auto& file : std::filesystem::directory_iterator(records())) {
      EXPECT_TRUE(file.path().filename().string().starts_with("run."));
      ++files;
    }
    EXPECT_LE(files, kKept + 1);  // the next one is there before the oldest goes
  }

  void expect_no_trouble() {
    const bool lockstep = lab_.rig.loop.clock == ClockMode::kLockstep;
    for (const auto& [service, status] : now_) {
      for (const auto& [what, count] : troubles(status, lockstep)) {
        EXPECT_EQ(count, troubles(at_first_[service], lockstep)[what]) << what << " of " << service;
      }
    }
    for (const auto& [name, process] : processes_) {
      EXPECT_TRUE(process->running()) << name << " has ended:\n" << process->output();
      EXPECT_EQ(process->output().find("log lines lost"), std::string::npos) << name;
    }
  }

  void print_table() {
    std::printf(
        "\n%s: %.2f h simulated in %d runs, %d visits of the gateway, %d requests asked again\n",
        GetParam().name, time_.seconds() / 3600, time_.runs, visits_, unanswered_);
    std::printf(
        "| process    | memory first | last | growth | resident first | last | threads | "
        "descriptors |\n|---|---|---|---|---|---|---|---|\n");
    for (const ProcessWatch& watch : watches_) {
      const auto& first = watch.samples().front();
      const auto& last = watch.last();
      std::printf("| %-10s | %ld KiB | %ld | %+ld | %ld | %ld | %d | %d |\n", watch.name().c_str(),
                  first.anonymous_kib, last.anonymous_kib, watch.growth_kib(), first.resident_kib,
                  last.resident_kib, last.threads, last.descriptors);
    }
    for (const auto& [service, status] : now_) {
      std::printf("service %d: %lld lost to a full buffer, %lld overruns\n", service,
                  static_cast<long long>(status.kernel_dropped),
                  static_cast<long long>(status.overruns));
    }
    const std::string said = recorder_->output();
    std::printf("recorder: %s\n", said.substr(said.rfind("recorded ")).c_str());
  }

  std::filesystem::path records() const { return lab_.folder() / "records"; }

  Lab lab_{GetParam().rig, {std::string("loop.clock=") + GetParam().clock}};
  std::unique_ptr<Process> mirror_, gateway_, recorder_;
  std::map<std::string, Process*> processes_;
  std::vector<ProcessWatch> watches_;
  std::map<std::int32_t, status_t> now_, at_first_;
  SimulatedTime time_;
  int visits_ = 0;
  int unanswered_ = 0;
  bool first_ = true;
};

TEST_P(Soak, HoldsAndCountsWhatItDidAtFirst) {
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_NO_FATAL_FAILURE(cycle());  // what is made at the first use is there after that
  const double end_s = 3600 * hours() * GetParam().share;
  while (time_.seconds() < end_s || watches_.front().samples().size() < 3) {
    ASSERT_NO_FATAL_FAILURE(cycle());
    const double lull_s = time_.seconds() + end_s / kLulls;
    while (time_.seconds() < lull_s) listen();
    ASSERT_FALSE(HasNonfatalFailure()) << time_.seconds();
  }
  expect_no_trouble();
  for (const ProcessWatch& watch : watches_) {
    EXPECT_LE(watch.growth_kib(), kGrowthKib) << watch.name();
  }
  for (const auto& [name, process] : processes_) {
    process->signal(SIGTERM);
    EXPECT_EQ(process->wait(), 0) << name << process->output();
  }
  print_table();
}

INSTANTIATE_TEST_SUITE_P(Labs, Soak,
                         testing::Values(Soaked{"gyrocar_realtime", "gyrocar", "realtime", 0.02},
                                         Soaked{"gyrocar", "gyrocar", "lockstep", 1.0},
                                         Soaked{"prototype_b", "prototype_b", "lockstep", 0.2}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace gyrotwin
