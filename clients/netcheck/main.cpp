// gyrotwin-netcheck: whether the network between hosts is good enough for a rig, and what to fix.
#include <sched.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "clients/common/shell_word.hpp"
#include "clients/netcheck/answerer.hpp"
#include "clients/netcheck/host.hpp"
#include "clients/netcheck/measure.hpp"
#include "clients/netcheck/report.hpp"
#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/rig_bus.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin::netcheck {

namespace {

// Below owner, controller and mirror, which it does not hold up; gateway and recorder, of normal
// priority, have to wait for it.
constexpr int kPriority = 77;

// Away from the ports of other rigs, which stand side by side.
constexpr int kPortsAway = 1000;

/// What the command line says.
struct Options {
  bool local = false;
  bool json = false;
  int port = 0;          ///< 0: from the rig's
  double rate_hz = 0.0;  ///< 0: the rig's
  double duration_s = 10.0;
  double patience_s = 1.0;
  int hosts = 0;  ///< that must answer; 0: any
};

int probe_port(const Rig& rig, const Options& options) {
  const int port = rig.network.port;
  if (options.port == port) {
    throw Error(
        fmt::format("--port {} is network.port: a running rig would hear the pings; give "
                    "another one, on all hosts",
                    port));
  }
  if (options.port != 0) return options.port;
  return port + kPortsAway <= 65'535 ? port + kPortsAway : port - kPortsAway;
}

std::string rig_words(const RigOptions& options) {
  std::string words = "--rig " + shell_word(options.name());
  for (const std::string& key : options.overrides()) words += " --set " + shell_word(key);
  return words;
}

BusConfig probe_config(const Rig& rig, int port) {
  BusConfig config = bus_config(rig, header_t::OPERATOR);
  config.port = port;
  return config;
}

/// The other end of a line within this host: a thread, as the other daemon would be one.
class OtherThread {
 public:
  explicit OtherThread(const Rig& rig, const BusConfig& config)
      : socket_(config), id_(random_id()) {
    HostFacts facts = host_facts(socket_, rig, {});
    peer = {id_, address_text(socket_.own_address()), facts};
    thread_ = std::jthread([this, facts](const std::stop_token& stop) {
      take_realtime(kPriority);
      Answerer answerer(id_, facts);
      serve(socket_, answerer, MonotonicClock(), [&stop] { return stop.stop_requested(); });
    });
  }
  Peer peer;

 private:
  ProbeSocket socket_;
  std::int64_t id_;
  std::jthread thread_;  // last: it uses the others
};

CheckedLine judge(const Netcheck& check, const Peer& peer, const Measurement& measured,
                  double rate_hz) {
  CheckedLine line{.peer = peer,
                   .figures = figures(measured, check.here.ttl),
                   .verdict = line_verdict(measured, check.rig.loop.rate_hz,
                                           check.rig.safety.command_timeout_ticks),
                   .rate_hz = rate_hz,
                   .clock_step_ns = measured.clock_step_ns,
                   .came_in_on = get_text(measured.heard.interface)};
  if (measured.there) {
    line.over_rate = measured.there->over_rate;
    line.unauthentic = measured.there->unauthentic;
  }
  return line;
}

/// Measures all lines that there are. @return false when it was stopped
bool measure_lines(Netcheck& check, ProbeSocket& socket, const BusConfig& config, Daemon& daemon,
                   const Options& options) {
  MonotonicClock clock;
  const Line line{socket, clock, [&daemon] { return daemon.stopping(); },
                  std::llround(1e9 * options.patience_s)};
  std::optional<OtherThread> other;
  if (check.alone) other.emplace(check.rig, config);
  check.here = host_facts(socket, check.rig, daemon.ask_realtime(kPriority));
  if (other) {
    other->peer.facts.priority_error = check.here.priority_error;
    other->peer.facts.memory_error = check.here.memory_error;
  }

  const double rate = options.rate_hz > 0.0 ? options.rate_hz : check.rig.loop.rate_hz;
  const auto ticks = std::max<std::int64_t>(1, std::llround(rate * options.duration_s));
  const std::vector<Peer> peers = other ? std::vector{other->peer} : find_peers(line, check.hosts);
  if (daemon.stopping()) return false;
  std::vector<Measurement> measured;
  for (const Peer& peer : peers) {
    if (!options.json) {
      std::fprintf(stderr, "measuring to %s for %g s ...\n", get_text(peer.facts.host).c_str(),
                   options.duration_s);
    }
    measured.push_back(measure(line, peer, rate, ticks));
    if (daemon.stopping()) return false;
  }
  check.counters = socket.counters();

  // What remains is work without a sleep, and nobody waits for it.
  constexpr sched_param kNormal{.sched_priority = 0};
  ::sched_setscheduler(0, SCHED_OTHER, &kNormal);
  for (std::size_t i = 0; i < peers.size(); ++i) {
    check.lines.push_back(judge(check, peers[i], measured[i], rate));
  }
  return true;
}

int check_network(const RigOptions& rig_options, const Options& options) {
  Netcheck check{
      .rig = rig_options.load(), .rig_words = rig_words(rig_options), .alone = options.local};
  if (!options.local) check.hosts = static_cast<std::size_t>(options.hosts);
  check.port = probe_port(check.rig, options);
  const BusConfig config = probe_config(check.rig, check.port);
  Daemon daemon("netcheck");
  std::unique_ptr<ProbeSocket> socket;
  try {
    socket = std::make_unique<ProbeSocket>(config);
  } catch (const Error& error) {
    check.broken = error.what();
  }
  if (socket) {
    check.address = address_text(socket->own_address());
    if (!measure_lines(check, *socket, config, daemon, options)) {
      throw NotDone("stopped before all was measured");
    }
  }
  std::fputs((options.json ? report_json(check) : report_text(check)).c_str(), stdout);
  return check.good() ? kDone : kNotDone;
}

int listen(const RigOptions& rig_options, const Options& options) {
  const Rig rig = rig_options.load();
  const int port = probe_port(rig, options);
  Daemon daemon("netcheck");
  ProbeSocket socket(probe_config(rig, port));
  const Rights rights = daemon.ask_realtime(kPriority);
  Answerer answerer(random_id(), host_facts(socket, rig, rights));
  daemon.log(LogLevel::kInfo, "answers on {} ({}), {}, port {}; Ctrl-C ends it",
             rig.network.interface, address_text(socket.own_address()), rig.network.group, port);

  bool warned = false;
  serve(socket, answerer, MonotonicClock(), [&] {
    if (!warned && socket.counters().unauthentic > 0) {
      warned = true;
      daemon.log(
          LogLevel::kWarning,
          "somebody asks with another key and is not answered: compare `gyrotwin key show-id "
          "{}` on both hosts",
          rig_words(rig_options));
    }
    return daemon.stopping();
  });
  const ProbeCounters& c = socket.counters();
  daemon.log(LogLevel::kInfo,
             "ended; not answered: {} with a wrong signature, {} malformed, {} of another rig, {} "
             "foreign",
             c.unauthentic, c.malformed, c.other_rig, c.foreign);
  return kDone;
}

}  // namespace

}  // namespace gyrotwin::netcheck

int main(int argc, char** argv) {
  gyrotwin::CommandLine app(
      "Whether the network between hosts is good enough for a rig, and what to fix. Pings all "
      "hosts "
      "that run `gyrotwin netcheck listen` on the rig's group and interface, on a port of its own: "
      "a "
      "running rig does not hear it.",
      "gyrotwin-netcheck");
  app.footer(
      "Exit code: 0 good for the rig's own rate, 1 not, 2 asked wrongly.\n"
      "Examples:\n"
      "  gyrotwin netcheck listen --rig ./lab.toml    # on the other hosts\n"
      "  gyrotwin netcheck --rig ./lab.toml           # on this one\n"
      "  gyrotwin netcheck --local                    # this host alone\n"
      "  gyrotwin netcheck --json | jq .lines[0].good_for_hz");
  const gyrotwin::RigOptions rig_options(app);
  gyrotwin::netcheck::Options options;
  app.add_flag("--local", options.local,
               "Between two threads of this host: its interface, rights, wake-ups");
  app.add_flag("--json", options.json, "Everything, as one JSON object");
  app.add_option("--rate", options.rate_hz, "Pings a second [Hz]; default: the rig's loop.rate_hz")
      .type("HZ")
      .check(gyrotwin::number_within(1.0, 10'000.0).untold());
  app.add_option("--duration", options.duration_s, "How long for each host [s]")
      .type("S")
      .shows_default()
      .check(gyrotwin::number_within(0.01, 600.0).untold());
  app.add_option("--hosts", options.hosts,
                 "So many others must answer; the search ends when they have. Default: any")
      .type("N")
      .check(gyrotwin::whole_within(1, 1'000).untold());
  app.add_option("--patience", options.patience_s,
                 "How long to wait for whoever may still answer, at first and at the end [s]")
      .type("S")
      .shows_default()
      .check(gyrotwin::number_within(0.1, 60.0).untold());
  app.add_option("--port", options.port,
                 "UDP port of the pings, the same on all hosts; default: network.port + 1000")
      .type("PORT")
      .check(gyrotwin::whole_within(1, 65'535).untold());
  gyrotwin::Command listen =
      app.add_subcommand("listen", "Answer, on the other hosts, until Ctrl-C");
  listen.alias("answer");
  return app.run(argc, argv, [&] {
    return listen.given() ? gyrotwin::netcheck::listen(rig_options, options)
                          : gyrotwin::netcheck::check_network(rig_options, options);
  });
}
