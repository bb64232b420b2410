// Any bytes go through the reader of logs: none may be read out of bounds, it comes to an end, and
// what it gives and what it counts as lost do not exceed what there was.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <span>

#include "tests/support/small_log.hpp"

namespace gyrotwin {
namespace {

void check(bool invariant) {
  if (!invariant) std::abort();
}

void read_all(std::span<const std::uint8_t> bytes) {
  const ReadAt read = [bytes](std::int64_t offset, std::span<std::uint8_t> to) {
    const auto at = std::min(static_cast<std::size_t>(offset), bytes.size());
    const std::size_t count = std::min(to.size(), bytes.size() - at);
    if (count > 0) std::memcpy(to.data(), bytes.data() + at, count);
    return count;
  };
  Log log({read, static_cast<std::int64_t>(bytes.size())},
          [](const About&) { return std::optional(support::kSampleKey); });
  std::size_t given = 0;
  while (const auto event = log.next()) given += size_in_log(*event);
  const auto lost = static_cast<std::size_t>(log.damage().bytes_lost);
  check(given <= bytes.size() && lost <= bytes.size() - given);
}

/// The bytes as damage to a good log: each is added to one byte of it with exclusive or, from the
/// place on that the first two name, and those beyond its end lengthen it.
void read_damaged(std::span<const std::uint8_t> bytes) {
  static const LogBytes good = support::small_log(true).bytes;
  if (bytes.size() < 2) return;
  const std::size_t at = (bytes[0] * 256u + bytes[1]) % good.size();
  const auto damage = bytes.subspan(2);
  LogBytes log = good;
  if (at + damage.size() > log.size()) log.resize(at + damage.size());
  const auto begin = log.begin() + static_cast<std::ptrdiff_t>(at);
  std::ranges::transform(damage, std::span(begin, damage.size()), begin, std::bit_xor<>());
  read_all(log);
}

}  // namespace
}  // namespace gyrotwin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gyrotwin::read_all({data, size});
  gyrotwin::read_damaged({data, size});
  return 0;
}
