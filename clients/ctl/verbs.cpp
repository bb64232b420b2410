#include "clients/ctl/verbs.hpp"

#include "services/runtime/text.hpp"

namespace gyrotwin {

std::string applied_line(const Verb& verb, const reply_t& reply) {
  std::string line =
      fmt::format("{}{}{}", verb.done, verb.done.empty() ? "" : ": ", get_text(reply.text));
  // A reset begins a new count of ticks.
  if (verb.verb == request_t::RESET) return line;
  return fmt::format("{} from tick {}", line, reply.applied_tick);
}

}  // namespace gyrotwin
