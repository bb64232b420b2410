// What really happens on an emulated rig, as CSV.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "clients/rig_emulator/emulator.hpp"

namespace gyrotwin {

class TruthFile {
 public:
  /// Writes the header line.
  /// @param every a row each so many ticks
  /// @throws Error where the file cannot be written
  TruthFile(const std::string& name, const model::Machine& machine, std::int64_t every);

  /// The present tick, where it has a row.
  void write(const Emulator& emulator);
  /// Everything so far has been written.
  bool sound() const noexcept { return sound_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  template <class Number>
  void put(Number value);
  void end_row();

  const model::Machine& machine_;
  std::int64_t every_;
  std::unique_ptr<std::FILE, Close> file_;
  std::string row_;
  bool sound_ = true;
};

}  // namespace gyrotwin
