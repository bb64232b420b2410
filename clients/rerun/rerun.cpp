#include "clients/rerun/rerun.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>

#include "clients/rerun/booking.hpp"
#include "services/controller/controller.hpp"
#include "services/mirror/mirror.hpp"
#include "services/runtime/bus.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig_reader.hpp"

namespace gyrotwin {

namespace {

/// The channel of the rig's that an event is on.
std::optional<Channel> channel_of(const LogEvent& event, const Rig& rig) {
  const std::string& prefix = rig.network.prefix;
  if (!event.channel.starts_with(prefix + '/')) return {};
  const std::string_view suffix = event.channel.substr(prefix.size() + 1);
  const auto* row = std::ranges::find(kChannels, suffix, &ChannelSpec::suffix);
  if (row == kChannels.end() || row->size != event.data.size()) return {};
  return row->channel;
}

template <class Message>
Message decoded(const LogEvent& event, Channel channel) {
  Message message;
  Bus::decode({channel, false, event.data}, message);
  return message;
}

/// One SENSORS, as the mirror's daemon goes about it.
void feed(Mirror& mirror, const sensors_t& sensors, std::int64_t us, Booking& booking) {
  if (mirror.on_sensors(sensors)) {
    state_t state;
    mirror.fill(state);
    booking.made(Channel::kTwinState, state, state.header.epoch, us);
  }
  if (mirror.health_due()) {
    health_t health;
    mirror.fill(health);
    booking.made(Channel::kHealth, health, health.header.epoch, us);
  }
  if (mirror.look_ahead()) {
    forecast_t forecast;
    mirror.fill(forecast);
    booking.made(Channel::kForecast, forecast, forecast.header.epoch, us);
  }
}

}  // namespace

std::string in_vain(const Account& account) {
  if (account.unknown > 0 && account.compared == 0) return account.why_unknown;
  if (account.made == 0) return "nothing came of it";
  if (account.recorded == 0 || account.compared > 0) return {};
  return fmt::format(
      "none of the {} recorded messages is a counterpart of one of the {} made, so nothing was "
      "compared: run or sequence differ",
      account.recorded, account.made);
}

Rig rig_of(Log& log, const std::string& name, const std::vector<std::string>& overrides) {
  while (log.catalog().rig_file().empty()) {
    if (!log.next()) throw Error(name + ": carries no rig file: it is no record of `gyrotwin log`");
  }
  TomlReader reader(log.catalog().rig_file(), name + ": rig file", overrides);
  Rig rig = read_rig(reader);
  reader.finish();
  rig.file = name;
  return rig;
}

Account rerun_mirror(Log& log, const Rig& rig, const Take& take) {
  Mirror mirror(rig);
  Booking booking(rig, header_t::TWIN, Channel::kTwinState, true, take);
  while (const auto event = log.next()) {
    const std::optional<Channel> channel = channel_of(*event, rig);
    if (!channel) continue;
    const auto heard = [&]<class Message>(Message) {
      booking.heard();
      return decoded<Message>(*event, *channel);
    };
    const auto recorded = [&]<class Message>(Message) {
      const auto message = decoded<Message>(*event, *channel);
      booking.recorded(*channel, message, message.header.epoch);
    };
    switch (*channel) {
      case Channel::kSensors: {
        const auto sensors = decoded<sensors_t>(*event, *channel);
        booking.heard(sensors.header.epoch, sensors.header.tick, 0);
        feed(mirror, sensors, event->time_us, booking);
        break;
      }
      case Channel::kState:
        mirror.on_state(heard(state_t{}));
        break;
      case Channel::kCommand:
        mirror.on_command(heard(command_t{}));
        break;
      case Channel::kIntegratorStatus:
      case Channel::kHardwareStatus:
        mirror.on_owner(heard(status_t{}));
        break;
      case Channel::kMirrorStatus:
        booking.heard(decoded<status_t>(*event, *channel));
        break;
      case Channel::kTwinState:
        recorded(state_t{});
        break;
      case Channel::kHealth:
        recorded(health_t{});
        break;
      case Channel::kForecast:
        recorded(forecast_t{});
        break;
      default:
        break;
    }
  }
  return booking.account();
}

Account rerun_controller(Log& log, const Rig& rig, RerunOn on, const Take& take) {
  constexpr std::int64_t kWriter = 1;
  Controller controller(rig, kWriter);
  Booking booking(rig, header_t::CONTROLLER, Channel::kCommand, controller.law().states() > 0,
                  take);
  const Channel answered = on == RerunOn::kTwin ? Channel::kTwinState : Channel::kState;
  while (const auto event = log.next()) {
    const std::optional<Channel> channel = channel_of(*event, rig);
    if (!channel) continue;
    if (*channel == answered) {
      const auto state = decoded<state_t>(*event, *channel);
      command_t command{};
      if (!controller.answer(state, command)) {
        booking.heard();
        continue;
      }
      booking.heard(state.header.epoch, state.header.tick, 1);
      command.header = state.header;
      booking.made(Channel::kCommand, command, command.owner_epoch, event->time_us);
    } else if (is_owner_status(*channel)) {
      booking.heard();
      controller.on_owner(decoded<status_t>(*event, *channel));
    } else if (*channel == Channel::kCommand) {
      const auto command = decoded<command_t>(*event, *channel);
      booking.recorded(*channel, command, command.owner_epoch);
    }
  }
  return booking.account();
}

}  // namespace gyrotwin
