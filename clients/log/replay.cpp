#include "clients/log/replay.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdio>

#include "clients/log/log.hpp"
#include "services/runtime/bus.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"
#include "services/runtime/rig_bus.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kOwnerPatience = 1'000'000'000;  // ten STATUS messages [ns]

/// Sends when it is time, and only where nobody owns the rig.
class Player {
 public:
  explicit Player(const Rig& rig) : rig_(rig), bus_(bus_config(rig, header_t::REPLAY)) {
    listen_until(clock_.now_ns() + kOwnerPatience);
  }

  /// @param due_ns since the first message that is played
  void play(const LogEvent& event, double due_ns) {
    if (!begin_ns_) begin_ns_ = clock_.now_ns();
    listen_until(*begin_ns_ + std::llround(due_ns));
    if (!bus_.send_again(event.channel, event.data)) {
      throw NotDone(
          fmt::format("the message on {} with {} bytes, number {} of the replay, cannot be sent",
                      event.channel, event.data.size(), sent_ + 1));
    }
    ++sent_;
  }

  std::int64_t sent() const { return sent_; }

 private:
  /// At least once round, however late it is.
  void listen_until(std::int64_t deadline_ns) {
    do {
      while (const auto heard = bus_.receive()) refuse_owner(*heard);
    } while (clock_.now_ns() < deadline_ns && (bus_.wait(deadline_ns - clock_.now_ns()), true));
  }

  void refuse_owner(const Reception& heard) const {
    const std::string fix =
        "; stop it first, or replay with a copy of the rig file that has its own network.group and "
        "network.port";
    if (is_owner_status(heard.channel)) {
      status_t status;
      Bus::decode(heard, status);
      throw NotDone(fmt::format("rig {} has an owner (process {} on {}), and who listens could not "
                                "tell it from the replay",
                                rig_.name, status.pid, get_text(status.host)) +
                    fix);
    }
    if (heard.channel == Channel::kState) {
      throw NotDone(
          fmt::format("somebody sends STATE of rig {}: an owner, or another replay", rig_.name) +
          fix);
    }
  }

  const Rig& rig_;
  MonotonicClock clock_;
  Bus bus_;
  std::optional<std::int64_t> begin_ns_;
  std::int64_t sent_ = 0;
};

void check_rig(const Log& log, const std::filesystem::path& path, const Rig& rig) {
  const auto& about = log.catalog().about();
  if (!about || (about->prefix == rig.network.prefix && about->rig_id == rig.id)) return;
  throw Error(fmt::format(
      "{} is a record of rig {} (prefix {}, id {}), not of {} (prefix {}, id {}): give --rig {}",
      path.string(), about->rig, about->prefix, about->rig_id, rig.name, rig.network.prefix, rig.id,
      about->rig));
}

}  // namespace

int replay(const Rig& rig, const std::filesystem::path& path, const Selection& selection,
           double speed) {
  Log log(path);
  Picker picker(selection);
  std::optional<Player> player;
  double first_s = 0.0;
  while (const auto event = log.next()) {
    if (!picker.takes(*event) || is_log_channel(event->channel)) continue;
    if (!player) {
      check_rig(log, path, rig);
      player.emplace(rig);
      first_s = picker.seconds();
    }
    player->play(*event, 1e9 * (picker.seconds() - first_s) / speed);
  }
  picker.require_some();
  std::printf("replayed %lld messages of %s on %s\n",
              static_cast<long long>(player ? player->sent() : 0), path.c_str(),
              reach(rig).c_str());
  if (log.damage().any()) {
    std::fprintf(stderr, "%s is damaged: %s\n", path.c_str(), log.damage_text().c_str());
  }
  return kDone;
}

}  // namespace gyrotwin
