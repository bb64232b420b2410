#include "clients/calibrate/recording.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "clients/common/run_name.hpp"
#include "clients/log/log.hpp"
#include "services/integrator/schedule.hpp"
#include "services/onboard/safe_stop.hpp"
#include "services/runtime/command_gate.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/observation_wire.hpp"

namespace gyrotwin::calibration {

namespace {

constexpr std::int64_t kLongestGap = 20;   // without SENSORS [tick]
constexpr double kLongestLeap_s = 60.0;    // from one message to the next
constexpr std::size_t kShortestRun = 20;   // [tick]
constexpr std::int32_t kUnknownMode = -1;  // no STATE was heard yet

/// A tick as the log shows it.
struct Tick {
  std::int64_t tick = 0;
  std::int32_t mode = kUnknownMode;
  std::optional<sensors_t> sensors = {};
  model::Input input = {};  // while commands act
};

/// One epoch of the owner.
struct Run {
  std::int64_t epoch = 0;
  std::vector<Tick> ticks;
};

template <class Message>
std::optional<Message> decoded(const LogEvent& event) {
  Message message{};
  if (event.data.size() != kWireSize<Message>) return std::nullopt;
  const int size = static_cast<int>(event.data.size());
  return message.decode(event.data.data(), 0, size) == size ? std::optional(message) : std::nullopt;
}

/// Does, with what was recorded, what the owner did with what it heard.
class Follower {
 public:
  Follower(const Rig& rig, const model::Machine& machine, std::string file)
      : rig_(rig),
        file_(std::move(file)),
        gate_(rig.safety.command_timeout_ticks, rig.loop.command_delay_ticks),
        schedule_(rig, machine),
        prefix_(rig.network.prefix + '/') {}

  void take(const LogEvent& event) {
    if (!event.channel.starts_with(prefix_)) return;
    const std::string_view suffix = event.channel.substr(prefix_.size());
    if (suffix == spec(Channel::kSensors).suffix) {
      if (const auto sensors = decoded<sensors_t>(event); sensors && arrive(sensors->header)) {
        now().sensors = *sensors;
      }
    } else if (suffix == spec(Channel::kState).suffix) {
      if (const auto state = decoded<state_t>(event); state && arrive(state->header)) {
        now().mode = state->mode;
      }
    } else if (suffix == spec(Channel::kCommand).suffix) {
      if (const auto command = decoded<command_t>(event); command && !runs_.empty()) {
        gate_.offer(*command, now().tick);
      }
    } else if (suffix == spec(Channel::kRequest).suffix) {
      if (const auto request = decoded<request_t>(event)) {
        asked_[{request->writer, request->counter}] = *request;
      }
    } else if (suffix == spec(Channel::kReply).suffix) {
      if (const auto reply = decoded<reply_t>(event)) obey(*reply);
    }
  }

  std::vector<Run> runs() { return std::move(runs_); }

 private:
  Tick& now() { return runs_.back().ticks.back(); }
  bool is_over(std::int64_t epoch) const {
    return std::ranges::find(runs_, epoch, &Run::epoch) != runs_.end();
  }

  /// @return whether the message is of the present tick, which it may begin
  bool arrive(const header_t& header) {
    if (header.tick < 0) return false;
    if (runs_.empty() || runs_.back().epoch != header.epoch) {
      if (is_over(header.epoch)) return false;
      runs_.push_back({header.epoch, {{.tick = header.tick}}});
      gate_.reset(header.epoch);
      schedule_.reset();
      powered_ = true;
      return true;
    }
    if (header.tick < now().tick) return false;
    const std::int64_t from = now().tick;
    if (header.tick - from > leap_) {
      throw Error(
          fmt::format("{}: tick {} comes right after tick {} of run {}: a leap of more than "
                      "{:g} s is damage, or a record with a hole; record it again",
                      file_, header.tick, from, run_name(header.epoch), kLongestLeap_s));
    }
    while (now().tick < header.tick) {
      Tick& past = now();
      past.input = acting(past.tick);
      runs_.back().ticks.push_back({.tick = past.tick + 1, .mode = past.mode});
    }
    return true;
  }

  model::Input acting(std::int64_t tick) {
    model::Input input;
    if (const command_t* command = gate_.acting(tick); command && !schedule_.command_lost(tick)) {
      from_wire(*command, input);
    }
    input.rotor_powered.fill(powered_);
    schedule_.apply(tick, input);
    return input;
  }

  void obey(const reply_t& reply) {
    const auto asked = asked_.find({reply.request_writer, reply.request_counter});
    if (asked == asked_.end() || reply.result != reply_t::APPLIED || runs_.empty()) return;
    request_t request = asked->second;
    asked_.erase(asked);  // an answer that is repeated does nothing
    request.start_tick = reply.applied_tick;
    reply_t ignored{};
    if (request.verb == request_t::DISTURB || request.verb == request_t::FAULT) {
      schedule_.add(request, std::min(now().tick, reply.applied_tick), ignored);
    } else if (request.verb == request_t::CANCEL) {
      schedule_.cancel(request.id, ignored);
    } else if (request.verb == request_t::CLEAR) {
      schedule_.clear();
    } else if (request.verb == request_t::ROTORS) {
      powered_ = request.kind == request_t::SPIN_UP;
    }
  }

  const Rig& rig_;
  std::string file_;
  std::int64_t leap_ = std::llround(kLongestLeap_s / rig_.loop.tick_s());  // [tick]
  CommandGate gate_;
  Schedule schedule_;
  std::string prefix_;
  std::vector<Run> runs_;
  std::map<std::pair<std::int64_t, std::int64_t>, request_t> asked_;
  bool powered_ = true;
};

/// What drives the plant in a mode.
enum class Rule : std::uint8_t { kCommands, kSafeStop, kUnknown };

Rule rule_of(std::int32_t mode, const Rig& rig) {
  switch (mode) {
    case kUnknownMode:
    case status_t::MODE_RUNNING:
    case status_t::MODE_PAUSED:
      return Rule::kCommands;
    case status_t::MODE_SAFE_STOP:
      // The speed that it holds is that of an instant that SENSORS does not tell.
      return rig.safety.drive == SafeStopDrive::kHoldSpeed ? Rule::kUnknown : Rule::kSafeStop;
    default:
      return Rule::kUnknown;
  }
}

/// Cuts a run where it is unknown what acted, or what was measured.
class Cutter {
 public:
  Cutter(const Rig& rig, const model::Machine& machine, const Circumstances& circumstances)
      : rig_(rig), machine_(machine), circumstances_(circumstances) {}

  void cut(const Run& run, const std::string& file, std::vector<Stretch>& stretches) const {
    Stretch stretch{file, run.epoch, rig_.loop.tick_s(), {}};
    const auto finish = [&] {
      while (!stretch.moments.empty() && !stretch.moments.back().sensors) {
        stretch.moments.pop_back();
      }
      if (stretch.moments.size() >= kShortestRun) stretches.push_back(stretch);
      stretch.moments.clear();
    };
    std::int64_t unheard = 0;
    for (std::size_t i = 0; i < run.ticks.size(); ++i) {
      const bool meant = is_meant(run.ticks[i].tick);
      Moment moment = moment_at(run, i);
      unheard = moment.sensors ? 0 : unheard + 1;
      if (!meant || unheard > kLongestGap) finish();
      if (meant && (moment.sensors || !stretch.moments.empty())) stretch.moments.push_back(moment);
      if (!is_known(run, i)) finish();
    }
    finish();
  }

 private:
  bool is_meant(std::int64_t tick) const {
    const double t = rig_.loop.tick_s() * static_cast<double>(tick);
    return t >= circumstances_.from_s && t <= circumstances_.to_s;
  }

  /// Whether there is a current of every motor.
  bool has_currents(const sensors_t& sensors) const {
    return (sensors.valid & sensors_t::VALID_CURRENTS) != 0 &&
           std::all_of(sensors.drive_current_a, sensors.drive_current_a + machine_.drives.size(),
                       [](double current) { return std::isfinite(current); });
  }

  /// What acts from tick `i` on to the next one.
  bool is_known(const Run& run, std::size_t i) const {
    if (i + 1 >= run.ticks.size()) return false;
    const Rule rule = rule_of(run.ticks[i].mode, rig_);
    return rule != Rule::kUnknown && rule == rule_of(run.ticks[i + 1].mode, rig_);
  }

  Moment moment_at(const Run& run, std::size_t i) const {
    const Tick& tick = run.ticks[i];
    Moment moment{tick.tick, {}, tick.input, {}};
    // SENSORS shows what was measured that many ticks before.
    const std::size_t told = i + static_cast<std::size_t>(rig_.sensors->delay_ticks);
    if (told < run.ticks.size()) moment.sensors = run.ticks[told].sensors;
    if (rule_of(tick.mode, rig_) == Rule::kSafeStop) {
      const model::Input stop = SafeStop(rig_, machine_).input({});
      moment.input.mode = stop.mode;
      moment.input.drive = stop.drive;
    }
    // A current is that of the end of its tick.
    if (circumstances_.drive == DriveSource::kCurrent && told + 1 < run.ticks.size()) {
      const auto& next = run.ticks[told + 1].sensors;
      if (next && has_currents(*next)) {
        std::copy_n(next->drive_current_a, model::kMaxDrives, moment.current.emplace().begin());
      }
    }
    for (const model::PointMass& mass : circumstances_.added) moment.input.added.add(mass);
    return moment;
  }

  const Rig& rig_;
  const model::Machine& machine_;
  const Circumstances& circumstances_;
};

/// @throws Error unless the log says that it is of this rig, or nothing
void require_rig(const std::string& file, const Catalog& catalog, const Rig& rig) {
  const auto& about = catalog.about();
  if (about && (about->rig != rig.name || about->rig_id != rig.id)) {
    throw Error(
        fmt::format("{}: is a log of rig {} (id {}), not of {} (id {}); give its rig file "
                    "with --rig",
                    file, about->rig, about->rig_id, rig.name, rig.id));
  }
}

/// @throws Error where time goes otherwise than the rig file says
void require_rate(const std::string& file, const std::vector<Run>& runs, const Rig& rig) {
  for (const Run& run : runs) {
    for (const Tick& tick : run.ticks) {
      if (tick.tick == 0 || !tick.sensors) continue;
      if (tick.sensors->header.sim_time_ns == tick.tick * rig.loop.tick_ns()) break;
      throw Error(
          fmt::format("{}: its ticks last {:g} s, those of rig {} {:g} s: set loop.rate_hz "
                      "as it was",
                      file,
                      1e-9 * static_cast<double>(tick.sensors->header.sim_time_ns) /
                          static_cast<double>(tick.tick),
                      rig.name, rig.loop.tick_s()));
    }
  }
}

/// @throws Error where more is on the structure than a machine carries
void require_room(const std::string& file, const std::vector<Run>& runs,
                  const Circumstances& circumstances) {
  for (const Run& run : runs) {
    for (const Tick& tick : run.ticks) {
      if (tick.input.added.size + circumstances.added.size() <= model::kMaxAddedMasses) continue;
      throw Error(
          fmt::format("{}: at tick {} of run {} more than {} masses are on the structure: "
                      "leave out of --added-mass what was put on with `gyrotwin disturb mass`",
                      file, tick.tick, run_name(run.epoch), model::kMaxAddedMasses));
    }
  }
}

/// @throws Error saying what the log lacks
void require_contents(const std::string& file, const std::vector<Run>& runs,
                      const Circumstances& circumstances) {
  bool sensors = false;
  bool currents = false;
  for (const Run& run : runs) {
    for (const Tick& tick : run.ticks) {
      if (!tick.sensors) continue;
      sensors = true;
      currents |= (tick.sensors->valid & sensors_t::VALID_CURRENTS) != 0;
    }
  }
  if (!sensors) {
    throw Error(file +
                ": has no LIVE/SENSORS of this rig, so nothing to hold the model against; "
                "record it with `gyrotwin log record` while an owner runs that has "
                "[sensors] in its rig file");
  }
  if (circumstances.drive == DriveSource::kCurrent && !currents) {
    throw Error(file + ": SENSORS has no motor currents; leave out --drive current");
  }
}

}  // namespace

std::vector<Stretch> read_runs(const std::filesystem::path& path, const Rig& rig,
                               const model::Machine& machine, const Circumstances& circumstances) {
  if (!rig.sensors) {
    throw Error(rig.file.string() + ": has no [sensors], which say how good what is measured is");
  }
  const std::string file = path.filename().string();
  Log log(path);
  Follower follower(rig, machine, file);
  while (const auto event = log.next()) follower.take(*event);
  require_rig(file, log.catalog(), rig);
  const std::vector<Run> runs = follower.runs();
  require_contents(file, runs, circumstances);
  require_rate(file, runs, rig);
  require_room(file, runs, circumstances);

  std::vector<Stretch> stretches;
  const Cutter cutter(rig, machine, circumstances);
  for (const Run& run : runs) cutter.cut(run, file, stretches);
  if (stretches.empty()) {
    throw Error(
        fmt::format("{}: no {} ticks on end were RUNNING or in a SAFE_STOP whose torque is "
                    "known: arm the rig while it is recorded, and look with `gyrotwin log "
                    "info`",
                    file, kShortestRun));
  }
  return stretches;
}

}  // namespace gyrotwin::calibration
