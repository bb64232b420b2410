#include "tests/bench/plant/callgrind.hpp"

#include <unistd.h>
#include <valgrind/callgrind.h>

#include <array>
#include <climits>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "services/runtime/error.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/plant/acceleration.hpp"
#include "tests/support/process.hpp"

namespace gyrotwin::bench {

namespace fs = std::filesystem;

namespace {

// Between rig and subject in the name of a dump.
constexpr char kBetween = '/';
constexpr double kLimit = 600.0;  // of a program [s]; on a quiet machine valgrind takes 15
constexpr int kNoProgram = 127;   // env says so

class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "plant_bench.XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Error("no folder for valgrind's files: " + name);
    path_ = name;
  }
  ~Scratch() { fs::remove_all(path_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ",") + word;
  return all;
}

bool begins(const std::string& line, const std::string& with) { return line.rfind(with, 0) == 0; }

/// A dump with names and addresses in full: "ADDRESS LINE COUNT" below the object it is in; the
/// line after "calls=" is what was called.
Pass read_dump(const fs::path& file, const std::string& self) {
  const std::string trigger = "desc: Trigger: Client Request: ", totals = "totals: ";
  Pass pass;
  bool own_code = false;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (begins(line, trigger)) {
      const auto between = line.find(kBetween, trigger.size());
      pass.rig = line.substr(trigger.size(), between - trigger.size());
      pass.subject = line.substr(between + 1);
    } else if (begins(line, totals)) {
      pass.instructions = std::stod(line.substr(totals.size())) / kTrajectoryTicks;
    } else if (begins(line, "ob=")) {
      own_code = line.substr(3) == self;
    } else if (begins(line, "calls=")) {
      std::getline(in, line);
    } else if (own_code && begins(line, "0x")) {
      const double count = std::stod(line.substr(line.rfind(' ')));
      pass.executed[std::stoull(line, nullptr, 16)] += count / kTrajectoryTicks;
    }
  }
  return pass;
}

}  // namespace

std::string own_path() {
  std::array<char, PATH_MAX> path{};
  if (readlink("/proc/self/exe", path.data(), path.size() - 1) < 0) throw Error("no /proc");
  return path.data();
}

std::string output_of(const std::vector<std::string>& words) {
  const Scratch scratch;
  std::vector<std::string> command{"/usr/bin/env"};
  command.insert(command.end(), words.begin(), words.end());
  support::Process process(command, scratch.path() / "output");
  const int code = process.wait(kLimit);
  if (code == kNoProgram) throw Error(words[0] + " is not here; install it with apt-get");
  if (code != 0) {
    throw Error(words[0] + " ended with " + std::to_string(code) + ": " + process.output());
  }
  return process.output();
}

std::vector<Pass> passes_under_callgrind(const std::vector<std::string>& rigs, bool peers) {
  const Scratch scratch;
  const std::string self = own_path(), dumps = (scratch.path() / "dump").string();
  // skip-plt: with it, what happens in a stub of the linker counts for the call to it, again.
  output_of({"valgrind", "--tool=callgrind", "--collect-atstart=no", "--dump-instr=yes",
             "--skip-plt=no", "--compress-strings=no", "--compress-pos=no",
             "--callgrind-out-file=" + dumps, self,
             peers ? "--under-callgrind" : "--alone-under-callgrind", "--rigs", joined(rigs)});
  // The last dump, at the end of the program, has no number.
  std::vector<Pass> passes;
  for (int i = 1; fs::exists(dumps + "." + std::to_string(i)); ++i) {
    passes.push_back(read_dump(dumps + "." + std::to_string(i), self));
  }
  return passes;
}

void pass_under_callgrind(const std::vector<std::string>& rigs, bool peers) {
  for (const std::string& rig : rigs) {
    const Contest all = contest(rig, peers);
    for (const auto& subject : all.subjects) {
      for (std::size_t i = 0; i < all.samples.size(); ++i) subject->evaluate(i);
      CALLGRIND_TOGGLE_COLLECT;
      for (std::size_t i = 0; i < all.samples.size(); ++i) subject->evaluate(i);
      CALLGRIND_TOGGLE_COLLECT;
      const std::string name = rig + kBetween + subject->name();
      CALLGRIND_DUMP_STATS_AT(name.c_str());
    }
  }
}

void count_instructions(const std::vector<std::string>& rigs) {
  for (const Pass& pass : passes_under_callgrind(rigs, true)) {
    Figure{"acceleration", pass.rig, pass.subject}.print("instructions", "1", pass.instructions);
  }
}

}  // namespace gyrotwin::bench
