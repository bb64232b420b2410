#include "tests/support/hosts.hpp"

#include <fcntl.h>
#include <sched.h>

#include <cstdlib>
#include <stdexcept>

namespace gyrotwin::support {

namespace {

Descriptor present_namespace() {
  Descriptor descriptor(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC));
  if (!descriptor.valid()) throw std::runtime_error("no /proc/thread-self/ns/net");
  return descriptor;
}

/// Another process finds the namespace there for as long as we live.
std::string path_of(const Descriptor& descriptor) {
  return "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(descriptor.get());
}

void run_shell(const std::string& command) {
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

Words on_eth0(Words overrides) {
  overrides.insert(overrides.end(), {"network.interface=eth0", "network.ttl=1"});
  return overrides;
}

}  // namespace

Host::Back::Back(int to) : home_(present_namespace()) {
  if (::setns(to, CLONE_NEWNET) != 0) throw std::runtime_error("setns is not permitted");
}

Host::Back::~Back() {
  if (::setns(home_.get(), CLONE_NEWNET) != 0) std::abort();  // all that follows would be wrong
}

Host::Host(const std::string& port, int number) : port_(port) {
  {
    const Back back(present_namespace().get());
    if (::unshare(CLONE_NEWNET) != 0) throw std::runtime_error("unshare is not permitted");
    descriptor_ = present_namespace();
  }
  run_shell("ip link add name " + port + " type veth peer name eth0 netns " + path_of(descriptor_) +
            " && ip link set " + port + " up");
  shell("ip link set lo up && ip address add 10.77.0." + std::to_string(number) +
        "/24 dev eth0 && ip link set eth0 up");
}

/// The namespace goes when the last of its processes and sockets has; its cable now, so that
/// another may be called so.
Host::~Host() {
  [[maybe_unused]] const int code = std::system(("ip link delete " + port_).c_str());
}

Words Host::launcher() const { return {"/usr/bin/nsenter", "--net=" + path_of(descriptor_), "--"}; }

void Host::shell(const std::string& command) const {
  run_shell("nsenter --net=" + path_of(descriptor_) + " -- sh -c '" + command + "'");
}

Ear::Ear(std::unique_ptr<Bus> bus) : bus_(std::move(bus)), thread_([this] { listen(); }) {}

Ear::~Ear() {
  stopping_ = true;
  thread_.join();
}

std::vector<Heard> Ear::record() const {
  const std::lock_guard lock(mutex_);
  return record_;
}

void Ear::forget() {
  const std::lock_guard lock(mutex_);
  record_.clear();
}

void Ear::listen() {
  while (!stopping_) {
    while (const auto reception = bus_->receive()) {
      const std::lock_guard lock(mutex_);
      record_.push_back(
          {reception->channel, {reception->payload.begin(), reception->payload.end()}});
    }
    more_.notify_all();
    bus_->wait(10'000'000);
  }
}

Hosts::Hosts(const std::string& rig_name, Words overrides)
    : Programs(rig_name, on_eth0(std::move(overrides))),
      plant_ear(open_bus(plant)),
      operator_ear(open_bus(at_operator)) {}

std::unique_ptr<Bus> Hosts::open_bus(const Host& host) const {
  return host.inside([this] { return std::make_unique<Bus>(bus_config(rig, header_t::OPERATOR)); });
}

Words Hosts::launcher(const Host& host) const {
  Words words = host.launcher();
  words.insert(words.end(), environment.begin(), environment.end());
  return words;
}

void Hosts::start_owner(bool hardware) {
  if (!hardware) {
    owner = start("integrator", {}, launcher(plant));
    return;
  }
  const std::string line = (folder() / "line").string();
  if (!emulator || !emulator->running()) {
    emulator = start("rig_emulator", {"--link", line}, launcher(plant));
  }
  owner = start("hardware", {"--device", line}, launcher(plant));
}

void Hosts::start_controller(const Words& arguments) {
  controller = start("controller", arguments, launcher(controllers));
}

}  // namespace gyrotwin::support
