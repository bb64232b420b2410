#include "clients/gyrotwin/verbs.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

template <std::size_t N>
std::string list(const std::array<Program, N>& programs) {
  std::string text;
  for (const Program& p : programs) text += fmt::format("  {:<14}{}\n", p.name, p.summary);
  return text;
}

}  // namespace

std::string front_page() {
  return "gyrotwin: a gyroscopic platform, its physics and its controller, over the network.\n"
         "\n"
         "usage: gyrotwin VERB [OPTIONS]      `gyrotwin VERB --help` tells more\n"
         "\n"
         "Daemons, each in a shell of its own; Ctrl-C stops them:\n" +
         list(kDaemons) +
         "\n"
         "Clients:\n" +
         list(kClients) +
         "\n"
         "All take --rig NAME|FILE; without it $GYROTWIN_RIG, or else prototype_b.\n"
         "\n"
         "Example:\n"
         "  gyrotwin key new\n"
         "  gyrotwin integrator &\n"
         "  gyrotwin controller &\n"
         "  gyrotwin ctl wait ready && gyrotwin ctl arm && gyrotwin ctl wait balanced\n"
         "  gyrotwin disturb impulse\n";
}

std::string unknown_verb(std::string_view verb) {
  std::array<std::string_view, kDaemons.size() + kClients.size()> names;
  const auto clients = std::ranges::transform(kDaemons, names.begin(), &Program::name).out;
  std::ranges::transform(kClients, clients, &Program::name);
  return fmt::format(
      "there is no verb `{}` (no program gyrotwin-{}); `gyrotwin --help` lists "
      "the verbs{}",
      verb, verb, did_you_mean(nearest(verb, names)));
}

}  // namespace gyrotwin
