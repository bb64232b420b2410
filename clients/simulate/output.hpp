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
  /// @param name `-` for the standard output
  /// @param extra more columns: drives, tilt, contact forces, holding moment, energies
  /// @throws Error when it cannot be written, with the reason
  CsvFile(const std::string& name, const model::Machine& machine, bool extra);

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
  void put_extra(const Sample& sample);
  void end_row();

  const model::Machine& machine_;
  bool extra_;
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
