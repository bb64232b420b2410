// Saying no to an operator: why, and what to do about it.
#pragma once

#include <utility>

#include "messages/channels.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

/// Makes `reply` a refusal. @return false
template <class... Args>
bool refuse(reply_t& reply, fmt::format_string<Args...> why, Args&&... args) noexcept {
  reply.result = reply_t::REFUSED;
  set_text(reply.text, why, std::forward<Args>(args)...);
  return false;
}

}  // namespace gyrotwin
