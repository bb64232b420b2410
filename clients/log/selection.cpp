#include "clients/log/selection.hpp"

#include <algorithm>

#include "clients/log/catalog.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

bool Picker::takes(const LogEvent& event) {
  const bool own = is_log_channel(event.channel);
  if (!own && !begin_us_) begin_us_ = event.time_us;
  // As doubles: the times of a damaged log may be far apart.
  seconds_ =
      own ? 0.0 : 1e-6 * (static_cast<double>(event.time_us) - static_cast<double>(*begin_us_));
  if (!names(event.channel)) {
    if (std::ranges::find(seen_, event.channel) == seen_.end()) seen_.emplace_back(event.channel);
    return false;
  }
  const bool meant = own ? !selection_.channels.empty()
                         : seconds_ >= selection_.from_s && seconds_ <= selection_.to_s;
  taken_ += meant ? 1 : 0;
  return meant;
}

void Picker::require_some() const {
  if (taken_ > 0) return;
  std::string there;
  for (const std::string& channel : seen_) there += (there.empty() ? "" : ", ") + channel;
  throw NotDone("the log has no such message" +
                (there.empty() ? std::string() : "; other channels are " + there));
}

bool Picker::names(std::string_view channel) const {
  return selection_.channels.empty() ||
         std::ranges::any_of(selection_.channels, [channel](const std::string& named) {
           return channel == named || channel.ends_with("/" + named);
         });
}

}  // namespace gyrotwin
