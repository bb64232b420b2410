// Where the samples go, and what a person at a terminal sees meanwhile.
#pragma once

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "clients/simulate/simulation.hpp"
#include "services/model/machine.hpp"

namespace gyrotwin {

/// Samples as CSV: `t_s`, the coordinates, their rates, 17 digits each, so that every bit is told.
/// Complete rows only, whenever it is cut off.
class CsvFile {
 public:
  /// More columns: drives, rotors, tilt, contact and load cell forces, holding moment, energies;
  /// the coordinates and rates that STATE says where it is an estimate.
  enum class Extra : std::uint8_t { kNone, kTruth, kWithEstimate };

  /// @param name `-` for the standard output
  /// @throws Error when it cannot be written, with the reason
  CsvFile(const std::string& name, const model::Machine& machine, Extra extra);

  void write(const Sample& sample);
  /// Everything so far has been taken.
  bool sound() const { return sound_; }
  bool on_terminal() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const {
      if (file != stdout) std::fclose(file);
    }
  };
  void put(double value);
  void put_state(const model::State& state);
  void put_extra(const Sample& sample);
  void end_row();

  const model::Machine& machine_;
  Extra extra_;
  std::unique_ptr<std::FILE, Close> file_;
  std::string row_;
  bool sound_ = true;
};

/// How far a simulation is, on one line of the terminal; nothing where stderr is none.
class Progress {
 public:
  /// @param visible whether to show it at all
  Progress(double duration, bool visible);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(double t);

 private:
  using Clock = std::chrono::steady_clock;
  double duration_;
  bool visible_;
  Clock::time_point start_, next_;
  bool shown_ = false;
};

}  // namespace gyrotwin
