#include "clients/rerun/rerun.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>

#include "clients/rerun/comparison.hpp"
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

template <class Message>
Comparison::Payload encoded(const Message& message) {
  Comparison::Payload payload(kWireSize<Message>);
  message.encode(payload.data(), 0, static_cast<int>(payload.size()));
  return payload;
}

// What differs from run to run: messages/README.md.
void blank(header_t& header) {
  header.sender_mono_ns = 0;
  header.source = header_t::TWIN;
}
Comparison::Payload comparable(state_t state) {
  blank(state.header);
  std::ranges::fill(state.mac, 0);
  return encoded(state);
}
Comparison::Payload comparable(health_t health) {
  blank(health.header);
  health.step_p50_ns = health.step_max_ns = 0;
  std::ranges::fill(health.mac, 0);
  return encoded(health);
}
Comparison::Payload comparable(forecast_t forecast) {
  blank(forecast.header);
  std::ranges::fill(forecast.mac, 0);
  return encoded(forecast);
}
Comparison::Payload comparable(command_t command) {
  blank(command.header);
  command.header.epoch = command.writer = command.counter = 0;
  std::ranges::fill(command.mac, 0);
  return encoded(command);
}

/// Hands on what is made, and keeps account.
class Booking {
 public:
  Booking(const Rig& rig, std::int32_t source, const Take& take)
      : rig_(rig), source_(source), take_(take) {}

  template <class Message>
  void made(Channel channel, Message& message, std::int64_t epoch, std::int64_t us) {
    message.header.rig_id = rig_.id;
    message.header.source = source_;
    message.header.sender_mono_ns = 0;
    ++account_.made;
    if (take_) take_(channel, encoded(message), us);
    if (is_repeat(message)) return;
    comparison_.made(channel, epoch, message.header.sequence, comparable(message));
  }
  template <class Message>
  void recorded(Channel channel, const Message& message, std::int64_t epoch) {
    if (is_repeat(message)) return;
    ++account_.recorded;
    comparison_.recorded(channel, epoch, message.header.sequence, comparable(message));
  }
  void heard() { ++account_.heard; }
  void unremembered() { ++account_.unremembered; }

  Account account() const {
    Account account = account_;
    account.compared = comparison_.compared();
    account.different = comparison_.different();
    account.first_difference = comparison_.first_difference();
    return account;
  }

 private:
  /// Told while the rig is HELD, as often as it pleased: nobody can say which belong together.
  template <class Message>
  static bool is_repeat(const Message& message) {
    return message.header.sequence == 0;
  }

  const Rig& rig_;
  std::int32_t source_;
  const Take& take_;
  Account account_;
  Comparison comparison_;
};

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
  if (account.unremembered > 0 && account.compared == 0) {
    return "the record begins in mid-run, and what the law remembered then is not in it: record "
           "from before the rig is armed";
  }
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
  Booking booking(rig, header_t::TWIN, take);
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
      case Channel::kSensors:
        feed(mirror, heard(sensors_t{}), event->time_us, booking);
        break;
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
  Booking booking(rig, header_t::CONTROLLER, take);
  const Channel answered = on == RerunOn::kTwin ? Channel::kTwinState : Channel::kState;
  const bool remembers = controller.law().states() > 0;
  std::optional<std::int64_t> begun, unknown;  // epochs of runs: heard from their start, or not
  while (const auto event = log.next()) {
    const std::optional<Channel> channel = channel_of(*event, rig);
    if (!channel) continue;
    if (*channel == answered) {
      booking.heard();
      const auto state = decoded<state_t>(*event, *channel);
      command_t command{};
      if (!controller.answer(state, command)) continue;
      command.header = state.header;
      const std::int64_t epoch = state.header.epoch;
      if (begun != epoch && unknown != epoch) (state.header.tick <= 1 ? begun : unknown) = epoch;
      if (remembers && unknown == epoch) {
        booking.unremembered();
        continue;
      }
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
