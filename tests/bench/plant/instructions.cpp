#include "tests/bench/plant/instructions.hpp"

#include <unistd.h>
#include <valgrind/callgrind.h>

#include <array>
#include <climits>
#include <filesystem>
#include <fstream>

#include "services/runtime/error.hpp"
#include "tests/bench/plant/acceleration.hpp"
#include "tests/bench/plant/figure.hpp"
#include "tests/support/process.hpp"

namespace gyrotwin::bench {

namespace fs = std::filesystem;

namespace {

// Between rig and subject in the name of a dump.
constexpr char kBetween = '/';
constexpr double kLimit = 600.0;  // [s]; a quiet machine takes 20
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

/// One dump: who was counted, and its instructions.
struct Dump {
  std::string name;
  double instructions = 0.0;
};

Dump read_dump(const fs::path& file) {
  const std::string trigger = "desc: Trigger: Client Request: ", totals = "totals: ";
  Dump dump;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(trigger, 0) == 0) dump.name = line.substr(trigger.size());
    if (line.rfind(totals, 0) == 0) dump.instructions = std::stod(line.substr(totals.size()));
  }
  return dump;
}

}  // namespace

void count_instructions(const std::vector<std::string>& rigs) {
  std::array<char, PATH_MAX> self{};
  if (readlink("/proc/self/exe", self.data(), self.size() - 1) < 0) throw Error("no /proc");
  const Scratch scratch;
  const std::string dumps = (scratch.path() / "dump").string();
  support::Process valgrind(
      {"/usr/bin/env", "valgrind", "--tool=callgrind", "--collect-atstart=no",
       "--callgrind-out-file=" + dumps, self.data(), "--under-callgrind", "--rigs", joined(rigs)},
      scratch.path() / "words");
  if (const int code = valgrind.wait(kLimit); code == kNoProgram) {
    throw Error("valgrind is not here; apt-get install valgrind");
  } else if (code != 0) {
    throw Error("valgrind ended with " + std::to_string(code) + ": " + valgrind.output());
  }
  for (int i = 1; fs::exists(dumps + "." + std::to_string(i)); ++i) {
    const Dump dump = read_dump(dumps + "." + std::to_string(i));
    const auto between = dump.name.find(kBetween);
    if (between == std::string::npos) continue;  // the end of the program
    print_figure("acceleration", dump.name.substr(0, between), dump.name.substr(between + 1),
                 "instructions", "1", dump.instructions / kTrajectoryTicks);
  }
}

void pass_under_callgrind(const std::vector<std::string>& rigs) {
  for (const std::string& rig : rigs) {
    const Contest all = contest(rig);
    for (const auto& subject : all.subjects) {
      for (std::size_t i = 0; i < all.samples.size(); ++i) subject->evaluate(i);
      CALLGRIND_TOGGLE_COLLECT;
      for (std::size_t i = 0; i < all.samples.size(); ++i) subject->evaluate(i);
      CALLGRIND_TOGGLE_COLLECT;
      const std::string name = rig + kBetween + subject->name();  // outlives the macro's statements
      CALLGRIND_DUMP_STATS_AT(name.c_str());
    }
  }
}

}  // namespace gyrotwin::bench
