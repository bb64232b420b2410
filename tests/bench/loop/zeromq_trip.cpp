// ZeroMQ with the bytes of the two messages, neither encoded nor decoded: PUB and SUB over TCP, as
// it is mostly used between programs, and a PAIR over a Unix socket, the fastest it has between
// two.
#include <zmq.h>

#include <array>
#include <cstring>
#include <stdexcept>
#include <string>

#include "messages/channels.hpp"
#include "tests/bench/loop/trip.hpp"

namespace gyrotwin::bench {
namespace {

/// One way or both.
class Socket {
 public:
  Socket(void* context, int type) : socket_(zmq_socket(context, type)) {
    const int patience = kPatienceMs, none = 0;
    zmq_setsockopt(socket_, ZMQ_RCVTIMEO, &patience, sizeof patience);
    zmq_setsockopt(socket_, ZMQ_LINGER, &none, sizeof none);
    if (type == ZMQ_SUB) zmq_setsockopt(socket_, ZMQ_SUBSCRIBE, "", 0);
  }
  ~Socket() { zmq_close(socket_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  Socket& bind(const std::string& at) {
    if (zmq_bind(socket_, at.c_str()) != 0) throw std::runtime_error("ZeroMQ: " + at + " is taken");
    return *this;
  }
  Socket& connect(const std::string& to) {
    zmq_connect(socket_, to.c_str());
    return *this;
  }
  template <class Bytes>
  void send(const Bytes& bytes) {
    zmq_send(socket_, bytes.data(), bytes.size(), ZMQ_DONTWAIT);
  }
  template <class Bytes>
  bool receive(Bytes& bytes) {
    return zmq_recv(socket_, bytes.data(), bytes.size(), 0) >= 0;
  }

 private:
  void* socket_;
};

struct Context {
  Context() : pointer(zmq_ctx_new()) {}
  ~Context() { zmq_ctx_term(pointer); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  void* pointer;
};

class PubSub {
 public:
  explicit PubSub(bool near) : out_(context_.pointer, ZMQ_PUB), in_(context_.pointer, ZMQ_SUB) {
    out_.bind(near ? kNear : kFar);
    in_.connect(near ? kFar : kNear);
  }
  Socket& out() { return out_; }
  Socket& in() { return in_; }

 private:
  static constexpr auto kNear = "tcp://127.0.0.1:21006", kFar = "tcp://127.0.0.1:21007";
  Context context_;
  Socket out_, in_;
};

class Pair {
 public:
  explicit Pair(bool near) : both_(context_.pointer, ZMQ_PAIR) {
    // A name in no folder, which goes with the network namespace.
    constexpr auto place = "ipc://@gyrotwin_loop_bench";
    near ? both_.bind(place) : both_.connect(place);
  }
  Socket& out() { return both_; }
  Socket& in() { return both_; }

 private:
  Context context_;
  Socket both_;
};

template <class Link>
class ZmqNear final : public Near {
 public:
  bool there_and_back() override {
    ++sequence_;
    std::memcpy(state_.data(), &sequence_, sizeof sequence_);
    link_.out().send(state_);
    std::int64_t answered = 0;
    while (answered != sequence_) {
      if (!link_.in().receive(command_)) return false;
      std::memcpy(&answered, command_.data(), sizeof answered);
    }
    return true;
  }

 private:
  Link link_{true};
  std::int64_t sequence_ = 0;
  std::array<std::uint8_t, kWireSize<state_t>> state_{};
  std::array<std::uint8_t, kWireSize<command_t>> command_{};
};

template <class Link>
class ZmqFar final : public Far {
 public:
  void answer() override {
    if (!link_.in().receive(state_)) return;
    std::memcpy(command_.data(), state_.data(), sizeof(std::int64_t));
    link_.out().send(command_);
  }

 private:
  Link link_{false};
  std::array<std::uint8_t, kWireSize<state_t>> state_{};
  std::array<std::uint8_t, kWireSize<command_t>> command_{};
};

}  // namespace

std::unique_ptr<Near> zeromq_near() { return std::make_unique<ZmqNear<PubSub>>(); }
std::unique_ptr<Far> zeromq_far() { return std::make_unique<ZmqFar<PubSub>>(); }
std::unique_ptr<Near> zeromq_ipc_near() { return std::make_unique<ZmqNear<Pair>>(); }
std::unique_ptr<Far> zeromq_ipc_far() { return std::make_unique<ZmqFar<Pair>>(); }

}  // namespace gyrotwin::bench
