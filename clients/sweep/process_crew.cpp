#include <fcntl.h>
#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <exception>
#include <set>
#include <vector>

#include "clients/sweep/crew.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

/// What a worker does all its life: it reads the numbers of runs and writes their lines. Nothing
/// may leave it but by _exit(): the rest of the stack is the other process's.
[[noreturn]] void serve(int runs, int lines, const Work& work) noexcept {
  std::int64_t run = 0;
  try {
    std::signal(SIGINT, SIG_IGN);  // the one who gives the work decides when it ends
    while (read(runs, &run, sizeof run) == sizeof run) {
      const std::string line = work(run);
      if (write(lines, line.data(), line.size()) != std::ssize(line)) _exit(1);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "run %lld: %s\n", static_cast<long long>(run), error.what());
    _exit(1);
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

std::string how_it_ended(int status) {
  return WIFSIGNALED(status) ? fmt::format("was ended by signal {} ({})", WTERMSIG(status),
                                           strsignal(WTERMSIG(status)))
                             : fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

class ProcessCrew : public Crew {
 public:
  ProcessCrew(int workers, Work work) : work_(std::move(work)) {
    std::signal(SIGPIPE, SIG_IGN);  // a worker that is gone is seen by its silence
    for (int i = 0; i < workers; ++i) workers_.push_back(hired());
  }
  ~ProcessCrew() override {
    if (getpid() != owner_) return;  // a fork's copy: the workers are not its own
    for (const Worker& worker : workers_) {
      dismiss(worker);
      kill(worker.process, SIGKILL);
      waitpid(worker.process, nullptr, 0);
    }
  }

  int size() const override { return static_cast<int>(workers_.size()); }
  int pending() const override {
    std::size_t runs = finished_.size();
    for (const Worker& worker : workers_) runs += worker.runs.size();
    return static_cast<int>(runs);
  }

  void give(std::int64_t run) override {
    Worker& idlest = *std::ranges::min_element(
        workers_, {}, [](const Worker& worker) { return worker.runs.size(); });
    idlest.runs.push_back(run);
    tell(idlest, run);
  }

  std::optional<Finished> next(std::chrono::milliseconds patience) override {
    if (finished_.empty()) listen(patience);
    if (finished_.empty()) return std::nullopt;
    Finished first = std::move(finished_.front());
    finished_.pop_front();
    return first;
  }

 private:
  struct Worker {
    pid_t process;
    int to, from;                        // pipes
    std::string heard = {};              // of a line that is not complete
    std::deque<std::int64_t> runs = {};  // given, in this order
  };

  static void dismiss(const Worker& worker) {
    close(worker.to);
    close(worker.from);
  }

  Worker hired() const {
    const auto refuse = [] {
      throw Error(fmt::format("no worker can be started: {}", std::strerror(errno)));
    };
    int runs[2], lines[2];  // read here, write there
    if (pipe2(runs, O_CLOEXEC) != 0 || pipe2(lines, O_CLOEXEC) != 0) refuse();
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process < 0) refuse();
    if (process == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != parent) _exit(1);  // it has ended in between
      close(runs[1]);
      close(lines[0]);
      for (const Worker& other : workers_) dismiss(other);
      serve(runs[0], lines[1], work_);
    }
    close(runs[0]);
    close(lines[1]);
    return {process, runs[1], lines[0]};
  }

  /// A worker that is gone does not take it: listen() sees that and hires another.
  static void tell(const Worker& worker, std::int64_t run) {
    [[maybe_unused]] const ssize_t sent = write(worker.to, &run, sizeof run);
  }

  void listen(std::chrono::milliseconds patience) {
    std::vector<pollfd> pipes;
    for (const Worker& worker : workers_) pipes.push_back({worker.from, POLLIN, 0});
    if (poll(pipes.data(), pipes.size(), static_cast<int>(patience.count())) <= 0) return;
    for (std::size_t i = 0; i < pipes.size(); ++i) {
      if (pipes[i].revents != 0) hear(workers_[i]);
    }
  }

  void hear(Worker& worker) {
    std::array<char, 4096> text;
    const ssize_t size = read(worker.from, text.data(), text.size());
    if (size <= 0) return replace(worker);
    worker.heard.append(text.data(), static_cast<std::size_t>(size));
    for (std::size_t end; (end = worker.heard.find('\n')) != std::string::npos;) {
      finished_.push_back({worker.runs.front(), worker.heard.substr(0, end + 1)});
      worker.heard.erase(0, end + 1);
      worker.runs.pop_front();
    }
  }

  void replace(Worker& worker) {
    int status = 0;
    waitpid(worker.process, &status, 0);
    dismiss(worker);
    std::deque<std::int64_t> left = std::move(worker.runs);
    if (!left.empty() && !suspects_.insert(left.front()).second) {
      worker = hired();  // so that there is one to end
      throw Error(fmt::format("run {} has ended two workers; the last one {}", left.front(),
                              how_it_ended(status)));
    }
    std::fprintf(stderr, "a worker %s; another one goes on with its runs\n",
                 how_it_ended(status).c_str());
    worker = hired();
    worker.runs = std::move(left);
    for (const std::int64_t run : worker.runs) tell(worker, run);
  }

  const pid_t owner_ = getpid();
  Work work_;
  std::vector<Worker> workers_;
  std::deque<Finished> finished_;
  std::set<std::int64_t> suspects_;  // runs that ended a worker
};

}  // namespace

std::unique_ptr<Crew> process_crew(int workers, Work work) {
  return std::make_unique<ProcessCrew>(workers, std::move(work));
}

}  // namespace gyrotwin
