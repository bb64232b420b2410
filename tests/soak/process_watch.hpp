// What a process holds, over a long run, and whether that stays.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace gyrotwin::support {

/// What the kernel says of a process.
struct Holding {
  long anonymous_kib = 0;  ///< resident memory that is no file's: what a leak adds to
  long resident_kib = 0;   ///< all of it, pages of its program that were touched so far included
  int threads = 0, descriptors = 0;
};

inline Holding holding_of(pid_t pid) {
  Holding now;
  const std::filesystem::path folder = "/proc/" + std::to_string(pid);
  std::ifstream status(folder / "status");
  for (std::string line; std::getline(status, line);) {
    const std::size_t colon = line.find(':');
    const std::string key = line.substr(0, colon);
    if (key == "RssAnon") now.anonymous_kib = std::stol(line.substr(colon + 1));
    if (key == "VmRSS") now.resident_kib = std::stol(line.substr(colon + 1));
    if (key == "Threads") now.threads = std::stoi(line.substr(colon + 1));
  }
  // One of them, when the process is this one, is open for the listing.
  now.descriptors =
      static_cast<int>(std::distance(std::filesystem::directory_iterator(folder / "fd"), {}));
  return now;
}

/// One process's samples.
class ProcessWatch {
 public:
  ProcessWatch(std::string name, pid_t pid) : name_(std::move(name)), pid_(pid) {}

  /// What it holds from here on is what it shall hold: where this is said several times, the least.
  void begin() {
    const Holding now = holding_of(pid_);
    if (first_.threads == 0) first_ = now;
    first_.descriptors = std::min(first_.descriptors, now.descriptors);
  }

  /// Whether it has the threads and descriptors it had at the beginning.
  bool settled() const {
    const Holding now = holding_of(pid_);
    return now.threads == first_.threads && now.descriptors == first_.descriptors;
  }
  void sample() { samples_.push_back(holding_of(pid_)); }
  /// Takes less memory, if it is less now, for the last sample's. @return whether that is at most
  /// so much more than the first one's
  bool relaxed(long more_kib) {
    long& memory = samples_.back().anonymous_kib;
    memory = std::min(memory, holding_of(pid_).anonymous_kib);
    return memory <= samples_.front().anonymous_kib + more_kib;
  }

  /// Memory of the run's last third over its middle one; the first third is warm-up [KiB]. The
  /// least of each: what a moment has more is no growth, and a leak leaves no moment out.
  long growth_kib() const {
    const auto third = static_cast<std::ptrdiff_t>(samples_.size() / 3);
    const auto least = [](auto begin, auto end) {
      return std::min_element(begin, end,
                              [](const Holding& a, const Holding& b) {
                                return a.anonymous_kib < b.anonymous_kib;
                              })
          ->anonymous_kib;
    };
    return least(samples_.end() - third, samples_.end()) -
           least(samples_.begin() + third, samples_.end() - third);
  }

  const std::string& name() const { return name_; }
  const Holding& first() const { return first_; }
  const Holding& last() const { return samples_.back(); }
  const std::vector<Holding>& samples() const { return samples_; }

 private:
  std::string name_;
  pid_t pid_;
  Holding first_;
  std::vector<Holding> samples_;
};

}  // namespace gyrotwin::support
