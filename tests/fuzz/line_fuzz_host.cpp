// Anything on the line: a real plant's owner keeps its rules whatever its device says. The input is
// a list of pieces, each a length, a kind and so many bytes: as they are, framed as a payload, or
// patched over a sensible sample, beat or reply so that the fuzzer gets past checksum, fingerprint
// and rig; between them the owner is armed, commanded and reset.
#include <array>
#include <cmath>
#include <cstdlib>

#include "services/hardware/hardware.hpp"
#include "services/hardware/line.hpp"
#include "services/hardware/line_clock.hpp"
#include "tests/support/line_frames.hpp"

namespace gyrotwin {
namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

/// Slow, so that few samples tell its rate.
const Rig& rig() {
  static const Rig loaded = load_rig("prototype_b", {"loop.rate_hz=50", "loop.substeps=80"});
  return loaded;
}

/// A platform at rest, a little off upright, as its device measures it.
sensors_t resting() {
  sensors_t sample{};
  sample.header.rig_id = rig().id;
  sample.header.epoch = 99;
  for (const std::int32_t sensor :
       {+sensors_t::VALID_GYRO, +sensors_t::VALID_ACCELEROMETER, +sensors_t::VALID_DISC,
        +sensors_t::VALID_GIMBALS, +sensors_t::VALID_ROTORS, +sensors_t::VALID_ESTOP}) {
    sample.valid |= sensor;
  }
  sample.acceleration_m_s2[1] = 0.1;
  sample.acceleration_m_s2[2] = 9.81;
  return sample;
}

/// The owner as its service drives it, without bus and terminal.
class Bench {
 public:
  Bench() {
    owner_.set_connected(true);
    beat_.header = sample_.header;
    reply_.header = sample_.header;
    reply_.request_writer = kOperator;
    reply_.result = reply_t::APPLIED;
    receive(frame_of(beat_));
    for (int i = 0; i < 40; ++i) receive(next_sample({}));
  }

  void piece(int kind, std::span<const std::uint8_t> bytes) {
    switch (kind) {
      case 0:
        return receive({bytes.begin(), bytes.end()});
      case 1:
        return receive(framed(bytes));
      case 2:
        return receive(next_sample(bytes));
      case 3:
        now_ += 10'000'000;
        beat_.echo_ns = now_ - 1'000'000;
        beat_.heard_ns = now_;
        beat_.sent_ns = now_ + 500'000;
        beat_.mode = static_cast<std::int32_t>(owner_.mode());
        return receive(patched(beat_, bytes));
      case 4:
        reply_.request_counter = asked_;
        return receive(patched(reply_, bytes));
      case 5:
        return ask(request_t::ARM);
      case 6:
        return ask(request_t::DISTURB);
      case 7:
        return ask(request_t::RESET);
      default:
        return command();
    }
  }

  void check() {
    const auto mode = static_cast<int>(owner_.mode());
    require(mode >= status_t::MODE_HELD && mode <= status_t::MODE_FAULT);
    require(owner_.tick() >= 0 && owner_.sim_time_ns() >= 0);
    require(owner_.mode() != Mode::kHeld || owner_.tick() == 0);
    while (const auto out = owner_.take_command()) {
      require(owner_.mode() == Mode::kRunning);
      for (const double value : out->value) require(std::isfinite(value));
      require(std::abs(out->value[0]) <= 1e3);
    }
    while (owner_.take_request()) {
    }
    state_t state{};
    status_t status{};
    link_t link{};
    owner_.fill(state);
    owner_.fill(status);
    owner_.fill(link);
    require(link.samples_missed >= 0);
    clock_.fit(now_);
    owner_.set_clock_drift(1e-6 * clock_.drift_ppm());
    clock_.to_host(sample_.header.sim_time_ns);
  }

 private:
  static constexpr std::int64_t kOperator = 9, kController = 5;

  /// The first byte says where, the others what.
  template <class Message>
  static FrameBytes patched(const Message& message, std::span<const std::uint8_t> patch) {
    FrameBytes payload = encoded(message);
    if (patch.empty()) return framed(payload);
    const std::size_t at = 8 + patch[0] % (payload.size() - 8);
    for (std::size_t i = 1; i < patch.size() && at + i - 1 < payload.size(); ++i) {
      payload[at + i - 1] = patch[i];
    }
    return framed(payload);
  }

  FrameBytes next_sample(std::span<const std::uint8_t> patch) {
    ++sample_.header.tick;
    sample_.header.sim_time_ns += rig().loop.tick_ns();
    now_ += rig().loop.tick_ns();
    return patched(sample_, patch);
  }

  void receive(const FrameBytes& bytes) {
    for (const FrameBytes& payload : unframer_.take(bytes)) {
      const auto heard = [&](auto& message) {
        return payload.size() >= 8 && Line::decode(payload, message) &&
               owner_.plausible(message.header);
      };
      if (sensors_t sample; heard(sample)) {
        owner_.on_sample(sample);
      } else if (beat_t beat; heard(beat)) {
        clock_.on_beat(beat, now_);
        owner_.on_beat(beat);
      } else if (reply_t answer, reply; heard(answer)) {
        owner_.on_reply(answer, reply);
      }
    }
  }

  void ask(std::int32_t verb) {
    request_t request{};
    request.verb = verb;
    request.kind = request_t::LOAD;
    request.owner_epoch = owner_.epoch();
    request.writer = kOperator;
    request.counter = ++asked_;
    reply_t reply{};
    owner_.on_request(request, {.controller_heard = true, .fresh_epoch = owner_.epoch() + 1},
                      reply);
  }

  void command() {
    command_t command{};
    command.mode = command_t::TORQUE_NM;
    command.valid_ticks = 10;
    command.value[0] = 1e6;
    command.for_tick = owner_.tick();
    command.owner_epoch = owner_.epoch();
    command.writer = kController;
    command.counter = ++commanded_;
    owner_.on_command(command);
  }

  Hardware owner_{rig(), 7};
  LineClock clock_;
  Unframer unframer_;
  sensors_t sample_ = resting();
  beat_t beat_{};
  reply_t reply_{};
  std::int64_t now_ = 1'000'000'000, asked_ = 0, commanded_ = 0;
};

}  // namespace
}  // namespace gyrotwin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gyrotwin;  // NOLINT(google-build-using-namespace)
  Bench bench;
  std::span<const std::uint8_t> rest(data, size);
  while (rest.size() >= 2) {
    const std::size_t length = std::min<std::size_t>(rest[0], rest.size() - 2);
    bench.piece(rest[1] % 12, rest.subspan(2, length));
    bench.check();
    rest = rest.subspan(2 + length);
  }
  return 0;
}
