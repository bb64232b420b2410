#include "services/gateway/recorder.hpp"

#include <signal.h>
#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

namespace gyrotwin {

namespace {

namespace fs = std::filesystem;
using foxglove::Json;

constexpr std::string_view kEnd = ".lcm";

/// A name that leads nowhere else.
bool is_plain(std::string_view name) {
  return name.ends_with(kEnd) && !name.starts_with('.') &&
         std::ranges::all_of(name, [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
         });
}

std::int64_t size_of(const fs::path& file) {
  std::error_code none;
  const auto size = fs::file_size(file, none);
  return none ? 0 : static_cast<std::int64_t>(size);
}

}  // namespace

Recorder::Recorder(std::string rig_name, fs::path folder, std::vector<std::string> rig_arguments)
    : rig_name_(std::move(rig_name)),
      folder_(std::move(folder)),
      rig_arguments_(std::move(rig_arguments)) {}

/// The child flushes what it has; it also ends by itself when this process is no more.
Recorder::~Recorder() {
  if (child_ == 0) return;
  kill(child_, SIGINT);
  waitpid(child_, nullptr, 0);
}

Json Recorder::wish(bool on) {
  look();
  if (on && ending_ && child_ != 0) {
    Json json = look();
    json["error"] = "the last recording is being closed: try again in a moment";
    return json;
  }
  if (on && child_ == 0) begin();
  if (!on && child_ != 0 && !ending_) {
    kill(child_, SIGINT);
    ending_ = true;
  }
  return look();
}

void Recorder::begin() {
  std::error_code failure;
  fs::create_directories(folder_, failure);
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  error_ = failure ? folder_.string() + ": " + failure.message() : std::string();
  ending_ = false;
  if (failure) return;
  const std::string stem = fmt::format("{}-{:%Y%m%d-%H%M%S}", rig_name_, local);
  file_ = stem + std::string(kEnd);
  for (int i = 2; fs::exists(folder_ / file_); ++i) file_ = fmt::format("{}-{}{}", stem, i, kEnd);

  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none).parent_path() / "gyrotwin-log";
  std::vector<std::string> words{program.string(), "record", (folder_ / file_).string()};
  words.insert(words.end(), rig_arguments_.begin(), rig_arguments_.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  // What the service manager is told is told of the gateway.
  std::vector<char*> environment;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!std::string_view(*variable).starts_with("NOTIFY_SOCKET="))
      environment.push_back(*variable);
  }
  environment.push_back(nullptr);
  const pid_t parent = getpid();
  child_ = fork();
  if (child_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGINT);
    if (getppid() != parent) _exit(1);
    close_range(STDERR_FILENO + 1, ~0u, 0);  // sockets are the gateway's alone
    execve(arguments[0], arguments.data(), environment.data());
    _exit(127);
  }
  if (child_ < 0) {
    child_ = 0;
    error_ = std::string("fork: ") + std::strerror(errno);
  }
}

Json Recorder::look() {
  int status = 0;
  if (child_ != 0 && waitpid(child_, &status, WNOHANG) == child_) {
    child_ = 0;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      error_ = "gyrotwin log record failed; the gateway's log says why";
    }
  }
  Json json{{"on", child_ != 0 && !ending_}};
  if (!file_.empty()) {
    json["file"] = file_;
    json["bytes"] = size_of(folder_ / file_);
  }
  if (!error_.empty()) json["error"] = error_;
  return json;
}

Json Recorder::list() const {
  std::vector<std::pair<fs::file_time_type, std::string>> found;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder_, none)) {
    const std::string name = entry.path().filename().string();
    if (is_plain(name)) found.emplace_back(entry.last_write_time(none), name);
  }
  std::ranges::sort(found, std::greater<>());
  Json list = Json::array();
  for (const auto& [time, name] : found) {
    list.push_back({{"name", name}, {"bytes", size_of(folder_ / name)}});
  }
  return list;
}

fs::path Recorder::find(std::string_view name) const {
  std::error_code none;
  const fs::path file = folder_ / name;
  return is_plain(name) && fs::is_regular_file(file, none) ? file : fs::path();
}

}  // namespace gyrotwin
