// gyrotwin-log on a rig that runs: everything is recorded, and comes back as it was.
#include "clients/log/log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "services/runtime/clock.hpp"
#include "services/runtime/tap.hpp"
#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;
using support::Process;

struct Message {
  std::string channel;
  LogBytes payload;
  bool operator==(const Message&) const = default;
};

std::vector<Message> read(const std::filesystem::path& path) {
  std::vector<Message> all;
  Log log(path);
  while (const auto event = log.next()) {
    if (is_log_channel(event->channel)) continue;
    all.push_back({std::string(event->channel), {event->data.begin(), event->data.end()}});
  }
  EXPECT_FALSE(log.damage().any()) << path << ": " << log.damage_text();
  return all;
}

/// @return how many messages a file holds that may still be written to, or end anywhere
std::int64_t messages_in(Log& log) {
  std::int64_t count = 0;
  while (const auto event = log.next()) count += is_log_channel(event->channel) ? 0 : 1;
  return count;
}

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// Waits for what may take a while on a busy machine. @return whether it came
template <class Holds>
bool soon(Holds&& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

bool says(const Process& process, const std::string& what) {
  return process.output().find(what) != std::string::npos;
}

std::unique_ptr<Process> start_recording(Lab& lab, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "record");
  auto recorder = lab.start("log", arguments);
  EXPECT_TRUE(soon([&] { return says(*recorder, "recording") || !recorder->running(); }));
  EXPECT_TRUE(says(*recorder, "recording")) << recorder->output();
  return recorder;
}

int stop_recording(Process& recorder, int signal = SIGTERM) {
  recorder.signal(signal);
  return recorder.wait();
}

/// A subcommand that asks the log alone, not a rig. @return its exit code; lab.said is its output
int ask_log(Lab& lab, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), std::string(GYROTWIN_BIN) + "/gyrotwin-log");
  Process client(arguments, lab.folder() / "asked.txt");
  const int code = client.wait();
  lab.said = client.output();
  return code;
}

/// STATE messages of the lab's rig, as its owner would send them.
void send_states(Lab& lab, std::int64_t first, std::int64_t count) {
  state_t state{};
  for (std::int64_t i = first; i < first + count; ++i) {
    state.tilt_rad[0] = 1e-3 * static_cast<double>(i);
    lab.bus->send(Channel::kState, state, {.epoch = 5, .sequence = i, .tick = i});
  }
}

TEST(Log, RecordsARunningRigWholeAndReplaysItByteForByte) {
  Lab lab("double_brennan", {"loop.clock=lockstep"});
  const std::filesystem::path first = lab.folder() / "first.lcm",
                              again = lab.folder() / "again.lcm";
  const auto recorder = start_recording(lab, {first});
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.arm());
  ASSERT_TRUE(lab.until([](const Reception& heard) {
    state_t state{};
    if (heard.channel == Channel::kState) Bus::decode(heard, state);
    return state.header.tick >= 1000;
  }));
  ASSERT_EQ(lab.run("ctl", {"disarm"}), 0) << lab.said;

  // Who owns the rig is not talked over.
  ASSERT_EQ(lab.run("log", {"replay", first}), 1);
  EXPECT_NE(lab.said.find("stop it first"), std::string::npos) << lab.said;
  lab.owner->signal(SIGTERM);
  lab.controller->signal(SIGTERM);
  EXPECT_EQ(lab.owner->wait(), 0);
  EXPECT_EQ(lab.controller->wait(), 0);
  ASSERT_EQ(stop_recording(*recorder), 0) << recorder->output();
  EXPECT_TRUE(says(*recorder, "lost: nothing")) << recorder->output();

  // Lockstep leaves out no tick, so neither does the record.
  const std::vector<Message> recorded = read(first);
  std::int64_t tick = -1;
  for (const Message& message : recorded) {
    if (message.channel != "DOUBLE_BRENNAN/LIVE/STATE") continue;
    state_t state{};
    ASSERT_GT(state.decode(message.payload.data(), 0, static_cast<int>(message.payload.size())), 0);
    if (state.mode == status_t::MODE_HELD) continue;
    ASSERT_LE(state.header.tick, tick + 1);
    tick = std::max(tick, state.header.tick);
  }
  EXPECT_GE(tick, 1000);

  const auto second = start_recording(lab, {again});
  ASSERT_EQ(lab.run("log", {"replay", "--speed", "4", first}), 0) << lab.said;
  ASSERT_EQ(stop_recording(*second, SIGINT), 0) << second->output();
  EXPECT_EQ(read(again), recorded);

  ASSERT_EQ(ask_log(lab, {"info", again}), 0) << lab.said;
  for (const std::string part : {"damage: none", "checked with key", "HELD, RUNNING, SAFE_STOP",
                                 "arm: APPLIED at tick", "disarm: APPLIED at tick"}) {
    EXPECT_NE(lab.said.find(part), std::string::npos) << part << "\n" << lab.said;
  }
}

TEST(Log, KillNineKeepsWhatHadArrived) {
  constexpr std::int64_t kMessages = 5000;
  Lab lab("double_brennan");
  const std::filesystem::path path = lab.folder() / "run.lcm";
  const auto recorder = start_recording(lab, {path});
  send_states(lab, 0, kMessages);
  // Nothing but time makes it write: no signal, no size.
  ASSERT_TRUE(soon([&] {
    Log log(path);
    return messages_in(log) >= kMessages;
  }));
  recorder->signal(SIGKILL);
  recorder->wait();
  EXPECT_EQ(read(path).size(), static_cast<std::size_t>(kMessages));
}

TEST(Log, KilledAmidAStreamTheFileEndsWithTheLastRecordAtMost) {
  Lab lab("double_brennan");
  const std::filesystem::path path = lab.folder() / "run.lcm";
  const auto recorder = start_recording(lab, {path});
  constexpr std::int64_t kMost = 500'000;
  const auto started = std::filesystem::file_size(path);
  std::int64_t sent = 0;
  // A recorder that a busy machine has not let write yet would prove nothing by its death. A STATE
  // takes less than 1000 bytes.
  for (; sent < kMost && recorder->running(); sent += 100) {
    if (std::filesystem::file_size(path) > started + 100'000) recorder->signal(SIGKILL);
    send_states(lab, sent, 100);
  }
  ASSERT_LT(sent, kMost) << "less than 100 kB was written";
  recorder->wait();
  Log log(path);
  EXPECT_GT(messages_in(log), 100);
  EXPECT_LE(log.damage().events_lost, 1) << log.damage_text();
}

TEST(Log, TermDrainsWhatHasArrived) {
  constexpr std::int64_t kMessages = 20'000;
  Lab lab("double_brennan");
  const std::filesystem::path path = lab.folder() / "run.lcm";
  const auto recorder = start_recording(lab, {path});
  recorder->signal(SIGSTOP);  // so that they wait in the socket
  send_states(lab, 0, kMessages);
  recorder->signal(SIGTERM);
  recorder->signal(SIGCONT);
  ASSERT_EQ(recorder->wait(), 0) << recorder->output();
  // Where the kernel grants less than they take, what it dropped is told.
  const auto kept = static_cast<std::int64_t>(read(path).size());
  if (kept == kMessages) {
    EXPECT_TRUE(says(*recorder, "lost: nothing")) << recorder->output();
  } else {
    EXPECT_TRUE(says(*recorder, "lost: " + std::to_string(kMessages - kept) + " that the receive"))
        << recorder->output();
  }
}

TEST(Log, RotatesWithoutLosingAMessage) {
  constexpr std::int64_t kMessages = 3000;
  Lab lab("double_brennan");
  const std::filesystem::path path = lab.folder() / "run.lcm";
  const auto recorder = start_recording(lab, {"--rotate-mb", "0.2", path});
  send_states(lab, 0, kMessages);
  ASSERT_TRUE(soon([&] { return std::filesystem::exists(lab.folder() / "run.000004.lcm"); }));
  ASSERT_EQ(stop_recording(*recorder), 0) << recorder->output();
  std::int64_t next = 0;
  int files = 0;
  for (auto file = lab.folder() / "run.000001.lcm"; std::filesystem::exists(file);
       file = lab.folder() / ("run.00000" + std::to_string(files + 1) + ".lcm")) {
    ++files;
    EXPECT_LE(std::filesystem::file_size(file), 200'000U);
    for (const Message& message : read(file)) {
      state_t state{};
      state.decode(message.payload.data(), 0, static_cast<int>(message.payload.size()));
      ASSERT_EQ(state.header.sequence, next++);
    }
  }
  EXPECT_EQ(next, kMessages);
  EXPECT_GT(files, 4);

  EXPECT_EQ(lab.run("log", {"record", "--rotate-mb", "0.2", path}), 2) << lab.said;
  EXPECT_NE(lab.said.find("exists already"), std::string::npos) << lab.said;
  EXPECT_EQ(lab.run("log", {"record", "--keep", "3", lab.folder() / "other.lcm"}), 2) << lab.said;
  EXPECT_NE(lab.said.find("add --rotate-mb"), std::string::npos) << lab.said;
}

TEST(Log, RotatesForEverInBoundedRoom) {
  Lab lab("double_brennan");
  const auto recorder =
      start_recording(lab, {"--rotate-mb", "0.2", "--keep", "2", lab.folder() / "run.lcm"});
  send_states(lab, 0, 3000);
  // By the time one looks the fifth may have gone again.
  ASSERT_TRUE(soon([&] {
    return std::filesystem::exists(lab.folder() / "run.000005.lcm") ||
           std::filesystem::exists(lab.folder() / "run.000006.lcm") ||
           std::filesystem::exists(lab.folder() / "run.000007.lcm");
  }));
  ASSERT_EQ(stop_recording(*recorder), 0) << recorder->output();
  EXPECT_TRUE(says(*recorder, "the last 2 of ")) << recorder->output();
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(lab.folder())) {
    files += file.path().extension() == ".lcm" ? 1 : 0;
  }
  EXPECT_EQ(files, 2);
}

TEST(Log, AFullDiskIsSaidAndKeepsWhatWasRecorded) {
  Lab lab("double_brennan");
  const std::filesystem::path path = lab.folder() / "run.lcm";
  Process recorder(
      {"/usr/bin/prlimit", "--fsize=200000", std::string(GYROTWIN_BIN) + "/gyrotwin-log", "record",
       path, "--rig", "double_brennan"},
      lab.folder() / "recorder.txt");
  ASSERT_TRUE(soon([&] { return says(recorder, "recording"); })) << recorder.output();
  for (std::int64_t sent = 0; recorder.running() && sent < 1'000'000; sent += 100) {
    send_states(lab, sent, 100);
  }
  EXPECT_EQ(recorder.wait(), 1);
  EXPECT_TRUE(says(recorder, "no more can be written: File too large; its first"))
      << recorder.output();
  const std::size_t kept = read(path).size();
  EXPECT_GT(kept, 400U);
  EXPECT_TRUE(says(recorder, "recorded " + std::to_string(kept) + " messages"))
      << recorder.output();
}

// 20,000 messages a second with lcm-logger on the same bus; counts alone are judged.
TEST(Log, KeepsUpWithTwentyThousandASecondBesideLcmLogger) {
  constexpr std::int64_t kMessages = 100'000;
  Lab lab("double_brennan");
  const std::filesystem::path path = lab.folder() / "run.lcm";
  const auto recorder = start_recording(lab, {path});
  Process logger({"/usr/bin/lcm-logger", "-q",
                  "--lcm-url=udpm://" + lab.rig.network.group + ":" +
                      std::to_string(lab.rig.network.port) + "?ttl=0",
                  lab.folder() / "theirs.lcm"},
                 lab.folder() / "logger.txt");
  ASSERT_TRUE(soon([&] { return std::filesystem::exists(lab.folder() / "theirs.lcm"); }));
  const MonotonicClock reference;
  MonotonicClock clock;
  const std::int64_t begin = reference.now_ns();
  for (std::int64_t i = 0; i < kMessages; i += 20) {  // each millisecond
    clock.sleep_until(begin + i * 50'000);
    send_states(lab, i, 20);
  }
  const double seconds = 1e-9 * static_cast<double>(reference.now_ns() - begin);
  ASSERT_EQ(stop_recording(*recorder), 0) << recorder->output();
  logger.signal(SIGINT);
  logger.wait();
  Log theirs(lab.folder() / "theirs.lcm");
  std::int64_t their_count = 0;
  while (theirs.next()) ++their_count;
  std::printf("%lld messages in %.2f s; lcm-logger kept %lld\n", static_cast<long long>(kMessages),
              seconds, static_cast<long long>(their_count));
  EXPECT_EQ(read(path).size(), static_cast<std::size_t>(kMessages)) << recorder->output();
  EXPECT_TRUE(says(*recorder, "lost: nothing")) << recorder->output();
}

TEST(Log, RecoversWhatIsSoundAndTellsTheLoss) {
  Lab lab("double_brennan");
  const std::filesystem::path path = lab.folder() / "run.lcm", cut = lab.folder() / "cut.lcm",
                              whole = lab.folder() / "whole.lcm";
  const auto recorder = start_recording(lab, {path});
  send_states(lab, 0, 100);
  ASSERT_EQ(stop_recording(*recorder), 0) << recorder->output();
  std::string bytes = text_of(path);
  bytes[bytes.size() - 5000] ^= 1;
  bytes.resize(bytes.size() - 10);
  std::ofstream(cut) << bytes;
  ASSERT_EQ(ask_log(lab, {"recover", cut, whole}), 0) << lab.said;
  EXPECT_NE(lab.said.find("lost: 2 events lost"), std::string::npos) << lab.said;
  EXPECT_NE(lab.said.find("1 events did not have the rig's signature"), std::string::npos)
      << lab.said;
  EXPECT_EQ(read(whole).size(), 98U);
  EXPECT_EQ(ask_log(lab, {"recover", cut, whole}), 2) << "an existing file is kept";

  // What reads a damaged log says so.
  ASSERT_EQ(ask_log(lab, {"cat", "--channel", "LIVE/STATE", cut}), 0) << lab.said;
  EXPECT_NE(lab.said.find("is damaged: 2 events lost"), std::string::npos) << lab.said;
}

TEST(Log, CatEndsWellWhenItsReaderGoes) {
  Lab lab("double_brennan");
  const std::filesystem::path path = lab.folder() / "run.lcm";
  const auto recorder = start_recording(lab, {path});
  send_states(lab, 0, 5000);
  ASSERT_EQ(stop_recording(*recorder), 0) << recorder->output();
  Process shell({"/bin/bash", "-o", "pipefail", "-c",
                 std::string(GYROTWIN_BIN) + "/gyrotwin-log cat " + path.string() + " | head -n 3"},
                lab.folder() / "cat.txt");
  EXPECT_EQ(shell.wait(), 0) << shell.output();
  const std::string lines = shell.output();
  EXPECT_EQ(std::ranges::count(lines, '\n'), 3) << lines;
  EXPECT_NE(lines.find("DOUBLE_BRENNAN/LIVE/STATE sequence 1 tick 1 tilt_rad 0.001,0"),
            std::string::npos)
      << lines;
}

}  // namespace
}  // namespace gyrotwin
