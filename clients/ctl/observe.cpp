#include "clients/ctl/observe.hpp"

#include "clients/common/tilt.hpp"
#include "services/runtime/rig_bus.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kSightingNs = 1'000'000'000;  // ten STATUS messages

/// "FALLEN: tilt beyond ..."
std::string mode_text(const status_t& status) {
  const std::string why = get_text(status.text);
  return fmt::format("{}{}{}", mode_name(status.mode), why.empty() ? "" : ": ", why);
}

bool needs_reset(std::int32_t mode) {
  return mode == status_t::MODE_SAFE_STOP || mode == status_t::MODE_FALLEN ||
         mode == status_t::MODE_FAULT;
}

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

}  // namespace

Sighting sight(const Rig& rig, Asker& asker) {
  Sighting seen{.rig = rig.name,
                .reach = reach(rig),
                .owner = {},
                .controller = {},
                .command = {},
                .state = {},
                .nominal_rotor_speed = {},
                .mirror = {},
                .link = {}};
  const model::Machine machine = rig.build_machine();
  seen.nominal_rotor_speed.assign(machine.nominal_rotor_speed.begin(),
                                  machine.nominal_rotor_speed.begin() + machine.rotors);
  bool twin = false;  // whose mirror is to be heard as well
  asker.listen(kSightingNs, [&seen, &twin](const Reception& reception) {
    twin |= reception.channel == Channel::kTwinState;
    if (is_owner_status(reception.channel)) {
      Bus::decode(reception, seen.owner.emplace());
    } else if (reception.channel == Channel::kControllerStatus) {
      Bus::decode(reception, seen.controller.emplace());
    } else if (reception.channel == Channel::kMirrorStatus) {
      Bus::decode(reception, seen.mirror.emplace());
    } else if (reception.channel == Channel::kLink) {
      Bus::decode(reception, seen.link.emplace());
    } else if (reception.channel == Channel::kCommand) {
      Bus::decode(reception, seen.command.emplace());
    } else if (reception.channel == Channel::kState) {
      Bus::decode(reception, seen.state.emplace());
    }
    const bool lease_known = seen.owner && (seen.owner->command_writer == 0 || seen.command);
    const bool line_known = seen.link || (seen.owner && seen.owner->service != status_t::HARDWARE);
    return lease_known && line_known && seen.controller && seen.state && (seen.mirror || !twin);
  });
  seen.reach += asker.suspicion();
  return seen;
}

void wait_for_mode(Asker& asker, Mode mode, std::int64_t limit_ns) {
  const std::int64_t end = asker.now_ns() + limit_ns;
  status_t status = asker.owner(limit_ns);
  const auto there = [&] { return status.mode == static_cast<std::int32_t>(mode); };
  const bool came = there() || asker.listen(end - asker.now_ns(), [&](const Reception& reception) {
    if (!is_owner_status(reception.channel)) return false;
    Bus::decode(reception, status);
    return there();
  });
  if (!came) {
    throw NotDone(fmt::format("not {} within {:g} s: the owner is {}", name_of(mode),
                              seconds(limit_ns), mode_text(status)));
  }
}

void wait_until_ready(Asker& asker, std::int64_t limit_ns) {
  const std::int64_t end = asker.now_ns() + limit_ns;
  status_t status = asker.owner(limit_ns);
  bool controller = false;
  const bool ready = asker.listen(end - asker.now_ns(), [&](const Reception& reception) {
    // As the owner sees it: a peer without STATUS is known by its commands.
    controller |=
        reception.channel == Channel::kControllerStatus || reception.channel == Channel::kCommand;
    if (is_owner_status(reception.channel)) Bus::decode(reception, status);
    // HELD, its text says what is in the way of arming.
    return controller && status.mode == status_t::MODE_HELD && status.text[0] == 0;
  });
  if (ready) return;
  throw NotDone(fmt::format("not ready within {:g} s: the owner is {}, {}", seconds(limit_ns),
                            mode_text(status),
                            controller ? "the controller is there"
                                       : "no controller is heard: start `gyrotwin controller`"));
}

void wait_for_balance(Asker& asker, BalanceWatch watch, std::int64_t limit_ns) {
  const std::int64_t end = asker.now_ns() + limit_ns;
  status_t status = asker.owner(limit_ns);
  bool balanced = false;
  asker.listen(end - asker.now_ns(), [&](const Reception& reception) {
    if (reception.channel == Channel::kState) {
      state_t state;
      Bus::decode(reception, state);
      balanced = watch.on(state);
    } else if (is_owner_status(reception.channel)) {
      Bus::decode(reception, status);
    }
    return balanced || needs_reset(status.mode);
  });
  if (balanced) return;
  if (needs_reset(status.mode)) {
    throw NotDone(fmt::format("does not balance: the owner is {}; `gyrotwin ctl reset`, then arm",
                              mode_text(status)));
  }
  throw NotDone(fmt::format(
      "not balanced within {:g} s: the owner is {}{}", seconds(limit_ns), mode_text(status),
      watch.tilt() < 0.0 ? ", no STATE with a tilt was heard"
                         : fmt::format(", the tilt {:.3f} deg", degrees(watch.tilt()))));
}

}  // namespace gyrotwin
