#include "clients/common/event.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

namespace {

/// As the owner rounds it: to whole ticks, at least one.
std::int64_t whole_ticks(std::int64_t duration_ns, std::int64_t tick_ns) {
  return std::max<std::int64_t>(1, (duration_ns + tick_ns / 2) / tick_ns) * tick_ns;
}

bool nothing(const double (&vector)[3]) {
  return std::ranges::all_of(vector, [](double x) { return x == 0.0; });
}

/// From N m s and N s to the constant load that gives them.
void spread(request_t& impulse, const Rig& rig, std::int64_t tick_ns) {
  if (nothing(impulse.force_n) && nothing(impulse.moment_nm)) {
    impulse.moment_nm[0] = rig.reference_impulse_nms;
  }
  if (impulse.duration_ns == 0) impulse.duration_ns = std::llround(1e9 * rig.impulse_duration_s);
  impulse.duration_ns = whole_ticks(impulse.duration_ns, tick_ns);
  const double duration = 1e-9 * static_cast<double>(impulse.duration_ns);
  for (double& moment : impulse.moment_nm) moment /= duration;
  for (double& force : impulse.force_n) force /= duration;
}

}  // namespace

const EventKind* event_kind(std::string_view name) {
  const auto kinds = event_kinds();
  const auto found = std::ranges::find(kinds, name, &EventKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

bool AskedEvent::has(const Quantity& quantity) const {
  // A load of 0 is none.
  return std::ranges::any_of(values, [&](const auto& value) {
    const bool none = quantity.need == Quantity::Need::kChoice &&
                      kind->choice == EventKind::Choice::kAny && value.second == 0.0;
    return value.first == &quantity && !none;
  });
}

std::string option_of(const Quantity& quantity) {
  std::string option = "--" + std::string(quantity.name);
  std::ranges::replace(option, '_', '-');
  return option;
}

std::string key_of(const Quantity& quantity, const Target* target) {
  const bool targets = quantity.unit.symbol == kTargetsUnit.symbol && target != nullptr;
  const std::string_view suffix = targets ? target->unit.suffix : quantity.unit.suffix;
  return std::string(quantity.name) + (suffix.empty() ? "" : "_") + std::string(suffix);
}

request_t request_of(const AskedEvent& event, const Rig& rig, std::int64_t tick_ns) {
  request_t request{};
  request.verb = event.kind->verb;
  request.kind = event.kind->kind;
  request.target = event.target != nullptr ? event.target->number : 0;
  for (const Quantity& quantity : event.kind->quantities) {
    if (quantity.preset) quantity.set(request, *quantity.preset);
  }
  for (const auto& [quantity, value] : event.values) quantity->set(request, value);
  if (event.kind->name == "impulse") spread(request, rig, tick_ns);
  return request;
}

}  // namespace gyrotwin
