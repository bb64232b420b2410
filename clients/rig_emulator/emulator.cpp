#include "clients/rig_emulator/emulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "services/onboard/noise.hpp"
#include "services/runtime/refuse.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kForever = std::numeric_limits<std::int64_t>::max();

// The firmware's structs and LCM's have the same bytes.
gyrotwin_sensors to_firmware(const sensors_t& sensors) noexcept {
  std::array<std::uint8_t, GYROTWIN_SENSORS_SIZE> bytes;
  sensors.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  gyrotwin_sensors result{};
  gyrotwin_sensors_decode(bytes.data(), bytes.size(), &result);
  return result;
}

request_t from_firmware(const gyrotwin_request& request) noexcept {
  std::array<std::uint8_t, GYROTWIN_REQUEST_SIZE> bytes;
  gyrotwin_request_encode(&request, bytes.data());
  request_t result{};
  result.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return result;
}

model::Input input_of(const gyrotwin_drives& drives) noexcept {
  model::Input input;
  if (drives.mode == GYROTWIN_DRIVES_OFF) return input;
  if (drives.mode == GYROTWIN_DRIVES_VOLTAGE) input.mode = model::DriveMode::kVoltage;
  if (drives.mode == GYROTWIN_DRIVES_BRAKE) input.mode = model::DriveMode::kBrake;
  std::copy(std::begin(drives.value), std::end(drives.value), input.drive.begin());
  return input;
}

Emulator& self_of(void* context) noexcept { return *static_cast<Emulator*>(context); }

}  // namespace

Emulator::Emulator(const Rig& rig, std::int64_t epoch, std::int64_t now_ns)
    : rig_(rig), plant_(rig), to_host_(1), from_host_(2), now_(now_ns), functions_(board()) {
  outgoing_.reserve(kLineBuffer);
  arrived_.reserve(kLineBuffer);
  start(epoch);
}

gyrotwin_board Emulator::board() noexcept {
  gyrotwin_board board{};
  board.context = this;
  board.now_ns = [](void* self) { return self_of(self).device_ns(); };
  board.read_sensors = [](void* self, gyrotwin_sensors* sensors) {
    *sensors = to_firmware(self_of(self).plant_.sensors());
    sensors->estop = self_of(self).estop_ ? 1 : 0;
  };
  board.drive = [](void* self, const gyrotwin_drives* drives) {
    self_of(self).drives_ = input_of(*drives);
  };
  board.drive_speed = [](void* self, int drive) {
    const BenchPlant& plant = self_of(self).plant_;
    const bool there = drive < static_cast<int>(plant.machine().drives.size());
    return there ? plant.machine().drive_rate(drive, plant.state()) : 0.0;
  };
  board.power_rotors = [](void* self, bool on) { self_of(self).plant_.rotors_powered = on; };
  board.rotors_powered = [](void* self) { return self_of(self).plant_.rotors_powered; };
  board.write = [](void* self, const std::uint8_t* bytes, std::size_t size) {
    return self_of(self).write(bytes, size);
  };
  board.request = [](void* self, const gyrotwin_request* request, gyrotwin_reply* reply) {
    self_of(self).answer(*request, *reply);
  };
  return board;
}

void Emulator::start(std::int64_t epoch) noexcept {
  gyrotwin_device_init(&device_, &functions_, rig_.id, epoch);
}

double Emulator::time_s() const noexcept {
  return rig_.loop.tick_s() * static_cast<double>(plant_.tick());
}

void Emulator::cause(const Trouble& trouble) {
  const auto ticks = [this](double seconds) { return std::llround(seconds / rig_.loop.tick_s()); };
  // What is past begins with the next sample.
  const std::int64_t begin =
      std::max(plant_.tick() + 1, static_cast<std::int64_t>(ticks(trouble.at_s)));
  const std::int64_t end =
      trouble.duration_s
          ? begin + std::max<std::int64_t>(1, static_cast<std::int64_t>(ticks(*trouble.duration_s)))
          : kForever;
  troubles_.push_back({trouble, begin, end});
}

/// What is wrong in the present tick.
void Emulator::follow_troubles() noexcept {
  bool silent = false, halves = false, restart = false;
  double flips = 0.0;
  deaf_ = estop_ = false;
  for (const Span& span : troubles_) {
    if (plant_.tick() < span.begin || plant_.tick() >= span.end) continue;
    switch (span.trouble.kind) {
      case Trouble::Kind::kSilent:
        silent = true;
        break;
      case Trouble::Kind::kHalves:
        halves = true;
        break;
      case Trouble::Kind::kFlips:
        flips = std::max(flips, span.trouble.share);
        break;
      case Trouble::Kind::kDeaf:
        deaf_ = true;
        break;
      case Trouble::Kind::kRestart:
        restart = restart || plant_.tick() == span.begin;
        break;
      case Trouble::Kind::kEstop:
        estop_ = true;
        break;
    }
  }
  for (LineDamage* line : {&to_host_, &from_host_}) {
    line->silent = silent;
    line->halves = halves;
    line->flips = flips;
  }
  if (!restart) return;
  ++restarts_;
  zero_ = now_;
  const auto seed = static_cast<std::uint64_t>(device_.epoch);
  start(static_cast<std::int64_t>(detail::mixed(seed + detail::kStep) >> 1));
}

void Emulator::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept {
  now_ = now_ns;
  while (!bytes.empty()) {
    const std::size_t count = std::min(bytes.size(), kLineBuffer);
    arrived_.clear();
    from_host_.pass(bytes.first(count), [this](std::uint8_t byte) { arrived_.push_back(byte); });
    gyrotwin_device_receive(&device_, arrived_.data(), arrived_.size());
    bytes = bytes.subspan(count);
  }
}

/// The operator props it up before the host says HELD; firmware that starts anew under way is HELD
/// with nobody near.
bool Emulator::propped() const noexcept {
  return device_.mode == GYROTWIN_HELD && (device_.was_held || !let_go_);
}

void Emulator::tick(std::int64_t now_ns) noexcept {
  now_ = now_ns;
  let_go_ = let_go_ || device_.mode != GYROTWIN_HELD;
  plant_.advance(propped(), drives_);
  follow_troubles();
  gyrotwin_device_sample(&device_);
}

/// The driver of the line takes what its buffer has room for; what happens on the line itself the
/// firmware does not see.
std::size_t Emulator::write(const std::uint8_t* bytes, std::size_t size) noexcept {
  const std::size_t taken = std::min(size, kLineBuffer - outgoing_.size());
  to_host_.pass({bytes, taken}, [this](std::uint8_t byte) { outgoing_.push_back(byte); });
  return taken;
}

void Emulator::sent(std::size_t count) noexcept {
  outgoing_.erase(outgoing_.begin(), outgoing_.begin() + static_cast<std::ptrdiff_t>(count));
  gyrotwin_device_flush(&device_);
}

void Emulator::answer(const gyrotwin_request& request, gyrotwin_reply& reply) noexcept {
  reply_t answer{};
  act(from_firmware(request), answer);
  reply.result = answer.result;
  reply.id = answer.id;
  reply.applied_tick = answer.applied_tick;
  std::memcpy(reply.text, answer.text, sizeof reply.text);
}

/// The schedule counts the plant's ticks, the line the device's.
void Emulator::act(const request_t& request, reply_t& reply) noexcept {
  reply.applied_tick = plant_.tick();
  if (request.verb == request_t::CANCEL) {
    plant_.schedule().cancel(request.id, reply);
  } else if (request.verb == request_t::CLEAR) {
    reply.result = reply_t::APPLIED;
    set_text(reply.text, "{} disturbances and {} faults ended", plant_.schedule().disturbances(),
             plant_.schedule().faults());
    plant_.schedule().clear();
  } else if (request.verb == request_t::DISTURB && propped() && request.start_tick <= 0) {
    refuse(reply, "HELD: the plant is propped up; arm first, or name a start tick");
  } else {
    request_t scheduled = request;
    if (scheduled.start_tick > 0) scheduled.start_tick -= device_lead();
    plant_.schedule().add(scheduled, plant_.tick(), reply);
  }
  reply.applied_tick += device_lead();
}

}  // namespace gyrotwin
