#include "services/runtime/probe.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <tuple>
#include <type_traits>
#include <utility>

#include "messages/big_endian.hpp"

namespace gyrotwin::netcheck {
namespace {

// "NETCHEK1": what stands where LCM has a type's fingerprint; another layout gets another one.
constexpr std::int64_t kLayout = 0x4e45544348454b31;

/// Channel and size of a kind of probe, in the order of the variant.
struct Kind {
  std::string_view suffix;
  std::size_t size;  ///< of the payload [bytes]
};
constexpr std::array<Kind, std::variant_size_v<Probe>> kKinds{{
    {"NETCHECK/QUESTION", kWireSize<state_t>},
    {"NETCHECK/PING", kWireSize<state_t>},
    {"NETCHECK/ANSWER", kWireSize<command_t>},
    {"NETCHECK/REPORT", kWireSize<state_t>},
}};

auto fields(Question& q) { return std::tie(q.session, q.target, q.serial); }
auto fields(Ping& p) { return std::tie(p.session, p.target, p.sequence); }
auto fields(Answer& a) {
  return std::tie(a.session, a.answerer, a.sequence, a.number, a.received_ns, a.sent_ns);
}
auto fields(HostFacts& f) {
  return std::tie(f.host, f.interface, f.mtu, f.ttl, f.buffer_wanted, f.buffer_granted,
                  f.priority_error, f.memory_error, f.clock_synchronised, f.clock_max_error_ns,
                  f.saves_power, f.wireless);
}
auto fields(Heard& h) {
  return std::tie(h.distinct, h.repeats, h.late, h.ttl_min, h.ttl_max, h.kernel_dropped,
                  h.interface);
}
auto fields(Report& r) {
  return std::tuple_cat(
      std::tie(r.session, r.answerer, r.serial, r.answered, r.over_rate, r.unauthentic),
      fields(r.facts), fields(r.heard));
}

template <class Fields>
constexpr std::size_t bytes_of() {
  return []<class... F>(std::type_identity<std::tuple<F&...>>) {
    return (sizeof(F) + ... + 0);
  }(std::type_identity<Fields>{});
}

/// Puts numbers, big endian, and texts one after the other.
class Writer {
 public:
  explicit Writer(std::uint8_t* at) : at_(at) {}
  void operator()(std::int64_t value) noexcept {
    put_big_endian(static_cast<std::uint64_t>(value), at_);
    at_ += sizeof value;
  }
  template <std::size_t N>
  void operator()(const std::uint8_t (&text)[N]) noexcept {
    at_ = std::copy_n(text, N, at_);
  }
  void zero_until(const std::uint8_t* end) noexcept {
    while (at_ < end) *at_++ = 0;
  }

 private:
  std::uint8_t* at_;
};

class Reader {
 public:
  explicit Reader(const std::uint8_t* at) : at_(at) {}
  void operator()(std::int64_t& value) noexcept {
    value = static_cast<std::int64_t>(big_endian<std::uint64_t>({at_, sizeof value}, 0));
    at_ += sizeof value;
  }
  template <std::size_t N>
  void operator()(std::uint8_t (&text)[N]) noexcept {
    std::copy_n(at_, N, text);
    text[N - 1] = 0;
    at_ += N;
  }

 private:
  const std::uint8_t* at_;
};

template <class Message, class Visitor>
void visit_fields(Message& message, Visitor& visitor) noexcept {
  std::apply([&](auto&... field) { (visitor(field), ...); }, fields(message));
}

/// A default-made probe of the n-th kind.
template <std::size_t I = 0>
Probe make(std::size_t kind) noexcept {
  if constexpr (I + 1 < std::variant_size_v<Probe>) {
    if (kind != I) return make<I + 1>(kind);
  }
  return Probe(std::in_place_index<I>);
}

bool is_count(std::int64_t number) noexcept { return 0 <= number && number <= kProbeMost; }
bool is_stamp(std::int64_t ns) noexcept { return 0 <= ns && ns < kProbeLatest; }

/// Whether all numbers that it visits are within +-kProbeMost.
struct Bounded {
  bool all = true;
  void operator()(std::int64_t number) noexcept {
    all = all && -kProbeMost <= number && number <= kProbeMost;
  }
  template <std::size_t N>
  void operator()(const std::uint8_t (&)[N]) noexcept {}
};

// Session, target and answerer are names, of any bits.
bool plausible(Question& q) noexcept { return is_count(q.serial); }
bool plausible(Ping& p) noexcept { return is_count(p.sequence); }
bool plausible(Answer& a) noexcept {
  return is_count(a.sequence) && is_count(a.number) && is_stamp(a.received_ns) &&
         is_stamp(a.sent_ns);
}
bool plausible(Report& r) noexcept {
  Bounded numbers;
  visit_fields(r.facts, numbers);
  visit_fields(r.heard, numbers);
  return numbers.all && is_count(r.serial) && is_count(r.answered) && is_count(r.over_rate) &&
         is_count(r.unauthentic);
}

}  // namespace

ProbeFormat::ProbeFormat(const std::string& prefix, std::int32_t rig_id,
                         const std::optional<Key>& key)
    : prefix_(prefix + "/"), rig_id_(rig_id), key_(key), envelope_(prefix, rig_id, key) {}

ProbeFormat::Judged ProbeFormat::judge(std::span<const std::uint8_t> datagram) const noexcept {
  const Parsed parsed = envelope_.parse(datagram);
  if (parsed.verdict == Verdict::kMalformed) return {Verdict::kMalformed};
  if (!parsed.name.starts_with(prefix_)) return {Verdict::kForeign};
  const auto kind = std::ranges::find(kKinds, parsed.name.substr(prefix_.size()), &Kind::suffix);
  if (kind == kKinds.end()) return {Verdict::kForeign};
  if (parsed.payload.size() != kind->size) return {Verdict::kMalformed};

  Reader reader(parsed.payload.data());
  std::int64_t layout = 0, rig_id = 0;
  reader(layout);
  reader(rig_id);
  if (layout != kLayout) return {Verdict::kMalformed};
  if (rig_id != rig_id_) return {Verdict::kOtherRig};
  if (key_ && !signed_with(*key_, parsed.name, parsed.payload)) return {Verdict::kUnauthentic};

  Judged judged{Verdict::kGood, make(static_cast<std::size_t>(kind - kKinds.begin()))};
  const bool sane = std::visit(
      [&](auto& message) {
        visit_fields(message, reader);
        return plausible(message);
      },
      judged.probe);
  if (!sane) return {Verdict::kMalformed};
  return judged;
}

std::size_t ProbeFormat::write(Frame& frame, const Probe& probe) const noexcept {
  const Kind& kind = kKinds[probe.index()];
  std::array<char, kMaxChannelName> name;
  const auto end = std::ranges::copy(kind.suffix, std::ranges::copy(prefix_, name.begin()).out).out;
  const std::size_t head =
      DatagramFormat::begin(frame, {name.data(), static_cast<std::size_t>(end - name.begin())}, 0);
  const std::size_t size = head + kind.size;

  Writer writer(frame.data() + head);
  writer(kLayout);
  writer(std::int64_t{rig_id_});
  std::visit(
      [&](auto message) {
        static_assert(16 + bytes_of<decltype(fields(message))>() + kMacSize <=
                      (std::is_same_v<decltype(message), Answer> ? kWireSize<command_t>
                                                                 : kWireSize<state_t>));
        visit_fields(message, writer);
      },
      probe);
  writer.zero_until(frame.data() + size - kMacSize);
  envelope_.sign(frame, size);
  return size;
}

}  // namespace gyrotwin::netcheck
