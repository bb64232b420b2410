// A simulated run as a log in a file: SENSORS, STATE and COMMAND of every tick, as a recorder would
// have kept them. Link gyrotwin_log_file, gyrotwin_integrator_core, gyrotwin_controller_core.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "clients/log/catalog.hpp"
#include "clients/log/log_file.hpp"
#include "tests/support/estimated_loop.hpp"

namespace gyrotwin::support {

/// Writes messages as a recorder would.
class LogMaker {
 public:
  LogMaker(const std::filesystem::path& path, const Rig& rig, const std::string& rig_text)
      : rig_(rig), writer_(path) {
    const About about{.program = "test",
                      .host = "here",
                      .rig = rig.name,
                      .prefix = rig.network.prefix,
                      .rig_id = rig.id,
                      .key = "",
                      .channels = channels_of(rig.network.prefix)};
    LogBytes events = opening_events(about, lcm_sources(), rig_text, kBegin);
    writer_.append(events);
  }

  template <class Message>
  void add(Channel channel, Message message, std::int64_t tick) {
    message.header.rig_id = rig_.id;
    message.header.epoch = kEpoch;
    message.header.sequence = tick + 1;
    message.header.tick = tick;
    message.header.sim_time_ns = tick * rig_.loop.tick_ns();
    LogBytes data(kWireSize<Message>);
    message.encode(data.data(), 0, static_cast<int>(data.size()));
    const std::string name = rig_.network.prefix + '/' + std::string(spec(channel).suffix);
    LogBytes events;
    append_event(events, {0, kBegin + tick * rig_.loop.tick_ns() / 1000, name, data});
    writer_.append(events);
  }

  static constexpr std::int64_t kEpoch = 7;

 private:
  static constexpr std::int64_t kBegin = 1'700'000'000'000'000;  // [us]
  const Rig& rig_;
  LogWriter writer_;
};

/// A folder that goes when it is done with.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// What is recorded.
struct RunToRecord {
  std::string rig;
  std::vector<std::string> overrides = {};
  double seconds = 1.0;
  /// Added to the law's torques, tick by tick [N m].
  std::function<double(std::int64_t tick, int drive)> excitation = {};
  bool law = true;  ///< false: the excitation alone
  std::int32_t mode = status_t::MODE_RUNNING;
  std::function<void(model::Input&)> load = {};  ///< what acts besides
  bool spin_down = false;                        ///< asked for before the first tick
  std::function<void(std::int64_t tick, sensors_t&)> spoil = {};  ///< what is measured
};

/// Runs it in the very steps of a live system and writes the log.
inline void record_run(const std::filesystem::path& path, const RunToRecord& what) {
  EstimatedLoop loop(what.rig, what.overrides);
  LogMaker log(path, loop.rig, print_rig(what.rig, what.overrides));
  const auto ask_to_spin_down = [&] {
    request_t request{};
    request.verb = request_t::ROTORS;
    request.kind = request_t::SPIN_DOWN;
    request.writer = request.counter = 1;
    log.add(Channel::kRequest, request, 0);
    reply_t reply{};
    reply.result = reply_t::APPLIED;
    reply.request_writer = reply.request_counter = 1;
    log.add(Channel::kReply, reply, 0);
  };
  const auto ticks = std::llround(what.seconds * loop.rig.loop.rate_hz);
  for (std::int64_t k = 0; k <= ticks; ++k) {
    sensors_t sensors{};
    loop.simulated.measure(k, loop.plant.state(), loop.input,
                           loop.machine.truth(loop.plant.state(), loop.input), sensors);
    if (what.spoil) what.spoil(k, sensors);
    state_t state{};
    state.mode = what.mode;
    log.add(Channel::kSensors, sensors, k);
    log.add(Channel::kState, state, k);
    if (k == 0 && what.spin_down) ask_to_spin_down();

    model::Input input;
    if (what.law) input.drive = loop.law.step(loop.machine.observe(loop.plant.state()));
    for (std::size_t i = 0; what.excitation && i < loop.machine.drives.size(); ++i) {
      input.drive[i] += what.excitation(k, static_cast<int>(i));
    }
    if (what.mode == status_t::MODE_RUNNING) {
      command_t command{};
      command.mode = command_t::TORQUE_NM;
      command.valid_ticks = 5;
      std::copy(input.drive.begin(), input.drive.end(), command.value);
      command.for_tick = k;
      command.owner_epoch = LogMaker::kEpoch;
      command.writer = 1;
      command.counter = k + 1;
      log.add(Channel::kCommand, command, k);
    }
    if (what.load) what.load(input);
    if (what.spin_down) input.rotor_powered.fill(false);
    loop.input = input;
    loop.plant.advance(input);
  }
}

}  // namespace gyrotwin::support
