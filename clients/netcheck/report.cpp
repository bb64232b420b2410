#include "clients/netcheck/report.hpp"

#include <spdlog/fmt/fmt.h>

#include <cstring>

#include "clients/common/time_text.hpp"
#include "clients/common/wrap.hpp"
#include "clients/netcheck/quantity.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin::netcheck {
namespace {

constexpr std::size_t kColumns = 80;

std::string right_text(std::int64_t error) {
  return error == 0 ? "granted" : "NO: " + std::string(std::strerror(static_cast<int>(error)));
}

std::string clock_text(const HostFacts& facts) {
  if (facts.clock_synchronised == 0) return "NOT synchronised";
  return "synchronised, +-" + time_text_ns(facts.clock_max_error_ns);
}

std::string buffer_text(const HostFacts& facts) {
  if (facts.buffer_granted >= facts.buffer_wanted) return bytes_text(facts.buffer_granted);
  return fmt::format("{} of {}", bytes_text(facts.buffer_granted), bytes_text(facts.buffer_wanted));
}

std::string row(std::string_view what, std::string_view here, std::string_view there) {
  std::string text = fmt::format("  {:<24}{:<27}{}", what, here, there);
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

/// Both ends side by side; `there` may be absent.
std::string host_rows(const HostFacts& here, const std::string& address, const Peer* peer) {
  const auto both = [&](std::string_view what, auto&& say) {
    return row(what, say(here), peer == nullptr ? std::string() : say(peer->facts));
  };
  std::string text = row("", "here: " + get_text(here.host),
                         peer == nullptr ? std::string() : "there: " + get_text(peer->facts.host));
  text += row("address", address, peer == nullptr ? std::string() : peer->address);
  text += both("interface, MTU, TTL", [](const HostFacts& f) {
    return fmt::format("{}, {}, {}", get_text(f.interface), f.mtu, f.ttl);
  });
  text += both("receive buffer", buffer_text);
  text +=
      both("realtime priority", [](const HostFacts& f) { return right_text(f.priority_error); });
  text += both("locked memory", [](const HostFacts& f) { return right_text(f.memory_error); });
  return text + both("clock", clock_text);
}

std::string ttl_text(const Way& way) {
  if (way.ttl_max < 0) return fmt::format("{}, never", way.ttl_sent);
  if (way.ttl_min == way.ttl_max) return fmt::format("{}, {}", way.ttl_sent, way.ttl_min);
  return fmt::format("{}, {} to {}", way.ttl_sent, way.ttl_min, way.ttl_max);
}

std::string way_rows(const Way& out, const Way& back) {
  const auto both = [&](std::string_view what, auto&& say) {
    return row(what, say(out), say(back));
  };
  std::string text = row("", "here to there", "there to here");
  text += both("lost", [](const Way& w) { return count_text(w.lost, w.sent); });
  text += both("overtaken", [](const Way& w) { return count_text(w.late, w.sent); });
  text += both("came twice", [](const Way& w) { return count_text(w.repeats, w.sent); });
  text +=
      both("buffer overflowed", [](const Way& w) { return fmt::format("{}", w.kernel_dropped); });
  return text + both("TTL sent, arrived", ttl_text);
}

std::string spread_row(std::string_view what, const Spread& s) {
  return fmt::format("  {:<36}{:>10}{:>10}{:>10}{:>10}\n", what, time_text_ns(s.p50),
                     time_text_ns(s.p99), time_text_ns(s.p999), time_text_ns(s.max));
}

std::string spread_rows(const Figures& f) {
  return fmt::format("  {:<36}{:>10}{:>10}{:>10}{:>10}\n", "", "p50", "p99", "p99.9", "max") +
         spread_row("waking up here", f.wake_here) +
         spread_row("the network, there and back", f.network) +
         spread_row("  its jitter, ping to ping", f.jitter) +
         spread_row("waking up and answering there", f.wake_there) +
         spread_row("tick to answer", f.response);
}

std::string rate_text(double hz) { return fmt::format("{:g} Hz", hz); }

std::string verdict_rows(const Netcheck& check, const CheckedLine& line) {
  const LineVerdict& v = line.verdict;
  const int timeout = check.rig.safety.command_timeout_ticks;
  const std::string rig = rate_text(v.rig.rate_hz);
  std::string text;
  if (v.rig.good()) {
    text = fmt::format("GOOD for this rig's {}", rig);
    if (v.good_for_hz > v.rig.rate_hz)
      text += fmt::format(", and up to {}", rate_text(v.good_for_hz));
  } else {
    text = fmt::format("NOT GOOD for this rig's {}; ", rig);
    text += v.good_for_hz > 0.0 ? "good for " + rate_text(v.good_for_hz) : "good for no rate";
  }
  text += "\n";
  if (!v.rig.good()) {
    text += paragraph(limit_text(v.rig, timeout), kColumns, 2);
  } else if (const Fit* limited = v.limited()) {
    text += paragraph("limit: " + limit_text(*limited, timeout), kColumns, 2);
  }
  text += paragraph(fmt::format("newest command at worst {} ticks old at {}; {} is a SAFE_STOP",
                                v.rig.age_ticks, rig, timeout),
                    kColumns, 2);
  return text;
}

std::string line_text(const Netcheck& check, const CheckedLine& line) {
  const Figures& f = line.figures;
  std::string text = host_rows(check.here, check.address, &line.peer);
  if (f.clock_uncertainty > 0) {
    text += row("clock there, seen here", "",
                fmt::format("{}{}, +-{}", f.clock_offset < 0 ? "" : "+",
                            time_text_ns(f.clock_offset), time_text_ns(f.clock_uncertainty)));
  }
  text += fmt::format("\n{} pings at {}, {} unanswered, {} ticks slept through\n",
                      f.ticks - f.missed, rate_text(line.rate_hz), f.unanswered, f.missed);
  if (f.out) text += way_rows(*f.out, *f.back);
  return text + spread_rows(f) + "\n" + verdict_rows(check, line);
}

std::string advice_text(const Netcheck& check) {
  const std::vector<Advice> list = advice(check);
  if (list.empty()) return "\nNothing to fix.\n";
  std::string text = "\nTo fix:\n";
  int number = 0;
  for (const Advice& a : list) {
    std::string entry = paragraph(a.text, kColumns, 4);
    entry.replace(0, 4, fmt::format("{:2}. ", ++number));
    text += entry;
    for (const std::string& command : a.commands) text += "      " + command + "\n";
  }
  return text;
}

}  // namespace

std::string limit_text(const Fit& fit, int timeout_ticks) {
  const std::string rate = rate_text(fit.rate_hz);
  if (fit.limit == Limit::kLoss) {
    return fmt::format("{}: {} of the ticks have no answer at all ({} may)", rate,
                       share_text(fit.unanswered), share_text(kMayMiss));
  }
  if (fit.limit == Limit::kSlow) {
    return fmt::format("{}: {} of the ticks have no answer within {} ({} may)", rate,
                       share_text(fit.missed), time_text_ns(fit.budget_ns), share_text(kMayMiss));
  }
  return fmt::format("{}: the newest command was once {} ticks old; {} is a SAFE_STOP", rate,
                     fit.age_ticks, timeout_ticks);
}

std::string report_text(const Netcheck& check) {
  const Rig::Network& network = check.rig.network;
  std::string text =
      fmt::format("gyrotwin netcheck  {}  {}{}, {}, port {}\n\n", check.rig.name, network.interface,
                  check.alone ? " (this host alone)" : "", network.group, check.port);
  if (!check.broken.empty()) return text + "NOT GOOD: nothing can be sent\n" + advice_text(check);
  if (check.lines.empty()) {
    return text + host_rows(check.here, check.address, nullptr) +
           "\nNOT GOOD: no other host answers\n" + advice_text(check);
  }
  for (const CheckedLine& line : check.lines) {
    if (&line != &check.lines.front()) text += "\n" + std::string(kColumns, '-') + "\n";
    text += line_text(check, line);
  }
  if (!check.complete()) {
    text += fmt::format("\nNOT GOOD: {} of {} hosts answered\n", check.lines.size(), check.hosts);
  }
  return text + advice_text(check);
}

}  // namespace gyrotwin::netcheck
