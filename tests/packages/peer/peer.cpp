// A STATE goes through LCM's bytes and comes back.
#include <gyrotwin/channels.hpp>
#include <lcm/lcm-cpp.hpp>
#include <vector>

int main() {
  lcm::LCM bus("memq://");
  gyrotwin::state_t sent{}, heard{};
  sent.tilt_rad[0] = 0.125;
  std::vector<unsigned char> bytes(gyrotwin::kWireSize<gyrotwin::state_t>);
  const int size = static_cast<int>(bytes.size());
  const bool whole = sent.encode(bytes.data(), 0, size) == size && bus.good() &&
                     heard.decode(bytes.data(), 0, size) == size;
  return whole && heard.tilt_rad[0] == 0.125 ? 0 : 1;
}
