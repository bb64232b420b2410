// The round trip STATE -> COMMAND between two processes: ours beside raw UDP and the middlewares.
// Subjects take turns in small slices. What is measured and how: README.md.
//   tests/support/in_namespace build/release/bin/loop_bench one_core 5
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "services/runtime/clock.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/loop/far_process.hpp"
#include "tests/bench/loop/trip.hpp"

namespace gyrotwin::bench {

namespace {

// As the daemons': the owner must notice when the controller goes astray.
constexpr int kOwnerPriority = 80, kControllerPriority = 79;

constexpr int kSlice = 50;             // trips of one subject before it is the next one's turn
constexpr int kMeetingAttempts = 100;  // of kPatienceMs each

constexpr std::array kSubjects{
    Subject{"raw UDP", raw_udp_near, raw_udp_far},
    Subject{"raw multicast", raw_multicast_near, raw_multicast_far},
    Subject{"gyrotwin", bus_near, bus_far},
    Subject{"gyrotwin signed", signed_bus_near, signed_bus_far},
#ifdef GYROTWIN_PEERS
    Subject{"liblcm", liblcm_near, liblcm_far},
#endif
#ifdef GYROTWIN_ZEROMQ
    Subject{"ZeroMQ", zeromq_near, zeromq_far},
    Subject{"ZeroMQ ipc", zeromq_ipc_near, zeromq_ipc_far},
#endif
#ifdef GYROTWIN_CYCLONE
    Subject{"Cyclone DDS", cyclone_near, cyclone_far},
#endif
};

/// How often the threads of this process have given up the processor or lost it.
std::int64_t own_switches() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_nvcsw + usage.ru_nivcsw;
}

void sleep_ns(std::int64_t ns) {
  const timespec duration{.tv_sec = 0, .tv_nsec = ns};
  nanosleep(&duration, nullptr);
}

/// The two ends of one subject, and what its trips have taken.
class Contestant {
 public:
  Contestant(const Subject& subject, std::unique_ptr<FarProcess> far)
      : subject_(&subject), far_(std::move(far)), near_(subject.near()) {
    for (int i = 0; i < kMeetingAttempts; ++i) {
      if (near_->there_and_back()) {
        far_switches_ = context_switches(far_->pid());
        return;
      }
      sleep_ns(10'000'000);  // some refuse at once what nobody listens to
    }
    throw std::runtime_error(std::string(subject.name) + ": the two processes do not meet");
  }

  /// @return how long all of it took [ns]
  std::int64_t run_slice() {
    const std::int64_t begin = monotonic_ns(), switches = own_switches();
    for (int i = 0; i < kSlice; ++i) {
      const std::int64_t start = monotonic_ns();
      if (!near_->there_and_back()) {
        throw std::runtime_error(std::string(subject_->name) + ": a message is lost");
      }
      if (i > 0) trips_.push_back(monotonic_ns() - start);  // the first is after others' turns
    }
    near_switches_ += own_switches() - switches;
    return monotonic_ns() - begin;
  }

  void report(const std::string& placing) {
    const Figure figure{"round_trip", placing, std::string(subject_->name)};
    const double trips = static_cast<double>(trips_.size()) * kSlice / (kSlice - 1);  // in all
    const std::int64_t switches = near_switches_ + context_switches(far_->pid()) - far_switches_;
    figure.print("context_switches", "1", static_cast<double>(switches) / trips);
    figure.print_distribution(trips_);
  }

 private:
  const Subject* subject_;
  std::unique_ptr<FarProcess> far_;
  std::unique_ptr<Near> near_;
  std::int64_t near_switches_ = 0;
  std::int64_t far_switches_ = 0;  // up to the first trip that counts
  std::vector<std::int64_t> trips_;
};

/// The processors that this process may use, ascending.
std::vector<int> processors() {
  cpu_set_t set;
  sched_getaffinity(0, sizeof set, &set);
  std::vector<int> all;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(static_cast<std::size_t>(i), &set)) all.push_back(i);
  }
  return all;
}

/// The far ends need the processor too, to end: beside an owner in realtime they were seen to hang
/// for ever. At the end of its life at the latest.
struct PriorityGivenBack {
  void now() const {
    const sched_param normal{.sched_priority = 0};
    sched_setscheduler(0, SCHED_OTHER, &normal);
  }
  ~PriorityGivenBack() { now(); }
};

/// The subjects by turns, for so long.
void race(const std::string& placing, int seconds, const std::vector<Subject>& chosen) {
  const std::vector<int> all = processors();
  const bool apart = placing == "two_cores";
  if (apart && all.size() < 2) throw std::runtime_error("two_cores: there is one processor only");
  const Placement far{apart ? all.front() : all.back(), kControllerPriority};

  // The far ends are forked from a process that has no threads yet.
  std::vector<std::unique_ptr<FarProcess>> fars;
  for (const Subject& subject : chosen) fars.push_back(std::make_unique<FarProcess>(subject, far));
  if (const int refused = Placement{all.back(), kOwnerPriority}.take(); refused != 0) {
    std::fprintf(stderr, "loop_bench: without SCHED_FIFO: %s\n", std::strerror(refused));
  }
  std::vector<Contestant> contestants;
  const PriorityGivenBack giving_back;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    contestants.emplace_back(chosen[i], std::move(fars[i]));
  }

  const std::int64_t end = monotonic_ns() + std::int64_t{1'000'000'000} * seconds;
  while (monotonic_ns() < end) {
    for (Contestant& contestant : contestants) {
      // Who never sleeps in realtime is held up by the kernel.
      sleep_ns(contestant.run_slice() / 8);
    }
  }
  giving_back.now();
  for (Contestant& contestant : contestants) contestant.report(placing);
}

/// So many trips of one subject, for strace.
void make_trips(const Subject& subject, int trips) {
  auto far = std::make_unique<FarProcess>(subject, Placement{processors().back(), 0});
  Contestant contestant(subject, std::move(far));
  for (int i = 0; i < trips; i += kSlice) contestant.run_slice();
}

/// Of both ends, set-up included.
double traced_calls(const std::string& self, const Subject& subject, int trips) {
  const std::string command = "strace -f -c " + self + " trips " + std::to_string(trips) + " '" +
                              std::string(subject.name) + "' 2>&1";
  FILE* output = popen(command.c_str(), "r");
  if (output == nullptr) throw std::runtime_error("popen: " + command);
  double calls = 0;
  std::array<char, 256> line;
  while (std::fgets(line.data(), line.size(), output) != nullptr) {
    double share, seconds, each;
    if (std::strstr(line.data(), " total") != nullptr) {
      std::sscanf(line.data(), "%lf %lf %lf %lf", &share, &seconds, &each, &calls);
    }
  }
  pclose(output);
  if (calls == 0) throw std::runtime_error("system_calls: needs strace (apt-get install strace)");
  return calls;
}

/// The difference of a long run and a short one; the median of some, for how often two ends try to
/// meet differs.
void count_system_calls(const std::string& self) {
  constexpr int kShort = 500, kLong = 4500;
  for (const Subject& subject : kSubjects) {
    std::array<double, 5> differences;
    for (double& difference : differences) {
      difference = traced_calls(self, subject, kLong) - traced_calls(self, subject, kShort);
    }
    std::sort(differences.begin(), differences.end());
    Figure{"round_trip", "", std::string(subject.name)}.print(
        "system_calls", "1", differences[differences.size() / 2] / (kLong - kShort));
  }
}

const Subject& subject_named(const std::string& name) {
  for (const Subject& subject : kSubjects) {
    if (subject.name == name) return subject;
  }
  throw std::runtime_error("no subject is called `" + name + "`");
}

int run(const std::vector<std::string>& words) {
  const std::string part = words.size() > 1 ? words[1] : "";
  const int number = words.size() > 2 ? std::atoi(words[2].c_str()) : 5;
  if ((part == "one_core" || part == "two_cores") && number > 0) {
    std::vector<Subject> chosen(kSubjects.begin(), kSubjects.end());
    if (words.size() > 3) {
      chosen.clear();
      for (std::size_t i = 3; i < words.size(); ++i) chosen.push_back(subject_named(words[i]));
    }
    race(part, number, chosen);
  } else if (part == "system_calls") {
    count_system_calls(words[0]);
  } else if (part == "trips" && words.size() == 4) {
    make_trips(subject_named(words[3]), number);
  } else {
    std::fprintf(stderr,
                 "usage: %s one_core|two_cores [SECONDS=5 [SUBJECT...]]\n       %s system_calls\n",
                 words[0].c_str(), words[0].c_str());
    return 2;
  }
  return 0;
}

}  // namespace

}  // namespace gyrotwin::bench

int main(int argc, char** argv) {
  try {
    return gyrotwin::bench::run({argv, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "loop_bench: %s\n", error.what());
    return 2;
  }
}
