#include "clients/disturb/play.hpp"

#include <cmath>
#include <cstdio>

#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr double kLead = 0.2;  // of wall time, for the asking [s]

void cancel(Asker& asker, std::int64_t id) {
  request_t request{};
  request.verb = request_t::CANCEL;
  request.id = id;
  // What is over by itself meanwhile needs no cancelling: any answer will do.
  asker.ask(request);
}

}  // namespace

std::int64_t first_tick(const status_t& owner) {
  if (owner.mode == status_t::MODE_HELD) return 0;
  // The sensors of the present tick have spoken.
  if (owner.mode == status_t::MODE_PAUSED) return owner.header.tick + 1;
  const double lead = 1e9 * kLead * owner.speed_factor / static_cast<double>(owner.tick_period_ns);
  return owner.header.tick + static_cast<std::int64_t>(std::ceil(lead));
}

void play(Asker& asker, const Rig& rig, const std::vector<PlannedEvent>& scenario) {
  const status_t owner = asker.owner();
  if (owner.tick_period_ns <= 0) throw NotDone("the owner's STATUS names no tick period");
  const std::int64_t first = first_tick(owner);
  std::printf("0 s is tick %lld\n", static_cast<long long>(first));

  std::vector<std::int64_t> ids;
  for (const PlannedEvent& planned : scenario) {
    const reply_t reply = asker.ask(request_of(planned, rig, owner.tick_period_ns, first));
    if (reply.result != reply_t::APPLIED) {
      for (const std::int64_t id : ids) cancel(asker, id);
      throw NotDone(fmt::format("{}: {} refused: {}{}", planned.place, planned.event.kind->name,
                                get_text(reply.text),
                                ids.empty() ? "" : "; the events before it are cancelled"));
    }
    ids.push_back(reply.id);
    std::printf("%s: %s\n", get_text(reply.text).c_str(),
                std::string(planned.event.kind->name).c_str());
    std::fflush(stdout);
  }
}

}  // namespace gyrotwin
