// `gyrotwin top` beside a rig that runs, loses its daemons, and in a terminal.
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;
using Json = nlohmann::json;

/// Whether a whole line of what `top` has printed is an object that satisfies `holds`.
template <class Holds>
bool any_object(const support::Process& top, Holds&& holds) {
  std::istringstream lines(top.output());
  std::string line;
  while (std::getline(lines, line) && !lines.eof()) {
    if (holds(Json::parse(line))) return true;
  }
  return false;
}

/// Waits for such an object.
template <class Holds>
bool comes(Lab& lab, const support::Process& top, Holds&& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  const auto never = [](const Reception&) { return false; };
  while (!any_object(top, holds)) {
    if (std::chrono::steady_clock::now() > end) return false;
    lab.until(never, 0.1);
  }
  return true;
}

TEST(Top, PrintsPlainBlocksOfALiveRig) {
  Lab lab("prototype_b");
  lab.start_daemons();
  lab.balance();
  ASSERT_EQ(lab.run("top", {"--count", "2", "--interval", "0.5"}), 0) << lab.said;
  for (const char* part : {"\nRUNNING ", "tilt x, roll", "margins  tilt", "owner       RUNNING",
                           "controller  ACTIVE", "contact N", "never came  here"}) {
    EXPECT_NE(lab.said.find(part), std::string::npos) << part << " is not in\n" << lab.said;
  }
  EXPECT_EQ(lab.said.find('\x1b'), std::string::npos) << "not a terminal";
}

TEST(Top, FollowsARigThroughItsTroubles) {
  Lab lab("prototype_b");
  const auto top = lab.start("top", {"--json", "--interval", "0.1"});
  lab.start_daemons();
  lab.balance();
  EXPECT_TRUE(comes(lab, *top, [](const Json& o) {
    return o["state"].is_object() && o["state"]["tick"] > 0 &&
           o["channels"]["LIVE/STATE"]["per_s"] > 0.0 && o["margins"]["tilt_rad"] > 0.0;
  })) << top->output();
  ASSERT_EQ(lab.run("disturb", {"step", "--roll", "0.1", "--duration", "3600"}), 0) << lab.said;
  EXPECT_TRUE(comes(lab, *top, [](const Json& o) {
    return o["acting"].size() == 1 && o["owner"]["disturbances"] == 1;
  }));

  lab.controller->signal(SIGKILL);
  EXPECT_TRUE(comes(lab, *top, [](const Json& o) {
    return o["controller"].is_object() && o["controller"]["alive"] == false &&
           o["owner"]["mode"] == "SAFE_STOP";
  }));
  lab.owner->signal(SIGKILL);
  lab.owner->wait();
  EXPECT_TRUE(comes(lab, *top, [](const Json& o) {
    return o["owner"].is_object() && o["owner"]["alive"] == false && o["state"]["stale"] == true &&
           o["margins"]["tilt_rad"].is_null();
  })) << top->output();

  top->signal(SIGTERM);
  EXPECT_EQ(top->wait(), 0);
}

/// What top writes in a terminal of its own until it ends; once it draws, `leave` is typed and
/// `signal` sent, where there are such.
std::string in_terminal(const std::string& leave, int signal, int& status) {
  int terminal = -1;
  winsize window{};
  window.ws_row = 24;
  window.ws_col = 80;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &window);
  if (child == 0) {
    const std::string program = std::string(GYROTWIN_BIN) + "/gyrotwin-top";
    ::execl(program.c_str(), program.c_str(), "--rig", "prototype_b", nullptr);
    ::_exit(127);
  }
  std::string said;
  bool left = false;
  char part[4096];
  for (;;) {
    const ssize_t count = ::read(terminal, part, sizeof part);
    if (count <= 0) break;  // its end closes the terminal
    said.append(part, static_cast<std::size_t>(count));
    if (left || said.find("margins") == std::string::npos) continue;
    left = true;
    if (signal != 0) ::kill(child, signal);
    if (::write(terminal, leave.data(), leave.size()) < 0) break;
  }
  ::waitpid(child, &status, 0);
  ::close(terminal);
  return said;
}

TEST(Top, GivesTheTerminalBackHoweverItEnds) {
  const Lab lab("prototype_b");  // its key
  const struct {
    const char* keys;
    int signal;
  } kWays[] = {{"q", 0}, {"\x03", 0}, {"", SIGTERM}, {"", SIGHUP}};
  for (const auto& way : kWays) {
    int status = 0;
    const std::string said = in_terminal(way.keys, way.signal, status);
    EXPECT_TRUE(said.starts_with("\x1b[?1049h")) << said;
    EXPECT_TRUE(said.ends_with("\x1b[?25h\x1b[?1049l")) << said;
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  }
}

}  // namespace
}  // namespace gyrotwin
