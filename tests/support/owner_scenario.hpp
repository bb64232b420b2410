// Random commands and requests for an owner, good ones and bad ones, over the wire's bytes; and
// what an owner's answers have in common. The rules are those of owner_model.hpp.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "services/runtime/datagram.hpp"
#include "services/runtime/owner.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/owner_model.hpp"

namespace gyrotwin::support {

class OwnerScenario {
 public:
  virtual ~OwnerScenario() = default;

  /// @throws std::runtime_error with the seed and the last steps where a promise is broken
  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      step();
      compare();
    }
  }
  /// How often the owner was found in a mode after a step, and commands obeyed.
  const std::array<int, 6>& visits() const { return visits_; }
  int obeyed() const { return obeyed_; }
  int torques() const { return torques_; }

 protected:
  OwnerScenario(std::uint64_t seed, OwnerModel::Pace pace, const Rig& rig, Owner& owner)
      : model(pace, rig.safety.command_timeout_ticks, owner.epoch()),
        rig_(rig),
        owner_(owner),
        seed_(seed),
        random_(seed),
        format_("RIG", rig.id, Key{1, 2, 3}),
        forger_("RIG", rig.id, Key{1, 2, 4}),
        unsigned_("RIG", rig.id, {}) {}

  virtual void step() = 0;
  virtual bool link_cut() const { return false; }
  virtual void fill(status_t& status) const = 0;
  /// A request that is the owner's to decide on: whether it may, must or must not be applied.
  enum class Expected { kApplied, kRefused, kEither };
  virtual Expected expect(const request_t& request, const Surroundings& around) = 0;
  /// It was applied: so does the model.
  virtual void applied(const request_t& request, const Surroundings& around) = 0;
  /// It is left for later.
  virtual void deferred(const request_t&) { broken("an answer is left for later"); }

  int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  bool chance(int one_in) { return pick(one_in) == 0; }

  template <class... Args>
  void note(fmt::format_string<Args...> format, Args&&... args) {
    trail_.push_back(fmt::format("tick {} mode {}: ", owner_.tick(), name_of(owner_.mode())) +
                     fmt::format(format, std::forward<Args>(args)...));
    if (trail_.size() > 20) trail_.pop_front();
  }
  [[noreturn]] void broken(const std::string& promise) const {
    std::string text =
        fmt::format("{}\nseed {}, the last {} steps:", promise, seed_, trail_.size());
    for (const std::string& line : trail_) text += "\n  " + line;
    throw std::runtime_error(text);
  }
  void require(bool holds, const char* promise) const {
    if (!holds) broken(promise);
  }

  /// One command, most often a good one.
  void command() {
    command_t c{};
    c.header.rig_id = rig_.id;
    c.header.epoch = 5;
    c.mode = command_t::TORQUE_NM;
    c.valid_ticks = chance(4) ? 1'000'000 : 1 + pick(12);
    for (double& x : c.value) x = 0.02 * (pick(2001) - 1000);  // beyond the drives' limits, too
    c.for_tick = model.tick;
    c.owner_epoch = model.epoch;
    c.writer = controller_;
    const int kind = pick(36);
    if (kind == 0) c.value[pick(4)] = std::numeric_limits<double>::quiet_NaN();
    if (kind == 1) c.value[pick(4)] = std::numeric_limits<double>::infinity();
    if (kind == 2) c.mode = pick(2) * 3;
    if (kind == 3) c.valid_ticks = -pick(2) * std::numeric_limits<std::int32_t>::max();
    if (kind == 4) c.owner_epoch = epochs_.empty() ? 0 : epochs_[random_() % epochs_.size()];
    if (kind == 5) c.for_tick += 1 + pick(20);
    if (kind == 6) c.for_tick -= 1 + pick(20);
    if (kind == 7) c.for_tick = std::numeric_limits<std::int64_t>::min();
    if (kind == 8) c.for_tick = std::numeric_limits<std::int64_t>::max();
    if (kind == 9) c.valid_ticks = std::numeric_limits<std::int32_t>::max();
    if (kind == 10) c.mode = command_t::VOLTAGE_V;
    if (kind == 11 || kind == 12) c.writer = pick(3);  // 0 among them
    c.counter = ++counters_[c.writer];
    if (kind == 13) c.counter -= pick(5);
    Frame frame = framed(Channel::kCommand, c,
                         kind == 14   ? forger_
                         : kind == 15 ? unsigned_
                                      : format_);
    if (kind == 16) frame[100 + random_() % (command_size() - 100)] ^= std::uint8_t(1 << pick(8));
    if (kind >= kPlayedBack && !recorded_.empty()) frame = recorded_[random_() % recorded_.size()];
    recorded_.push_back(frame);
    if (recorded_.size() > 256) recorded_.pop_front();
    hear_command(frame, kind);
  }
  /// Somebody plays back what was said before.
  void play_back() {
    if (!recorded_.empty()) hear_command(recorded_[random_() % recorded_.size()], kPlayedBack);
  }

  /// The controller is another run from now on.
  void restart_controller() { controller_ = 77 + pick(3); }

  /// One request; `verb` most often.
  void request(std::int32_t verb, const Surroundings& around, request_t r = {}) {
    r.header.rig_id = rig_.id;
    r.header.epoch = 6;
    r.verb = verb;
    r.owner_epoch = model.epoch;
    r.writer = 9 + pick(3);
    r.counter = ++counters_[r.writer];
    const int kind = pick(16);
    if (kind == 0) r.owner_epoch = epochs_.empty() ? 0 : epochs_[random_() % epochs_.size()];
    if (kind == 1) r.counter = --counters_[r.writer];
    if (kind == 2) r.counter -= 1 + pick(3);
    const bool forged = kind == 3;
    Frame frame = framed(Channel::kRequest, r, forged ? forger_ : format_);
    if (kind == 4 && !requests_.empty()) frame = requests_[random_() % requests_.size()];
    if (kind == 5 && !requests_.empty()) frame = requests_.back();
    if (!forged) requests_.push_back(frame);
    if (requests_.size() > 16) requests_.pop_front();
    hear_request(frame, around);
  }

  /// An answer that was left for later.
  void answered_later(const reply_t& reply) {
    check_form(reply);
    remember(reply);
  }

  std::int64_t fresh_epoch() { return static_cast<std::int64_t>(random_() >> 1); }

  OwnerModel model;
  const Rig& rig_;
  std::optional<command_t> heard_;  // the last command that was obeyed
  int torques_ = 0;                 // ticks in which a commanded torque acted

 private:
  static constexpr int kPlayedBack = 32;  // kinds of commands from here on

  std::size_t command_size() const { return 8 + 17 + 1 + spec(Channel::kCommand).size - 8; }

  template <class Message>
  Frame framed(Channel channel, const Message& message, const DatagramFormat& as) const {
    Frame frame{};
    const std::size_t at = as.begin(frame, channel, 0);
    message.encode(frame.data(), static_cast<int>(at), static_cast<int>(frame.size() - at));
    as.sign(frame, at + spec(channel).size);
    return frame;
  }

  /// What the bus would let through.
  template <class Message>
  bool decoded(const Frame& frame, Channel channel, Message& message) const {
    const std::size_t size =
        8 + std::strlen("RIG/") + spec(channel).suffix.size() + 1 + spec(channel).size;
    const Parsed parsed = format_.parse({frame.data(), size});
    if (parsed.verdict != Verdict::kGood || parsed.channel != channel) return false;
    message.decode(parsed.payload.data(), 0, static_cast<int>(parsed.payload.size()));
    return true;
  }

  void hear_command(const Frame& frame, int kind) {
    command_t c;
    if (!decoded(frame, Channel::kCommand, c)) {
      require((kind >= 14 && kind <= 16) || kind >= kPlayedBack,
              "a good command does not come through the wire");
      note("command that the wire stops");
      return;
    }
    require(kind < 14 || kind > 16, "a command that nobody signed comes through the wire");
    note("command of {} counter {} for tick {} valid {} epoch {} mode {} value {}", c.writer,
         c.counter, c.for_tick, c.valid_ticks, c.owner_epoch == model.epoch ? "now" : "other",
         c.mode, c.value[0]);
    const bool expected = model.command(c, link_cut());
    require(owner_.on_command(c) == expected,
            expected ? "a good command is refused" : "a command is obeyed that must not be");
    if (!expected) return;
    heard_ = c;
    ++obeyed_;
  }

  void hear_request(const Frame& frame, const Surroundings& around) {
    request_t r;
    if (!decoded(frame, Channel::kRequest, r)) return note("request that the wire stops");
    note("request {} of {} counter {} epoch {}", verb_name(r.verb), r.writer, r.counter,
         r.owner_epoch == model.epoch ? "now" : "other");
    const auto last = answers_.find(r.writer);
    const bool repeat = last != answers_.end() && last->second.request_counter == r.counter;
    reply_t reply{};
    const bool now = owner_.on_request(r, around, reply);
    if (repeat) {
      require(now && same(reply, last->second), "a repeated request gets another answer");
      return;
    }
    if (!now) {
      require(r.owner_epoch == model.epoch, "a request of another run is taken");
      return deferred(r);
    }
    check_form(reply);
    require(reply.request_writer == r.writer && reply.request_counter == r.counter &&
                reply.verb == r.verb,
            "the answer is to another request");
    const bool is_applied = reply.result == reply_t::APPLIED;
    const bool stale = last != answers_.end() && r.counter < last->second.request_counter;
    if (r.owner_epoch != model.epoch || stale) {
      require(!is_applied, "a request of another run, or one played back, is applied");
      return;
    }
    const Expected expected = expect(r, around);
    require(expected != Expected::kApplied || is_applied, "a request is refused that must be done");
    require(expected != Expected::kRefused || !is_applied,
            "a request is done that must be refused");
    if (is_applied && r.verb == request_t::RESET) epochs_.push_back(model.epoch);
    if (is_applied) applied(r, around);
    remember(reply);
  }

  void check_form(const reply_t& reply) const {
    require(reply.result == reply_t::APPLIED || reply.result == reply_t::REFUSED,
            "an answer is neither yes nor no");
    require(reply.result == reply_t::APPLIED || reply.text[0] != 0, "a refusal says no reason");
  }

  /// The owner repeats its last answer, that is the one with the highest counter.
  void remember(const reply_t& reply) {
    reply_t& last = answers_[reply.request_writer];
    if (last.result == 0 || last.request_counter < reply.request_counter) last = reply;
  }

  static bool same(const reply_t& a, const reply_t& b) { return encoded(a) == encoded(b); }

  /// What is seen of the owner against what must be.
  void compare() {
    require(static_cast<std::int32_t>(owner_.mode()) == model.mode, "the mode is another");
    require(owner_.tick() == model.tick, "the tick is another");
    require(owner_.epoch() == model.epoch, "the epoch is another");
    status_t status{};
    fill(status);
    require(status.mode == model.mode, "STATUS says another mode");
    require(status.refused_not_finite == model.not_finite, "refused_not_finite is another");
    require(status.refused_epoch == model.other_epoch, "refused_epoch is another");
    require(status.refused_expired == model.expired, "refused_expired is another");
    require(status.refused_writer == model.other_writer, "refused_writer is another");
    require(status.refused_counter == model.old_counter, "refused_counter is another");
    ++visits_[static_cast<std::size_t>(model.mode)];
  }

  Owner& owner_;
  std::uint64_t seed_;
  std::int64_t controller_ = 77;  // writer
  std::mt19937_64 random_;
  DatagramFormat format_, forger_, unsigned_;
  std::map<std::int64_t, std::int64_t> counters_;  // by writer, of commands and requests
  std::map<std::int64_t, reply_t> answers_;        // the last to each writer
  std::deque<Frame> recorded_, requests_;
  std::vector<std::int64_t> epochs_;  // over
  std::deque<std::string> trail_;
  std::array<int, 6> visits_{};
  int obeyed_ = 0;
};

}  // namespace gyrotwin::support
