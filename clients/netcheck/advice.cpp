#include "clients/netcheck/advice.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "clients/common/shell_word.hpp"
#include "clients/common/time_text.hpp"
#include "clients/netcheck/quantity.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin::netcheck {
namespace {

constexpr std::int64_t kIpAndUdp = 28;  // header bytes before a datagram

/// Clocks further apart put the lines of two logs in the wrong order [ns].
constexpr std::int64_t kClocksApart = 1'000'000;

const std::string kLimits = "/etc/security/limits.d/gyrotwin.conf";

/// Texts of one host: its name first, so that it is plain where to type.
class HostAdvice {
 public:
  HostAdvice(const HostFacts& facts, std::vector<Advice>& list)
      : facts_(facts),
        host_(get_text(facts.host)),
        interface_(get_text(facts.interface)),
        list_(list) {}

  void rights() {
    if (facts_.priority_error != 0) {
      add(fmt::format(
              "no right to a realtime priority ({}): a tick waits for whoever runs. Grant it "
              "and log in again.",
              std::strerror(static_cast<int>(facts_.priority_error))),
          {"echo \"$USER - rtprio 80\" |", "  sudo tee -a " + kLimits});
    }
    if (facts_.memory_error != 0) {
      add(fmt::format(
              "no right to lock its memory ({}): a page that is fetched from the disk makes a "
              "tick late. Grant it and log in again.",
              std::strerror(static_cast<int>(facts_.memory_error))),
          {"echo \"$USER - memlock unlimited\" |", "  sudo tee -a " + kLimits});
    }
  }

  void network() {
    if (facts_.buffer_granted < facts_.buffer_wanted) {
      add(fmt::format(
              "the receive buffer has {}, {} were asked for: a daemon that is held up loses "
              "messages.",
              bytes_text(facts_.buffer_granted), bytes_text(facts_.buffer_wanted)),
          {fmt::format("sudo sysctl -w net.core.rmem_max={}", facts_.buffer_wanted / 2)});
    }
    constexpr auto kLargest = static_cast<std::int64_t>(kMaxDatagram) + kIpAndUdp;
    if (facts_.mtu != 0 && facts_.mtu < kLargest) {
      add(fmt::format("{} takes packets of {} bytes; the largest message has {} and is cut in two.",
                      interface_, facts_.mtu, kLargest),
          {"sudo ip link set " + shell_word(interface_) + " mtu 1500"});
    }
    if (facts_.wireless != 0) {
      add(interface_ + " is a radio: it pauses and repeats as it likes. Use a cable.", {});
    }
  }

  void clock() {
    if (facts_.clock_synchronised == 0) {
      add("the clock follows no other: logs of several hosts cannot be compared.",
          {"sudo timedatectl set-ntp true"});
    }
  }

  void power() {
    if (facts_.saves_power != 0) {
      add("its processors save power: they wake up late.",
          {"sudo cpupower frequency-set -g performance", "sudo cpupower idle-set -D 20"});
    }
  }

  void add(const std::string& text, std::vector<std::string> commands) {
    list_.push_back({host_ + ": " + text, std::move(commands)});
  }

 private:
  const HostFacts& facts_;
  std::string host_, interface_;
  std::vector<Advice>& list_;
};

/// One way of a line.
void way_advice(const Way& way, const HostFacts& from, const HostFacts& to,
                std::vector<Advice>& list) {
  const std::string route = get_text(from.host) + " to " + get_text(to.host);
  const auto say = [&](std::string text, std::vector<std::string> commands) {
    list.push_back({std::move(text), std::move(commands)});
  };
  const std::string interface = shell_word(get_text(to.interface));
  if (way.kernel_dropped > 0) {
    say(fmt::format("{}: {} datagrams were dropped as its program did not come to read them: less "
                    "load on it, or the realtime priority.",
                    get_text(to.host), way.kernel_dropped),
        {});
  }
  if (way.lost > way.kernel_dropped) {
    say(fmt::format("{}: {} lost on the way: a cable, a port at half duplex, a switch that is too "
                    "busy or limits multicast. Errors are counted at either end:",
                    route, count_text(way.lost, way.sent)),
        {"ip -s link show " + interface, "sudo ethtool -S " + interface});
  }
  if (way.late > 0) {
    say(fmt::format("{}: {} overtaken: several paths or queues, as of bonds and radios. Late ones "
                    "are dropped.",
                    route, count_text(way.late, way.sent)),
        {});
  }
  if (way.repeats > 0) {
    say(fmt::format("{}: {} came twice: two paths to the same network, a loop or a mirrored port.",
                    route, count_text(way.repeats, way.sent)),
        {});
  }
  if (way.ttl_max >= 0 && way.ttl_min < way.ttl_sent) {
    say(fmt::format(
            "{}: sent with TTL {}, arrived with {}: there are routers on the way. Each adds "
            "delay; the rig belongs on one switch.",
            route, way.ttl_sent, way.ttl_min),
        {});
  }
}

/// Who takes most of the time.
void slow_advice(const CheckedLine& line, const HostFacts& here, std::vector<Advice>& list) {
  const Figures& f = line.figures;
  if (line.verdict.rig.limit != Limit::kSlow && line.verdict.rig.limit != Limit::kStale) return;
  const auto worst = [](const Spread& s) {
    return fmt::format("{} (p99.9 {})", time_text_ns(s.max), time_text_ns(s.p999));
  };
  const auto wakes_late = [&](const HostFacts& facts, const Spread& late) {
    HostAdvice host(facts, list);
    if (facts.priority_error != 0) return;  // said already
    host.add(fmt::format("wakes up as late as {} in spite of its priority: power saving, a virtual "
                         "machine, a driver that blocks. See how late without a network:",
                         worst(late)),
             {"sudo cyclictest -m -p 77 -i 1000 -D 60"});
  };
  switch (line.verdict.slowest) {
    case Part::kNone:
      return;
    case Part::kWakeHere:
      return wakes_late(here, f.wake_here);
    case Part::kWakeThere:
      return wakes_late(line.peer.facts, f.wake_there);
    case Part::kNetwork:
      list.push_back(
          {fmt::format("{} to {} and back takes as long as {}: adapters that gather "
                       "packets before they interrupt, a slow or busy switch.",
                       get_text(here.host), get_text(line.peer.facts.host), worst(f.network)),
           {"sudo ethtool -C " + shell_word(get_text(here.interface)) + " rx-usecs 0"}});
  }
}

void line_advice(const Netcheck& check, const CheckedLine& line, std::vector<Advice>& list) {
  const HostFacts& there = line.peer.facts;
  const std::string name = get_text(there.host);
  if (!line.figures.out) {
    list.push_back(
        {name + " has stopped answering: is `gyrotwin netcheck listen` still running?", {}});
    return;
  }
  way_advice(*line.figures.out, check.here, there, list);
  way_advice(*line.figures.back, there, check.here, list);
  if (line.over_rate > 0) {
    list.push_back({fmt::format("{} left {} pings unanswered, which were too many at once: fewer "
                                "measurements at the same time.",
                                name, line.over_rate),
                    {}});
  }
  if (there.ttl != check.here.ttl) {
    list.push_back(
        {fmt::format("network.ttl is {} on {} and {} on {}: give both the same rig file.",
                     check.here.ttl, get_text(check.here.host), there.ttl, name),
         {}});
  }
  if (line.clock_step_ns > kClocksApart || line.clock_step_ns < -kClocksApart) {
    list.push_back({fmt::format("{}: its clock was set by {} meanwhile: measure once more.",
                                get_text(check.here.host), time_text_ns(line.clock_step_ns)),
                    {}});
  }
  const std::int64_t apart = std::abs(line.figures.clock_offset);
  if (apart > line.figures.clock_uncertainty + kClocksApart) {
    list.push_back(
        {fmt::format("the clocks of {} and {} are {} apart: their logs cannot be compared "
                     "as they are.",
                     get_text(check.here.host), name, time_text_ns(apart)),
         {"sudo timedatectl set-ntp true"}});
  }
  slow_advice(line, check.here, list);
}

/// Nobody answers, or too few: all that may be the reason, the likeliest first.
void silence_advice(const Netcheck& check, std::vector<Advice>& list) {
  const Rig::Network& network = check.rig.network;
  if (network.interface == "lo") {
    list.push_back(
        {"network.interface is `lo`, which no other host hears: name the one that the "
         "others are on, in a copy of the rig file. This host alone is measured by",
         {"gyrotwin netcheck --local " + check.rig_words}});
  }
  if (network.ttl == 0) {
    list.push_back(
        {"network.ttl is 0, which does not leave this host: 1 in a copy of the rig file.", {}});
  }
  list.push_back({"nobody listens there. On the other host, with the same rig file and key:",
                  {"gyrotwin netcheck listen " + check.rig_words}});
  if (check.counters.unauthentic > 0 || network.sign) {
    list.push_back(
        {check.counters.unauthentic > 0
             ? "somebody speaks with another key: compare it on all hosts."
             : "another key there: who lacks this one is not answered. Compare on all hosts:",
         {"gyrotwin key show-id " + check.rig_words}});
  }
  list.push_back({fmt::format("a firewall, here or there. UDP {} and {} must come in:",
                              network.port, check.port),
                  {"sudo nft list ruleset",
                   fmt::format("sudo ufw allow proto udp to {} port {},{}",
                               shell_word(network.group), network.port, check.port)}});
  list.push_back(
      {"a switch with IGMP snooping and no querier forgets groups after minutes: turn one "
       "of the two off or on.",
       {}});
}

/// Hosts of one name are called by their addresses.
Netcheck told_apart(Netcheck check) {
  const std::string here = get_text(check.here.host);
  const auto same = [&](const std::string& name) {
    return (here == name) + std::ranges::count_if(check.lines, [&](const CheckedLine& l) {
             return get_text(l.peer.facts.host) == name;
           });
  };
  std::vector<bool> renamed;
  for (const CheckedLine& l : check.lines) renamed.push_back(same(get_text(l.peer.facts.host)) > 1);
  if (same(here) > 1) set_text(check.here.host, "{}", check.address);
  for (std::size_t i = 0; i < renamed.size(); ++i) {
    Peer& peer = check.lines[i].peer;
    if (renamed[i]) set_text(peer.facts.host, "{}", peer.address);
  }
  return check;
}

}  // namespace

bool Netcheck::complete() const { return lines.size() >= std::max<std::size_t>(1, hosts); }

bool Netcheck::good() const {
  return complete() &&
         std::ranges::all_of(lines, [](const CheckedLine& l) { return l.verdict.rig.good(); });
}

std::vector<Advice> advice(const Netcheck& given) {
  if (!given.broken.empty()) return {{given.broken, {}}};
  const Netcheck check = given.alone ? given : told_apart(given);
  std::vector<Advice> list;
  if (!check.complete()) silence_advice(check, list);
  for (const CheckedLine& line : check.lines) line_advice(check, line, list);

  std::vector<const HostFacts*> hosts{&check.here};
  for (const CheckedLine& line : check.lines) {
    if (!check.alone) hosts.push_back(&line.peer.facts);
  }
  for (const HostFacts* facts : hosts) {
    HostAdvice host(*facts, list);
    host.rights();
    host.network();
    host.power();
    // A host that works alone needs no other's time.
    if (!check.alone) host.clock();
  }
  // Two programs of one host have the same to say.
  std::vector<Advice> distinct;
  for (Advice& a : list) {
    if (std::ranges::find(distinct, a) == distinct.end()) distinct.push_back(std::move(a));
  }
  return distinct;
}

}  // namespace gyrotwin::netcheck
