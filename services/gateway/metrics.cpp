#include "services/gateway/metrics.hpp"

#include <spdlog/fmt/fmt.h>

#include <string_view>

#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

/// One number of a STATUS.
struct Series {
  std::string_view name, type, help;
  double (*value)(const status_t& status);
};

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }
double sum(const std::int64_t (&slots)[kChannelSlots]) {
  double all = 0.0;
  for (const std::int64_t slot : slots) all += static_cast<double>(slot);
  return all;
}
double number(std::int64_t count) { return static_cast<double>(count); }

constexpr Series kDaemon[] = {
    {"mode", "gauge",
     "Mode: 0 held, 1 running, 2 paused, 3 safe stop, 4 fallen, 5 fault, 16 waiting, 17 active",
     [](const status_t& s) { return static_cast<double>(s.mode); }},
    {"rig_time_seconds", "gauge", "The owner's time since it was armed",
     [](const status_t& s) { return seconds(s.header.sim_time_ns); }},
    {"speed_factor", "gauge", "Simulated over wall time",
     [](const status_t& s) { return s.speed_factor; }},
    {"overruns_total", "counter", "Ticks that began more than one period late",
     [](const status_t& s) { return number(s.overruns); }},
    {"skipped_ticks_total", "counter", "Periods given up after overruns",
     [](const status_t& s) { return number(s.skipped_ticks); }},
    {"lateness_p50_seconds", "gauge", "Wake-up after the deadline, median of the last second",
     [](const status_t& s) { return seconds(s.lateness_p50_ns); }},
    {"lateness_p99_seconds", "gauge", "Wake-up after the deadline, 99th percentile",
     [](const status_t& s) { return seconds(s.lateness_p99_ns); }},
    {"lateness_max_seconds", "gauge", "Wake-up after the deadline, largest",
     [](const status_t& s) { return seconds(s.lateness_max_ns); }},
    {"compute_p50_seconds", "gauge", "Work in one tick, median of the last second",
     [](const status_t& s) { return seconds(s.compute_p50_ns); }},
    {"compute_p99_seconds", "gauge", "Work in one tick, 99th percentile",
     [](const status_t& s) { return seconds(s.compute_p99_ns); }},
    {"compute_max_seconds", "gauge", "Work in one tick, largest",
     [](const status_t& s) { return seconds(s.compute_max_ns); }},
    {"sent_messages_total", "counter", "Messages sent on the bus",
     [](const status_t& s) { return sum(s.sent); }},
    {"received_messages_total", "counter", "Messages accepted from the bus",
     [](const status_t& s) { return sum(s.received); }},
    {"lost_messages_total", "counter", "Sequence numbers that never came",
     [](const status_t& s) { return sum(s.gaps); }},
    {"malformed_messages_total", "counter", "Datagrams that are no message of this wire",
     [](const status_t& s) { return number(s.malformed); }},
    {"unauthentic_messages_total", "counter", "Messages with a missing or wrong signature",
     [](const status_t& s) { return number(s.unauthentic); }},
    {"kernel_dropped_messages_total", "counter", "Lost because the socket's buffer was full",
     [](const status_t& s) { return number(s.kernel_dropped); }},
    {"refused_commands_total", "counter", "Commands not obeyed, for any reason",
     [](const status_t& s) {
       return number(s.refused_not_finite + s.refused_epoch + s.refused_expired +
                     s.refused_counter + s.refused_writer);
     }},
};

void head(std::string& to, std::string_view name, std::string_view type, std::string_view help) {
  to += fmt::format("# HELP gyrotwin_{0} {1}\n# TYPE gyrotwin_{0} {2}\n", name, help, type);
}

/// "integrator" of "INTEGRATOR/STATUS".
std::string service_of(const ChannelSpec& channel) {
  std::string name(channel.suffix.substr(0, channel.suffix.find('/')));
  for (char& c : name) c = static_cast<char>(c - 'A' + 'a');
  return name;
}

}  // namespace

std::string metrics_text(const Gateway& gateway, const ServerCounters& server,
                         const BusCounters& bus) {
  std::string text;
  const std::string& rig = gateway.rig().name;
  for (const Series& series : kDaemon) {
    head(text, series.name, series.type, series.help);
    for (const ChannelSpec& channel : kChannels) {
      const auto& status = gateway.status(channel.channel);
      if (!status) continue;
      text += fmt::format("gyrotwin_{}{{rig=\"{}\",service=\"{}\"}} {}\n", series.name, rig,
                          service_of(channel), series.value(*status));
    }
  }
  const auto own = [&](std::string_view name, std::string_view type, std::string_view help,
                       double value) {
    head(text, name, type, help);
    text += fmt::format("gyrotwin_{}{{rig=\"{}\"}} {}\n", name, rig, value);
  };
  std::size_t waiting = 0;
  std::int64_t left_out = gateway.counters().messages_left_out;
  for (const Client& client : gateway.clients()) {
    waiting += client.outbox.size();
    left_out += client.outbox.dropped();
  }
  own("gateway_clients", "gauge", "Clients of the WebSocket",
      static_cast<double>(gateway.clients().size()));
  own("gateway_connections", "gauge", "Open connections", number(server.connections));
  own("gateway_connections_total", "counter", "Connections accepted", number(server.accepted));
  head(text, "gateway_refused_total", "counter", "Connections or questions refused, by reason");
  for (const auto& [reason, count] : {std::pair{"busy", server.refused_busy},
                                      {"access", server.refused_access},
                                      {"malformed", server.refused_malformed}}) {
    text += fmt::format("gyrotwin_gateway_refused_total{{rig=\"{}\",reason=\"{}\"}} {}\n", rig,
                        reason, count);
  }
  own("gateway_queued_bytes", "gauge", "Waiting for clients, all together",
      static_cast<double>(waiting));
  own("gateway_messages_total", "counter", "Messages put in the clients' queues",
      number(gateway.counters().messages_out));
  own("gateway_left_out_messages_total", "counter", "Messages left out: their client was too slow",
      number(left_out));
  own("gateway_client_errors_total", "counter", "Messages of clients that were not understood",
      number(gateway.counters().client_errors));
  own("gateway_requests_total", "counter", "Requests sent to the owner",
      number(gateway.counters().requests));
  own("gateway_requests_denied_total", "counter", "Requests of who is no operator",
      number(gateway.counters().requests_denied));
  own("gateway_kernel_dropped_messages_total", "counter",
      "Messages that the gateway did not hear: its socket's buffer was full",
      number(bus.kernel_dropped));
  return text;
}

}  // namespace gyrotwin
