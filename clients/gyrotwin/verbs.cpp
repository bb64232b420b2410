#include "clients/gyrotwin/verbs.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "services/runtime/cli.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

constexpr std::string_view kExample =
    "  gyrotwin key new\n"
    "  gyrotwin integrator &\n"
    "  gyrotwin controller &\n"
    "  gyrotwin ctl wait ready && gyrotwin ctl arm && gyrotwin ctl wait balanced\n"
    "  gyrotwin disturb impulse\n";

template <std::size_t N>
std::string list(const std::array<Program, N>& programs) {
  std::string text;
  for (const Program& p : programs) text += fmt::format("  {:<14}{}\n", p.name, p.summary);
  return text;
}

/// The verbs as subcommands: to be described, not to be parsed.
struct Front : CommandLine {
  Front()
      : CommandLine(
            "A gyroscopic platform, its physics and its controller, over the network. Runs the "
            "program gyrotwin-COMMAND; `gyrotwin COMMAND --help` and `man gyrotwin-COMMAND` tell "
            "more of one.",
            "gyrotwin") {
    footer("Example:\n" + std::string(kExample));
    for (const Program& p : kDaemons) add_subcommand(p.name, p.summary);
    for (const Program& p : kClients) add_subcommand(p.name, p.summary);
  }
};

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
         "Example:\n" +
         std::string(kExample);
}

std::string front_manual() { return Front().manual(); }

std::string front_words() { return Front().completion_words(); }

std::string unknown_verb(std::string_view verb) {
  if (verb.starts_with('-')) {
    return fmt::format("`{}` comes before the verb; options follow it: `gyrotwin VERB {} ...`",
                       verb, verb);
  }
  std::array<std::string_view, kDaemons.size() + kClients.size()> names;
  const auto clients = std::ranges::transform(kDaemons, names.begin(), &Program::name).out;
  std::ranges::transform(kClients, clients, &Program::name);
  return fmt::format(
      "there is no verb `{}` (no program gyrotwin-{}); `gyrotwin --help` lists "
      "the verbs{}",
      verb, verb, did_you_mean(nearest(verb, names)));
}

}  // namespace gyrotwin
