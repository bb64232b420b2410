#include <mpi.h>

#include <algorithm>
#include <cstdlib>
#include <thread>
#include <vector>

#include "clients/sweep/crew.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr int kRun = 1, kLine = 2, kEnd = 3;          // tags
constexpr std::chrono::microseconds kLookAgain{200};  // waiting inside MPI would keep a core busy

/// Waits for a message without keeping a processor busy.
/// @return false when there was none within `patience`
bool message_within(std::chrono::microseconds patience, MPI_Status& status) {
  const auto end = std::chrono::steady_clock::now() + patience;
  for (;;) {
    int there = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there != 0) return true;
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(kLookAgain);
  }
}

/// What a rank above 0 does.
void serve(const Work& work) {
  for (;;) {
    MPI_Status status;
    while (!message_within(std::chrono::seconds(1), status)) {
    }
    std::int64_t run = 0;
    MPI_Recv(&run, 1, MPI_INT64_T, 0, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (status.MPI_TAG == kEnd) return;
    const std::string line = work(run);
    MPI_Send(line.data(), static_cast<int>(line.size()), MPI_CHAR, 0, kLine, MPI_COMM_WORLD);
  }
}

class MpiCrew final : public Crew {
 public:
  explicit MpiCrew(int ranks) : given_(static_cast<std::size_t>(ranks)) {}
  ~MpiCrew() override {
    while (pending() > 0) next(std::chrono::seconds(1));  // nobody wants these any more
    const std::int64_t none = 0;
    for (int rank = 1; rank <= size(); ++rank) {
      MPI_Send(&none, 1, MPI_INT64_T, rank, kEnd, MPI_COMM_WORLD);
    }
    MPI_Finalize();
  }

  int size() const override { return static_cast<int>(given_.size()) - 1; }
  int pending() const override {
    std::size_t runs = 0;
    for (const auto& runs_of_rank : given_) runs += runs_of_rank.size();
    return static_cast<int>(runs);
  }

  void give(std::int64_t run) override {
    const auto idlest = std::ranges::min_element(given_.begin() + 1, given_.end(), {},
                                                 [](const auto& runs) { return runs.size(); });
    idlest->push_back(run);
    MPI_Send(&run, 1, MPI_INT64_T, static_cast<int>(idlest - given_.begin()), kRun, MPI_COMM_WORLD);
  }

  std::optional<Finished> next(std::chrono::milliseconds patience) override {
    MPI_Status status;
    if (!message_within(patience, status)) return std::nullopt;
    int size = 0;
    MPI_Get_count(&status, MPI_CHAR, &size);
    std::string line(static_cast<std::size_t>(size), '\0');
    MPI_Recv(line.data(), size, MPI_CHAR, status.MPI_SOURCE, kLine, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    auto& runs = given_[static_cast<std::size_t>(status.MPI_SOURCE)];
    Finished finished{runs.front(), std::move(line)};
    runs.erase(runs.begin());
    return finished;
  }

 private:
  std::vector<std::vector<std::int64_t>> given_;  // by rank, in the order of giving
};

}  // namespace

bool under_mpi() { return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr; }

std::unique_ptr<Crew> mpi_crew(const Work& work) {
  int ranks = 0, rank = 0;
  MPI_Init(nullptr, nullptr);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (ranks < 2) {
    MPI_Finalize();
    throw Error("mpirun: one process gives out the work, so give at least -n 2");
  }
  if (rank == 0) return std::make_unique<MpiCrew>(ranks);
  serve(work);
  MPI_Finalize();
  return nullptr;
}

}  // namespace gyrotwin
