// What every row begins with and ends with: a rig that balances on three hosts, and judgement.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <random>
#include <string>

#include "tests/faults/judge.hpp"
#include "tests/faults/row.hpp"
#include "tests/support/hosts.hpp"

namespace gyrotwin::faults {

using support::Heard;
using support::Hosts;
using support::Process;
using support::Words;

/// One row. The hosts and their daemons live on from row to row; whatever a row has broken is
/// mended the way an operator would, and that it can be is a part of the row.
class Faults : public testing::Test {
 protected:
  /// How it balances again.
  static constexpr const char* kNothing = "nothing: it has not stopped";
  static constexpr const char* kResetAndArm = "`reset`, `arm`";
  static constexpr const char* kStartResetAndArm = "starting it again; `reset`, `arm`";
  static constexpr const char* kLost =
      "no valid command in time; start the controller, then reset and arm";

  /// What a row runs on; rows with the same share their daemons.
  struct Setup {
    std::string rig;
    Words overrides;
    bool hardware = false;  ///< an emulated rig on a line and its daemon, in wall time
    bool operator==(const Setup&) const = default;
  };
  explicit Faults(Setup setup) : setup_(std::move(setup)) {}

  void SetUp() override;
  /// Ends the fault, brings the rig back, judges the row and adds it to the table.
  void TearDown() override;

  Hosts& hosts() { return *hosts_; }
  /// Row of the table, but for what is judged and measured.
  void row(std::string fault, std::string does, std::string told, std::string back);

  /// It balances on for so many ticks.
  void keeps_balancing(std::int64_t ticks = 150);
  /// Waits for the safe stop and for an owner's STATUS that tells `why` to the operator.
  void stops_safely(const std::string& why = kLost);
  /// Between half of `most` and all of it, in ticks of the owner: the seeded "some time".
  void some_ticks_pass(std::int64_t most = 60);
  /// The owner's last STATUS as heard beside it.
  status_t owner_status();
  /// The operator's client is answered as expected, and prints these words.
  void asks(const Words& words, int code, const std::string& says = "");

  /// The fault ended, it balances again, as an operator would have it.
  void bring_back();

  std::string told_;  ///< what the operator was told last

 private:
  void judge();

  static std::unique_ptr<Hosts> hosts_;
  static Setup hosts_setup_;
  Setup setup_;
  Row row_;
  std::mt19937_64 random_{Hosts::kSeed};
};

/// 250 Hz at a quarter of wall time: a tick has 16 ms, so that a pause of a busy machine is none of
/// the rig's. It starts almost upright, to balance at once.
class Simulated : public Faults {
 protected:
  explicit Simulated(const std::string& patience_s)
      : Faults({"double_brennan",
                {"loop.rate_hz=250", "loop.substeps=16", "initial.q=[0.003,0.0,0.0,0.0]",
                 "loop.patience_s=" + patience_s}}) {}
};

/// Before a safe stop for want of commands time stands still until 1 s after the last one. (The
/// default 0.1 s is less than ten of these ticks.)
class Patient : public Simulated {
 protected:
  Patient() : Simulated("1.0") {}
};

/// As hardware: no patience at all.
class Strict : public Simulated {
 protected:
  Strict() : Simulated("0.0") {}
};

/// A rig on a serial line. Its time is wall time: with 10 ms a tick the timeout is 100 ms.
class Hardware : public Faults {
 protected:
  Hardware() : Faults({"prototype_b", {"loop.rate_hz=100", "loop.substeps=40"}, true}) {}
};

}  // namespace gyrotwin::faults
