// Anything on the line: a device keeps its rules whatever it hears. The input is a list of pieces,
// each a length and so many bytes: as they are, framed as a payload, or patched over a sensible
// beat or command so that the fuzzer gets past checksum and fingerprint.
#include <array>
#include <cmath>
#include <cstdlib>

#include "tests/support/fake_board.hpp"

namespace gyrotwin {
namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

void check(DeviceBench& bench, bool was_running) {
  const gyrotwin_device& device = bench.device;
  require(device.mode == GYROTWIN_HELD || device.mode == GYROTWIN_RUNNING ||
          device.mode == GYROTWIN_SAFE_STOP);
  require(device.mode != GYROTWIN_RUNNING || was_running || device.was_held);
  for (const double value : bench.board.drives.value) require(std::isfinite(value));
  if (device.mode == GYROTWIN_HELD) require(bench.board.drives.mode == GYROTWIN_DRIVES_OFF);
  require(device.outbox.count <= GYROTWIN_OUTBOX_FRAMES);
  bench.board.payloads();
  require(bench.board.unframer.bad() == 0);
}

template <class Message>
FrameBytes patched(const Message& message, std::span<const std::uint8_t> patch) {
  FrameBytes payload = encoded(message);
  if (patch.empty()) return framed(payload);
  const std::size_t at = 8 + patch[0] % (payload.size() - 8);
  for (std::size_t i = 1; i < patch.size() && at + i - 1 < payload.size(); ++i) {
    payload[at + i - 1] = patch[i];
  }
  return framed(payload);
}

FrameBytes piece(DeviceBench& bench, int kind, std::span<const std::uint8_t> bytes) {
  switch (kind) {
    case 0:
      return {bytes.begin(), bytes.end()};
    case 1:
      return framed(bytes);
    case 2:
      bench.beat.mode = status_t::MODE_HELD;
      return patched(bench.beat, bytes);
    case 3:
      bench.beat.mode = status_t::MODE_RUNNING;
      return patched(bench.beat, bytes);
    default:
      return patched(bench.command, bytes);
  }
}

}  // namespace
}  // namespace gyrotwin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gyrotwin;  // NOLINT(google-build-using-namespace)
  DeviceBench bench;
  std::span<const std::uint8_t> rest(data, size);
  while (rest.size() >= 2) {
    const std::size_t length = std::min<std::size_t>(rest[0], rest.size() - 2);
    const int kind = rest[1] % 8;
    const bool was_running = bench.device.mode == GYROTWIN_RUNNING;
    bench.receive(piece(bench, kind, rest.subspan(2, length)));
    check(bench, was_running);
    if (rest[1] & 8u) bench.sample(rest[1] / 16);
    check(bench, was_running);
    rest = rest.subspan(2 + length);
  }
  return 0;
}
