// Any bytes go to netcheck's ear: what is called good is within its bounds, and nothing that is
// computed of it overflows; never is it what nobody signed.
#include <algorithm>
#include <functional>

#include "clients/netcheck/answerer.hpp"
#include "clients/netcheck/verdict.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace gyrotwin::netcheck {
namespace {

using fuzz::require;

constexpr std::int64_t kNow = 1'800'000'000'000'000'000;  // wall clock [ns]
constexpr std::int64_t kPeriod = 1'000'000;               // [ns]

/// Both ends, as if every good probe came to both.
class Target {
 public:
  void hear(fuzz::Bytes bytes) {
    require(with_key_.judge(bytes).verdict != Verdict::kGood);
    const ProbeFormat::Judged judged = open_.judge(bytes);
    if (judged.verdict != Verdict::kGood) return;
    Frame frame;
    const std::size_t size = open_.write(frame, judged.probe);
    require(size == bytes.size());
    require(open_.judge({frame.data(), size}).verdict == Verdict::kGood);
    Answerer answerer(target_of(judged.probe), {});
    for (int i = 0; i < 2; ++i) {
      const auto reply = answerer.answer({.probe = judged.probe, .received_ns = kNow}, {}, 0);
      require(!reply || open_.write(frame, *reply) <= bytes.size());
      if (std::holds_alternative<Ping>(judged.probe)) require(reply.has_value() == (i == 0));
    }
    measure(judged.probe);
  }

  /// The bytes as damage to a good probe of the kind that the first of them names: each is added to
  /// one byte of it with exclusive or, and those beyond its end lengthen it.
  void hear_damaged(fuzz::Bytes bytes) {
    if (bytes.empty()) return;
    const Probe kinds[] = {Question{1, Question::kEverybody, 3}, Ping{1, 2, 3},
                           Answer{1, 2, 3, 4, kNow, kNow + kPeriod}, Report{.session = 1}};
    const auto damage = bytes.subspan(1);
    Frame frame{};
    const std::size_t size =
        std::max(open_.write(frame, kinds[bytes[0] % std::size(kinds)]), damage.size());
    if (size > frame.size()) return;
    std::ranges::transform(damage, frame, frame.begin(), std::bit_xor<>());
    hear({frame.data(), size});
  }

 private:
  static std::int64_t target_of(const Probe& probe) {
    const auto* ping = std::get_if<Ping>(&probe);
    return ping != nullptr ? ping->target : 2;
  }

  /// What the asking end makes of it: several of them, so that their sums are tried too.
  static void measure(const Probe& probe) {
    Measurement measured{.period_ns = kPeriod, .ticks = 4};
    for (std::int64_t tick = 0; tick < measured.ticks; ++tick) {
      Trip trip{.tick = tick};
      if (const auto* answer = std::get_if<Answer>(&probe)) {
        complete(trip, kNow, answer->received_ns, answer->sent_ns, kNow + kPeriod);
        require(trip.answered() && trip.response() >= 0);
      }
      measured.trips.push_back(trip);
    }
    if (const auto* report = std::get_if<Report>(&probe)) measured.there = *report;
    const Figures found = figures(measured, 1);
    if (found.out) require(found.out->lost >= 0 && found.back->lost >= 0);
    line_verdict(measured, 1000.0, 10);
  }

  ProbeFormat open_{"RIG", 7, {}};
  ProbeFormat with_key_{"RIG", 7, Key{1, 2, 3}};
};

}  // namespace
}  // namespace gyrotwin::netcheck

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static gyrotwin::netcheck::Target target;
  target.hear({data, size});
  target.hear_damaged({data, size});
  return 0;
}
