#include "services/runtime/owner_watch.hpp"

#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kPatience = 500'000'000;  // [ns]

}  // namespace

void OwnerWatch::hear(const status_t& status, std::int64_t now) noexcept {
  const bool other_run = status.header.epoch != last_.header.epoch;
  const status_t& before = other_run ? other_ : last_;
  const bool known = status.header.epoch == before.header.epoch && status.mode == before.mode;
  if (said_lost_ || !known) {
    daemon_.log(LogLevel::kInfo, "owner {} on {}: {} {}", status.pid, text_view(status.host),
                mode_name(status.mode), text_view(status.text));
  }
  said_lost_ = false;
  if (other_run) other_ = last_;
  last_ = status;
  heard_ = now;
}

bool OwnerWatch::lost(std::int64_t now, status_t& own) noexcept {
  if (heard_ >= 0 && now - heard_ <= kPatience) return false;
  const std::string_view known = owner_program(last_.service);
  set_text(own.text, "no owner is heard: start gyrotwin-{} with the same rig file",
           known.empty() ? "integrator or gyrotwin-hardware" : known);
  if (!said_lost_) daemon_.log(LogLevel::kWarning, "the owner is silent");
  said_lost_ = true;
  return true;
}

}  // namespace gyrotwin
