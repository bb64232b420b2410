#include "clients/experiment/conduct.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <variant>

#include "services/integrator/plant.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kLook = 100'000'000;      // between looks at go_on [ns]
constexpr std::int64_t kSilent = 2'000'000'000;  // without a tick [ns]
constexpr double kImmovable = 1e6;               // inertia of a pinned structure, at least [kg m^2]
constexpr double kAtRest = 0.01;                 // share of the nominal speed
constexpr int kMostSubsteps = 1000;              // of a rig file
constexpr double kLongestSpinDown = 1800.0;      // [s]

bool is_named(const ExperimentPlan& plan, std::string_view name) { return plan.kind->name == name; }

request_t of_verb(std::int32_t verb, std::int32_t kind = 0) {
  request_t request{};
  request.verb = verb;
  request.kind = kind;
  return request;
}

/// Asks for the drives to be off when it goes, unless that was done.
class Guard {
 public:
  explicit Guard(Asker& asker) : asker_(asker) {}
  ~Guard() {
    if (!armed_) return;
    try {
      asker_.ask(of_verb(request_t::DISARM));  // refused where it has stopped by itself
      std::puts("disarmed");
    } catch (const std::exception& error) {
      std::fprintf(stderr, "NOT DISARMED: %s; press the E-stop\n", error.what());
    }
  }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  void arm() {
    armed_ = true;  // an answer that is lost may have been yes
    const reply_t reply = ask_or_throw(asker_, of_verb(request_t::ARM), "arm");
    std::printf("armed: %s\n", get_text(reply.text).c_str());
    std::fflush(stdout);
  }
  void disarm() {
    ask_or_throw(asker_, of_verb(request_t::DISARM), "disarm");
    armed_ = false;
  }

 private:
  Asker& asker_;
  bool armed_ = false;
};

/// Listens to STATE until `done`.
/// @throws NotDone when the owner falls silent, or may not go on
template <class Done>
void follow(Asker& asker, const std::function<bool()>& go_on, Done&& done) {
  std::int64_t heard_ns = asker.now_ns();
  for (bool over = false; !over;) {
    asker.listen(kLook, [&](const Reception& reception) {
      if (reception.channel != Channel::kState) return false;
      state_t state;
      Bus::decode(reception, state);
      heard_ns = asker.now_ns();
      over = done(state);
      return over;
    });
    if (!go_on()) throw NotDone("stopped");
    if (asker.now_ns() - heard_ns > kSilent) throw NotDone("no STATE is heard any more");
  }
}

/// Lets so much of the owner's time go by.
void let_pass(Asker& asker, const Rig& rig, double seconds, const std::function<bool()>& go_on) {
  std::int64_t end = -1;
  std::int64_t tick = -1;
  std::int64_t moved_ns = asker.now_ns();
  follow(asker, go_on, [&](const state_t& state) {
    if (state.header.tick != tick) moved_ns = asker.now_ns();
    if (asker.now_ns() - moved_ns > kSilent) throw NotDone("time stands still");
    tick = state.header.tick;
    if (end < 0) end = tick + std::llround(seconds / rig.loop.tick_s());
    if (state.mode == status_t::MODE_FALLEN || state.mode == status_t::MODE_FAULT) {
      throw NotDone(fmt::format("{} after {:.3g} s: what was recorded until then can be used",
                                state.mode == status_t::MODE_FAULT ? "FAULT" : "FALLEN",
                                rig.loop.tick_s() * static_cast<double>(tick)));
    }
    return tick >= end;
  });
}

/// Waits in HELD until the rotors stand.
void stop_rotors(Asker& asker, const Rig& rig, const std::function<bool()>& go_on) {
  if (!rig.rotor_drive) return;
  const reply_t reply =
      ask_or_throw(asker, of_verb(request_t::ROTORS, request_t::SPIN_DOWN), "rotors spin-down");
  std::printf("rotors: %s\n", get_text(reply.text).c_str());
  std::fflush(stdout);
  const model::Machine machine = rig.build_machine();
  const std::int64_t begin = asker.now_ns();
  follow(asker, go_on, [&](const state_t& state) {
    if (1e-9 * static_cast<double>(asker.now_ns() - begin) > kLongestSpinDown) {
      throw NotDone("the rotors do not come to rest");
    }
    bool at_rest = (state.valid & state_t::VALID_ROTORS) != 0;  // unknown is not at rest
    for (int j = 0; j < machine.rotors; ++j) {
      const double nominal = machine.nominal_rotor_speed[static_cast<std::size_t>(j)];
      at_rest &= std::abs(state.rotor_speed_rad_s[j]) <= kAtRest * std::abs(nominal);
    }
    return at_rest;
  });
}

request_t counterweight(const ExperimentPlan& plan) {
  request_t request = of_verb(request_t::DISTURB, request_t::ADDED_MASS);
  request.mass_kg = plan.mass_kg;
  request.position_m[2] = plan.mass_height_m;
  request.start_tick = 1;
  return request;
}

/// Whether the rig file has what a simulated rig needs for it.
bool is_arranged(const ExperimentKind& kind, const Rig& rig) {
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    const auto& s = umbrella->structure;
    return (!kind.structure_pinned || std::min(s.inertia_x, s.inertia_y) > kImmovable) &&
           (!kind.disc_pinned || umbrella->disc.inertia_polar > kImmovable) &&
           (!kind.axles_lifted || umbrella->track == model::TrackKind::kNone);
  }
  if (const auto* gimballed = std::get_if<model::GimballedParameters>(&rig.machine)) {
    return !kind.structure_pinned || gimballed->structure.inertia_tilt > kImmovable;
  }
  const auto& gyro = std::get<model::GyroscopeParameters>(rig.machine).gyro;
  return !kind.disc_pinned || gyro.post_inertia > kImmovable;
}

/// Toppling stiffness without counterweight [N m/rad].
double toppling(const Rig& rig) {
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    return model::reduce(*umbrella).U;
  }
  if (const auto* gimballed = std::get_if<model::GimballedParameters>(&rig.machine)) {
    return model::reduce(*gimballed).U;
  }
  return 0.0;
}

std::string with_overrides(const std::vector<std::string>& overrides) {
  std::string text;
  for (const std::string& key : overrides) text += " --set " + key;
  return text;
}

/// What the integrator's step check asks for besides, of a rig with these overrides; or nothing.
std::vector<std::string> finer_steps(const Rig& rig, const std::vector<std::string>& overrides) {
  Rig arranged = load_rig(rig.file.string(), overrides);
  const model::Machine machine = arranged.build_machine();
  const int filed = arranged.loop.substeps;
  while (stepping_error(arranged, machine) > arranged.loop.step_tolerance) {
    arranged.loop.substeps *= 2;
    if (arranged.loop.substeps > kMostSubsteps) return {};  // the integrator says why
  }
  if (arranged.loop.substeps == filed) return {};
  return {fmt::format("loop.substeps={}", arranged.loop.substeps)};
}

}  // namespace

std::string misfit(const ExperimentPlan& plan, const Rig& rig, bool simulated,
                   const std::vector<std::string>& given) {
  if (!rig.sensors) return "the rig file has no [sensors]: nothing would be measured";
  if (rig.safety.drive == SafeStopDrive::kHoldSpeed) {
    return "safety.safe_stop is hold_speed, whose torque no log tells: start owner, controller and "
           "this with --set safety.safe_stop=zero_torque";
  }
  const bool is_disc = std::holds_alternative<model::UmbrellaParameters>(rig.machine);
  if (is_named(plan, "coast-down") && rig.safety.drive != SafeStopDrive::kZeroTorque && is_disc) {
    return "the disc must coast: start owner, controller and this with --set "
           "safety.safe_stop=zero_torque";
  }
  if (is_named(plan, "run-down") && !rig.rotor_drive) {
    return "the rig file has no [rotor_drive]: its rotors keep their speed";
  }
  if (simulated) {
    std::vector<std::string> missing;
    if (!is_arranged(*plan.kind, rig)) missing = arrangement(*plan.kind, rig);
    if (plan.kind->rotors_at_rest && rig.rotor_drive && rig.initial_rotor_share > 0.0) {
      missing.emplace_back("rotor_drive.start_share=0");
    }
    if (!missing.empty()) {
      std::vector<std::string> all = given;
      std::ranges::copy(missing, std::back_inserter(all));
      std::ranges::copy(finer_steps(rig, all), std::back_inserter(missing));
      return "a simulated rig has no hands to arrange it: start owner, controller and this with" +
             with_overrides(missing);
    }
  }
  if (!is_named(plan, "swing")) return {};
  if (rig.machine.index() == 2) return "this rig stands on a post and cannot swing";
  const double restoring = -model::kGravity * plan.mass_kg * plan.mass_height_m - toppling(rig);
  if (restoring <= 0.0) {
    return fmt::format(
        "it would not swing but fall: by the rig file the counterweight must give "
        "more than {:.3g} N m/rad, these {:g} kg at {:g} m give {:.3g}; see "
        "--mass and --height",
        toppling(rig), plan.mass_kg, plan.mass_height_m,
        -model::kGravity * plan.mass_kg * plan.mass_height_m);
  }
  return {};
}

std::string by_hand(const ExperimentPlan& plan, bool simulated) {
  if (simulated) return {};
  std::string work;
  const auto add = [&work](const std::string& what) { work += (work.empty() ? "" : "; ") + what; };
  if (plan.kind->structure_pinned) add("pin the structure upright, so that it does not give way");
  if (plan.kind->disc_pinned) add("pin the disc to it");
  if (plan.kind->axles_lifted) add("lift the axles off their ring, if there is one, and tie them");
  if (is_named(plan, "swing")) {
    add(
        fmt::format("bolt {:g} kg to the structure, centre of mass {:g} m below the pivot; lean it "
                    "by about {:.0f} deg and let go once it is armed",
                    plan.mass_kg, -plan.mass_height_m, plan.tilt_rad * 180.0 / std::numbers::pi));
  }
  return work;
}

std::optional<request_t> start_of(const ExperimentPlan& plan) {
  const bool swings = is_named(plan, "swing");
  if (!swings && !plan.kind->disc_pinned) return std::nullopt;
  request_t request = of_verb(request_t::RESET);
  request.initial_given = 1;  // upright and at rest
  if (swings) request.initial_q[0] = plan.tilt_rad;
  return request;
}

void conduct(const ExperimentPlan& plan, const Rig& rig, Asker& asker,
             const std::function<bool()>& go_on) {
  Guard guard(asker);
  const bool simulated = asker.owner().service == status_t::INTEGRATOR;
  if (simulated) {
    ask_or_throw(asker, start_of(plan).value_or(of_verb(request_t::RESET)), "reset");
  }
  if (plan.kind->rotors_at_rest) stop_rotors(asker, rig, go_on);
  if (simulated && is_named(plan, "swing")) {
    ask_or_throw(asker, counterweight(plan), "counterweight");
  }
  guard.arm();
  if (is_named(plan, "run-down")) {
    ask_or_throw(asker, of_verb(request_t::ROTORS, request_t::SPIN_DOWN), "rotors spin-down");
  }
  if (is_named(plan, "coast-down")) let_pass(asker, rig, plan.driven_s, go_on);
  if (!is_named(plan, "free-run")) guard.disarm();
  let_pass(asker, rig, plan.watched_s, go_on);
}

}  // namespace gyrotwin
