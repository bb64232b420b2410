// Those who do the runs of a sweep: processes of this machine, or of others over MPI.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace gyrotwin {

/// Makes the line of one run.
using Work = std::function<std::string(std::int64_t run)>;

/// A run and its line.
struct Finished {
  std::int64_t run = 0;
  std::string line;
};

/// Workers that take runs and hand back lines, in any order.
class Crew {
 public:
  virtual ~Crew() = default;
  virtual int size() const = 0;
  /// A run for whoever has least to do.
  virtual void give(std::int64_t run) = 0;
  /// Runs that were given and have not come back.
  virtual int pending() const = 0;
  /// A finished run; nothing when there is none within `patience`.
  /// @throws Error when a run ends its worker, and its replacement too
  virtual std::optional<Finished> next(std::chrono::milliseconds patience) = 0;
};

/// Processes of this machine. Call before the program has threads.
/// @throws Error when there can be none
std::unique_ptr<Crew> process_crew(int workers, Work work);

/// Whether this process was started by mpirun.
bool under_mpi();

/// Under mpirun: the crew for rank 0, everybody else being a worker. On the other ranks it does
/// their work and then returns null.
/// @throws Error when there is nobody else
std::unique_ptr<Crew> mpi_crew(const Work& work);

}  // namespace gyrotwin
