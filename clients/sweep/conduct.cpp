#include "clients/sweep/conduct.hpp"

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::chrono::milliseconds kPatience{100};
constexpr int kAhead = 2;  // runs a worker has at hand, so that it never waits for the next one

/// Keeps what the others have under way when something is wrong.
void finish(Crew& crew, Journal& journal) {
  try {
    while (crew.pending() > 0) {
      if (std::optional<Finished> finished = crew.next(kPatience)) {
        journal.take(finished->run, std::move(finished->line));
      }
    }
  } catch (const Error&) {
    // What was wrong first is told.
  }
}

bool all_done(Crew& crew, Journal& journal, std::int64_t runs,
              const std::function<bool(std::int64_t done)>& go_on) {
  std::int64_t next = journal.written();
  std::int64_t done = next;
  bool going = go_on(done);
  while ((going && done < runs) || crew.pending() > 0) {
    while (going && next < runs && crew.pending() < kAhead * crew.size()) crew.give(next++);
    if (std::optional<Finished> finished = crew.next(kPatience)) {
      journal.take(finished->run, std::move(finished->line));
      ++done;
    }
    going = going && go_on(done);
  }
  return done == runs;
}

}  // namespace

bool conduct(Crew& crew, Journal& journal, std::int64_t runs,
             const std::function<bool(std::int64_t done)>& go_on) {
  try {
    return all_done(crew, journal, runs, go_on);
  } catch (const Error&) {
    finish(crew, journal);
    throw;
  }
}

}  // namespace gyrotwin
