// Three lab hosts: plant, controller and operator, each a network namespace of its own, joined by a
// wire that can be troubled. Programs run on them, and an ear on two of them hears everything.
// Needs a network namespace in which the test is root: run it by tests/support/in_namespace.
#pragma once

#include <condition_variable>
#include <optional>

#include "tests/support/programs.hpp"
#include "tests/support/wire.hpp"

namespace gyrotwin::support {

/// A network namespace with one interface, `eth0`, whose other end is in ours.
class Host {
 public:
  /// @param port name of the other end
  /// @param number its address is 10.77.0.<number>
  Host(const std::string& port, int number);
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// What this returns was made there: sockets stay in the namespace in which they were opened.
  template <class Make>
  auto inside(Make&& make) const {
    const Back back(descriptor_.get());
    return make();
  }
  /// Words before a program that shall run there.
  Words launcher() const;
  /// Runs a shell command there. @throws std::runtime_error when it fails
  void shell(const std::string& command) const;

 private:
  /// The calling thread is in a namespace, for as long as this lives.
  class Back {
   public:
    explicit Back(int to);
    ~Back();
    Back(const Back&) = delete;
    Back& operator=(const Back&) = delete;

   private:
    Descriptor home_;
  };
  std::string port_;
  Descriptor descriptor_;
};

/// One message as it was heard.
struct Heard {
  Channel channel;
  std::vector<std::uint8_t> payload;

  template <class Message>
  Message as() const {
    Message message;
    Bus::decode({channel, false, payload}, message);
    return message;
  }
};

/// Hears a rig's bus in a thread of its own, so that nothing is lost while the test does something
/// else, and remembers all of it.
class Ear {
 public:
  explicit Ear(std::unique_ptr<Bus> bus);
  ~Ear();
  Ear(const Ear&) = delete;
  Ear& operator=(const Ear&) = delete;

  /// Everything since forget().
  std::vector<Heard> record() const;
  void forget();
  /// Hands what comes from now on to `done` until it returns true.
  /// @return false after `limit_s` of wall time
  template <class Done>
  bool until(Done&& done, double limit_s = 30.0) {
    std::unique_lock lock(mutex_);
    std::size_t next = record_.size();
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
    for (;;) {
      for (; next < record_.size(); ++next) {
        if (done(record_[next])) return true;
      }
      const auto news = [&] { return record_.size() > next; };
      if (!more_.wait_until(lock, end, news)) return false;
    }
  }
  /// The owner's next STATUS that satisfies `holds`; absent after `limit_s`.
  template <class Holds>
  std::optional<status_t> owner_status(Holds&& holds, double limit_s = 30.0) {
    status_t status{};
    const bool came = until(
        [&](const Heard& heard) {
          if (!is_owner_status(heard.channel)) return false;
          status = heard.as<status_t>();
          return holds(status);
        },
        limit_s);
    return came ? std::optional(status) : std::nullopt;
  }

 private:
  void listen();

  std::unique_ptr<Bus> bus_;
  mutable std::mutex mutex_;
  std::condition_variable more_;
  std::vector<Heard> record_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

class Hosts : public Programs {
 public:
  static constexpr std::uint64_t kSeed = 1;  // of the wire's dice

  /// A shipped rig on the hosts' interface instead of this host's own.
  Hosts(const std::string& rig_name, Words overrides);

  /// The operator's client from start to end. @return its exit code; `said` has its output
  int ask(const std::string& program, const Words& arguments) {
    return run(program, arguments, at_operator.launcher());
  }
  /// On the plant's host: a simulated plant, or hardware on a line to an emulated rig, which goes
  /// on where it still runs.
  void start_owner(bool hardware = false);
  /// On the controller's host.
  void start_controller(const Words& arguments = {});

  Host plant{"plant", 1}, controllers{"controllers", 2}, at_operator{"operators", 3};
  enum Port : std::size_t { kPlant, kControllers, kOperators };  ///< of the wire
  Wire wire{{"plant", "controllers", "operators"}, kSeed};
  Ear plant_ear, operator_ear;
  /// Words between the namespace and the daemons: an environment.
  Words environment;
  std::unique_ptr<Process> controller, emulator, owner;

 private:
  std::unique_ptr<Bus> open_bus(const Host& host) const;
  Words launcher(const Host& host) const;
};

}  // namespace gyrotwin::support
