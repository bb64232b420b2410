#include "clients/rig_emulator/truth_file.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kBuffer = 1u << 20;  // bytes between two writes

std::string header_of(const model::Machine& machine) {
  std::string header = "tick,device_tick,device_ns,t_s,mode";
  for (const std::string& name : machine.layout.names) header += fmt::format(",{}_rad", name);
  for (const std::string& name : machine.layout.names) header += fmt::format(",{}_rad_s", name);
  header += ",tilt_rad";
  for (int j = 0; j < machine.rotors; ++j) header += fmt::format(",rotor_{}_rad_s", j);
  for (std::size_t i = 0; i < machine.drives.size(); ++i) header += fmt::format(",drive_{}_nm", i);
  for (const char axis : {'x', 'y', 'z'}) header += fmt::format(",force_{}_n", axis);
  for (const char axis : {'x', 'y', 'z'}) header += fmt::format(",moment_{}_nm", axis);
  for (int j = 0; machine.track && j < machine.rotors; ++j) {
    header += fmt::format(",contact_lower_{0}_n,contact_upper_{0}_n", j);
  }
  if (machine.load_cell) header += ",load_cell_n";
  return header;
}

}  // namespace

TruthFile::TruthFile(const std::string& name, const model::Machine& machine, std::int64_t every)
    : machine_(machine), every_(every), file_(std::fopen(name.c_str(), "w")) {
  if (!file_) throw Error(fmt::format("--truth {}: {}", name, std::strerror(errno)));
  std::setvbuf(file_.get(), nullptr, _IOFBF, kBuffer);
  row_ = header_of(machine);
  row_.reserve(4096);
  end_row();
}

void TruthFile::write(const Emulator& emulator) {
  const BenchPlant& plant = emulator.plant();
  if (plant.tick() % every_ != 0) return;
  const model::State& state = plant.state();
  const model::Truth& truth = plant.truth();
  put(plant.tick());
  put(plant.tick() + emulator.device_lead());
  put(emulator.device_ns());
  put(emulator.time_s());
  put(emulator.device().mode);
  for (int i = 0; i < machine_.coordinates(); ++i) put(state.q[i]);
  for (int i = 0; i < machine_.coordinates(); ++i) put(state.v[i]);
  put(machine_.tilt(state));
  for (int j = 0; j < machine_.rotors; ++j) put(state.rotor_speed[j]);
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) put(truth.drive_torque[i]);
  for (int i = 0; i < 3; ++i) put(plant.input().force[i]);
  for (int i = 0; i < 3; ++i) put(plant.input().moment[i]);
  for (int j = 0; machine_.track && j < machine_.rotors; ++j) {
    put(truth.contact_lower[j]);
    put(truth.contact_upper[j]);
  }
  if (machine_.load_cell) put(truth.load_cell);
  end_row();
}

template <class Number>
void TruthFile::put(Number value) {
  std::array<char, 32> text;
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  if (!row_.empty()) row_ += ',';
  row_.append(text.data(), result.ptr);
}

void TruthFile::end_row() {
  row_ += '\n';
  sound_ = sound_ && std::fwrite(row_.data(), 1, row_.size(), file_.get()) == row_.size();
  row_.clear();
}

}  // namespace gyrotwin
