#include "clients/simulate/output.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "clients/simulate/inputs.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr int kDigits = 16;  // after the first one: 17 in all tell every double apart

std::string extra_header(const model::Machine& machine, bool estimate) {
  std::string header;
  for (const model::Drive& drive : machine.drives) {
    header += "," + machine.layout.names[static_cast<std::size_t>(drive.coordinate)] + "_drive_nm";
  }
  for (int j = 0; j < machine.rotors; ++j) header += ",rotor_" + std::to_string(j) + "_rad_s";
  header += ",tilt_rad";
  if (machine.track) {
    for (int j = 0; j < machine.rotors; ++j) {
      header += ",contact_lower_" + std::to_string(j) + "_n";
    }
    for (int j = 0; machine.track->clearance && j < machine.rotors; ++j) {
      header += ",contact_upper_" + std::to_string(j) + "_n";
    }
  }
  if (machine.unheld) header += ",holding_x_nm,holding_y_nm";
  if (machine.load_cell) header += ",load_cell_n";
  header += ",kinetic_j,potential_j";
  for (const std::string& column : state_columns(machine)) {
    if (estimate) header += "," + column + "_estimate";
  }
  return header;
}

}  // namespace

CsvFile::CsvFile(const std::string& name, const model::Machine& machine, Extra extra)
    : machine_(machine),
      extra_(extra),
      file_(name == "-" ? stdout : std::fopen(name.c_str(), "w")) {
  if (!file_) throw Error("--output " + name + ": cannot be written: " + std::strerror(errno));
  row_ = "t_s";
  for (const std::string& column : state_columns(machine)) row_ += "," + column;
  if (extra != Extra::kNone) row_ += extra_header(machine, extra == Extra::kWithEstimate);
  end_row();
}

bool CsvFile::on_terminal() const { return ::isatty(::fileno(file_.get())) != 0; }

void CsvFile::write(const Sample& sample) {
  put(sample.t);
  put_state(sample.state);
  if (extra_ != Extra::kNone) put_extra(sample);
  end_row();
}

void CsvFile::put_state(const model::State& state) {
  for (int i = 0; i < machine_.coordinates(); ++i) put(state.q[i]);
  for (int i = 0; i < machine_.coordinates(); ++i) put(state.v[i]);
}

void CsvFile::put_extra(const Sample& sample) {
  const model::Truth truth = machine_.truth(sample.state, sample.input);
  const auto put_some = [this](const auto& values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) put(values[i]);
  };
  const auto rotors = static_cast<std::size_t>(machine_.rotors);
  put_some(truth.drive_torque, machine_.drives.size());
  put_some(sample.state.rotor_speed, rotors);
  put(machine_.tilt(sample.state));
  if (machine_.track) {
    put_some(truth.contact_lower, rotors);
    if (machine_.track->clearance) put_some(truth.contact_upper, rotors);
  }
  if (machine_.unheld) put_some(truth.holding_moment, 2);
  if (machine_.load_cell) put(truth.load_cell);
  put(truth.kinetic_energy);
  put(truth.potential_energy);
  if (extra_ == Extra::kWithEstimate) put_state(machine_.recall(*sample.estimate));
}

void CsvFile::put(double value) {
  std::array<char, 32> text;
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value,
                                    std::chars_format::scientific, kDigits);
  if (!row_.empty()) row_ += ',';
  row_.append(text.data(), result.ptr);
}

/// One write for one row.
void CsvFile::end_row() {
  row_ += '\n';
  sound_ = sound_ && std::fwrite(row_.data(), 1, row_.size(), file_.get()) == row_.size() &&
           std::fflush(file_.get()) == 0;
  row_.clear();
}

Progress::Progress(double duration, bool visible)
    : duration_(duration),
      visible_(visible && ::isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      next_(start_ + std::chrono::milliseconds(300)) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(double t) {
  if (!visible_) return;
  const Clock::time_point now = Clock::now();
  if (now < next_ || t <= 0.0) return;
  next_ = now + std::chrono::milliseconds(200);
  shown_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double speed = t / elapsed;
  std::fprintf(stderr, "\r\033[K%3.0f %% of %.6g s, %.3g x real time, %.0f s left",
               100.0 * t / duration_, duration_, speed, (duration_ - t) / speed);
}

}  // namespace gyrotwin
