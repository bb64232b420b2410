// Rows about others who mean well: a second owner, a second controller, a rig file of another host.
#include <signal.h>

#include "services/runtime/text.hpp"
#include "tests/faults/fixture.hpp"

namespace gyrotwin::faults {

namespace {

constexpr const char* kConflict = " owns this rig too; stop one of the two";

/// A program with another interface than the rig's. @return its exit code
int with_interface(Hosts& hosts, const std::string& program, const std::string& interface,
                   const Words& arguments = {}) {
  Words words = hosts.at_operator.launcher();
  words.insert(words.end(),
               {std::string(GYROTWIN_BIN) + "/gyrotwin-" + program, "--rig", hosts.rig.name,
                "--set", "network.interface=" + interface, "--set", "network.ttl=1"});
  words.insert(words.end(), arguments.begin(), arguments.end());
  Process process(words, hosts.folder() / "other_interface.txt");
  const int code = process.wait();
  hosts.said = process.output();
  return code;
}

}  // namespace

TEST_F(Strict, SecondOwnerIsRefused) {
  row("a second owner is started", "the second ends with code 1, the first balances on",
      "at the second's start: \"is owned already by process ... on ...; stop that one first\"",
      kNothing);
  EXPECT_EQ(hosts().ask("integrator", {}), 1);
  EXPECT_NE(hosts().said.find("is owned already by process"), std::string::npos) << hosts().said;
  ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));
}

TEST_F(Strict, TwoOwnersMeet) {
  row("two owners, each RUNNING on its side of a cut, meet", "both SAFE_STOP",
      "conflict: process ... on ... owns this rig too; stop one of the two (each names the other)",
      "ending one; `reset`, `arm`");
  // The operators' host is an island with an owner and a controller of its own.
  hosts().wire.cut(Hosts::kOperators, true);
  const auto owner = hosts().start("integrator", {}, hosts().at_operator.launcher());
  const auto controller = hosts().start("controller", {}, hosts().at_operator.launcher());
  ASSERT_NO_FATAL_FAILURE(asks({"wait", "ready", "--timeout", "30"}, 0, "ready"));
  ASSERT_NO_FATAL_FAILURE(asks({"speed", "0.25"}, 0, ""));
  ASSERT_NO_FATAL_FAILURE(asks({"arm"}, 0, "RUNNING"));
  ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));

  hosts().wire.cut(Hosts::kOperators, false);
  for (const pid_t other : {owner->pid(), hosts().owner->pid()}) {
    const std::string named = "conflict: process " + std::to_string(other) + " on ";
    EXPECT_TRUE(hosts().operator_ear.owner_status([&named](const status_t& status) {
      return status.mode == status_t::MODE_SAFE_STOP && get_text(status.text).starts_with(named) &&
             get_text(status.text).ends_with(kConflict);
    })) << named;
  }
  EXPECT_TRUE(owner->running() && controller->running());
  owner->signal(SIGTERM);
  controller->signal(SIGTERM);
  EXPECT_EQ(owner->wait(), 0) << owner->output();
  EXPECT_EQ(controller->wait(), 0) << controller->output();
}

TEST_F(Strict, AnOwnerThatIsHeldMeetsOneThatRuns) {
  row("an owner that is HELD meets one that is RUNNING", "SAFE_STOP; the other stays HELD",
      "both: conflict: process ... on ... owns this rig too; stop one of the two",
      "ending one; `reset`, `arm`");
  hosts().wire.cut(Hosts::kOperators, true);
  const auto owner = hosts().start("integrator", {}, hosts().at_operator.launcher());
  ASSERT_TRUE(hosts().operator_ear.owner_status(
      [](const status_t& status) { return status.mode == status_t::MODE_HELD; }));
  hosts().wire.cut(Hosts::kOperators, false);
  EXPECT_TRUE(hosts().operator_ear.owner_status([](const status_t& status) {
    return status.mode == status_t::MODE_SAFE_STOP && get_text(status.text).ends_with(kConflict);
  }));
  EXPECT_TRUE(hosts().operator_ear.owner_status([](const status_t& status) {
    return status.mode == status_t::MODE_HELD && get_text(status.text).ends_with(kConflict);
  }));
  owner->signal(SIGTERM);
  EXPECT_EQ(owner->wait(), 0) << owner->output();
}

TEST_F(Patient, SecondControllerWaitsForTheLease) {
  row("a second controller; then the first one is killed",
      "balances on by the first; when its lease ends, by the second",
      "RUNNING; `ctl status`: \"without the lease\"", kNothing);
  const auto waits = [this] {
    const std::int64_t before = owner_status().refused_writer;
    return hosts().plant_ear.owner_status(
        [before](const status_t& status) { return status.refused_writer > before + 50; });
  };
  const auto second = hosts().start("controller", {}, hosts().at_operator.launcher());
  ASSERT_TRUE(waits()) << second->output();
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "without the lease"));
  hosts().controller->signal(SIGKILL);
  hosts().controller->wait();
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  // And back.
  hosts().start_controller();
  ASSERT_TRUE(waits()) << hosts().controller->output();
  second->signal(SIGKILL);
  second->wait();
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
}

TEST_F(Patient, WrongInterface) {
  row("an interface that is not there, that is down, that has no address",
      "no program starts (code 75: a unit tries again); what runs balances on",
      "\"network.interface is `...`, which does not exist; this host has: ...\", \"which is down: "
      "`ip link set ... up`\", \"which has no IPv4 address: `ip address add ...`\"",
      kNothing);
  for (const char* program : {"integrator", "hardware", "controller", "mirror", "gateway"}) {
    const Words arguments =
        program == std::string_view("hardware") ? Words{"--device", "/tmp/none"} : Words{};
    EXPECT_EQ(with_interface(hosts(), program, "eth7", arguments), 75) << hosts().said;
    EXPECT_NE(hosts().said.find("network.interface is `eth7`, which does not exist; this host "
                                "has: "),
              std::string::npos)
        << hosts().said;
  }
  hosts().at_operator.shell("ip link add name spare type veth peer name spare_end");
  EXPECT_EQ(with_interface(hosts(), "controller", "spare"), 75);
  EXPECT_NE(hosts().said.find("which is down: `ip link set spare up`"), std::string::npos)
      << hosts().said;
  hosts().at_operator.shell("ip link set spare up");
  EXPECT_EQ(with_interface(hosts(), "controller", "spare"), 75);
  EXPECT_NE(hosts().said.find("which has no IPv4 address: `ip address add ADDRESS/24 dev spare`"),
            std::string::npos)
      << hosts().said;
  hosts().at_operator.shell("ip link delete spare");
  ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));
}

TEST_F(Patient, InterfaceOfThisHostOnly) {
  row("the operator's rig file still says `lo`", "balances on",
      "`ctl`: \"no owner of rig double_brennan is heard on this subnet (lo, ...)\"", kNothing);
  EXPECT_EQ(with_interface(hosts(), "ctl", "lo", {"disarm"}), 1);
  EXPECT_NE(hosts().said.find("no owner of rig double_brennan is heard on this subnet (lo, "),
            std::string::npos)
      << hosts().said;
}

}  // namespace gyrotwin::faults
