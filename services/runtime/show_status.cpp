#include "services/runtime/show_status.hpp"

#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

void show_status(Daemon& daemon, const status_t& status) noexcept {
  const std::string_view text = text_view(status.text);
  daemon.show("{}{}{}", mode_name(status.mode), text.empty() ? "" : ": ", text);
}

}  // namespace gyrotwin
