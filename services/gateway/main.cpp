#include <cstdio>
#include <cstdlib>

#include "services/gateway/service.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/key.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

namespace {

/// What the command line says besides the rig.
struct Words {
  std::string listen;
  std::vector<std::string> origins;
  bool any_program = false;
  bool urls = false;
  std::string page, recordings;
};

/// One port a rig, so that several share a host.
Endpoint endpoint_of(const Words& words, const Rig& rig) {
  if (!words.listen.empty()) return parse_endpoint(words.listen);
  return {.address = "127.0.0.1", .port = static_cast<std::uint16_t>(8764 + rig.id)};
}

/// Of a rig that is not signed: the gateway's alone, in a service's own folder or beside the keys.
/// The gateway makes it; who only asks for its addresses does not.
Key own_key(const Rig& rig, bool make) {
  std::filesystem::path path = key_path(rig.name).replace_extension(".gateway");
  if (const char* state = std::getenv("STATE_DIRECTORY")) path = state / path.filename();
  if (std::filesystem::exists(path)) return load_key(path);
  if (!make) {
    throw Error("no gateway of rig " + rig.name + " has run here: " + path.string() +
                " is missing. That of a service: sudo STATE_DIRECTORY=/var/lib/gyrotwin/" +
                rig.name + " gyrotwin gateway --urls --rig " + rig.name);
  }
  create_key(path);
  return load_key(path);
}

std::filesystem::path default_recordings() {
  if (const char* data = std::getenv("XDG_DATA_HOME"))
    return std::filesystem::path(data) / "gyrotwin";
  if (const char* home = std::getenv("HOME")) {
    return std::filesystem::path(home) / ".local/share/gyrotwin";
  }
  return "recordings";
}

int run(const RigOptions& rig_options, const Words& words) {
  const Rig rig = rig_options.load();
  const BusConfig config = bus_config(rig, header_t::OPERATOR);
  GatewayOptions options{
      .endpoint = endpoint_of(words, rig),
      .origins = words.origins,
      .any_program = words.any_program,
      .page = words.page.empty() ? page_folder() : std::filesystem::path(words.page),
      .recordings =
          words.recordings.empty() ? default_recordings() : std::filesystem::path(words.recordings),
      .rig_arguments = {"--rig", rig_options.name()},
      .rig_text = print_rig(rig_options.name(), rig_options.overrides())};
  for (const std::string& word : rig_options.overrides()) {
    options.rig_arguments.insert(options.rig_arguments.end(), {"--set", word});
  }
  const Tokens tokens = make_tokens(config.key ? *config.key : own_key(rig, !words.urls));
  if (words.urls) {
    std::printf("operator  %s\nobserver  %s\n", url(options.endpoint, tokens.operator_).c_str(),
                url(options.endpoint, tokens.observer).c_str());
    return kDone;
  }
  Daemon daemon("gyrotwin-gateway");
  MonotonicClock clock;
  Bus bus(config);
  run_gateway(rig, options, tokens, bus, clock, daemon);
  daemon.log(LogLevel::kInfo, "stopped");
  return kDone;
}

}  // namespace

}  // namespace gyrotwin

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Shows a rig in a browser, and speaks with Foxglove, Lichtblick, PlotJuggler and Prometheus. "
      "Who has the operator's address can push it.",
      "gyrotwin-gateway");
  const gyrotwin::RigOptions options(app);
  gyrotwin::Words words;
  app.add_option(
         "--listen", words.listen,
         "Where; default 127.0.0.1 and 8764 + rig.id. 0.0.0.0 is for other hosts, which need "
         "a token")
      .type("ADDRESS:PORT");
  app.add_flag("--urls", words.urls, "Only print the addresses of operators and observers");
  app.add_option("--allow-origin", words.origins,
                 "A foreign page that may connect, e.g. https://app.foxglove.dev")
      .type("ORIGIN");
  app.add_flag("--allow-programs", words.any_program,
               "Programs on other hosts may connect too, with a token");
  app.add_option("--recordings", words.recordings,
                 "Folder of the recordings made from the page; default ~/.local/share/gyrotwin")
      .type("FOLDER");
  app.add_option("--page", words.page, "Folder of the built page").type("FOLDER");
  return app.run(argc, argv, [&] { return gyrotwin::run(options, words); });
}
