// One rig's programs as processes: the build under test, a key and a folder of the test's own.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "services/runtime/key.hpp"
#include "services/runtime/rig_bus.hpp"
#include "tests/support/process.hpp"

namespace gyrotwin::support {

using Words = std::vector<std::string>;

class Programs {
 public:
  Programs(const std::string& rig_name, Words overrides)
      : name_(rig_name), overrides_(std::move(overrides)), folder_(make_folder()) {
    ::setenv("GYROTWIN_KEYS", folder_.c_str(), 1);
    rig = load_rig(name_, overrides_);
    if (rig.network.sign) create_key(key_path(rig.name));
  }
  ~Programs() { std::filesystem::remove_all(folder_); }
  Programs(const Programs&) = delete;
  Programs& operator=(const Programs&) = delete;

  /// `gyrotwin-PROGRAM ARGUMENTS --rig ... --set ...` of the build under test.
  /// @param launcher words that stand before: a program that executes the rest
  std::unique_ptr<Process> start(const std::string& program, const Words& arguments = {},
                                 const Words& launcher = {}) {
    Words words = launcher;
    words.push_back(std::string(GYROTWIN_BIN) + "/gyrotwin-" + program);
    words.insert(words.end(), arguments.begin(), arguments.end());
    words.insert(words.end(), {"--rig", name_});
    for (const std::string& key : overrides_) words.insert(words.end(), {"--set", key});
    return std::make_unique<Process>(words, folder_ / (program + std::to_string(++started_)));
  }

  /// A client from start to end. @return its exit code; `said` has its output.
  int run(const std::string& program, const Words& arguments, const Words& launcher = {}) {
    const auto client = start(program, arguments, launcher);
    const int code = client->wait();
    said = client->output();
    return code;
  }

  const std::filesystem::path& folder() const { return folder_; }

  Rig rig;
  std::string said;

 private:
  static std::filesystem::path make_folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    return ::mkdtemp(pattern.data());
  }

  std::string name_;
  Words overrides_;
  std::filesystem::path folder_;
  int started_ = 0;
};

}  // namespace gyrotwin::support
