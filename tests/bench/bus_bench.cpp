// What the bus costs: one message out, one message in, and the way there and back beside raw UDP
// and liblcm in the same run. liblcm needs a multicast route:
//   tests/support/in_namespace build/release/bin/bus_bench
#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "services/runtime/bus.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

BusConfig config(bool with_key) {
  return test_config(with_key ? std::optional(test_key()) : std::nullopt);
}

/// Encode, sign (argument 1) or not (0), and send one STATE that nobody sleeps for.
void send_state(benchmark::State& run) {
  Bus bus(config(run.range(0) != 0));
  auto state = distinct<state_t>();
  Stamp stamp{.epoch = 1};
  for ([[maybe_unused]] auto _ : run) {
    bus.send(Channel::kState, state, stamp);
    ++stamp.sequence;
  }
  run.counters["send_failed"] = static_cast<double>(bus.counters().send_failed);
}
BENCHMARK(send_state)->ArgName("signed")->Arg(0)->Arg(1);

/// Receive, check and decode one STATE that waits already.
void receive_state(benchmark::State& run) {
  constexpr int kBatch = 100;
  Bus ears(config(run.range(0) != 0));
  Bus mouth(config(run.range(0) != 0));
  auto state = distinct<state_t>();
  Stamp stamp{.epoch = 1};
  while (run.KeepRunningBatch(kBatch)) {
    run.PauseTiming();
    while (ears.receive()) {
    }
    for (int i = 0; i < kBatch; ++i, ++stamp.sequence) mouth.send(Channel::kState, state, stamp);
    run.ResumeTiming();
    for (int i = 0; i < kBatch; ++i) {
      const auto reception = ears.receive();
      if (!reception) return run.SkipWithError("a datagram is missing");
      Bus::decode(*reception, state);
      benchmark::DoNotOptimize(state);
    }
  }
}
BENCHMARK(receive_state)->ArgName("signed")->Arg(0)->Arg(1);

/// The judgement alone: parsing and checking one STATE, no socket.
void parse_state(benchmark::State& run) {
  const BusConfig c = config(run.range(0) != 0);
  const DatagramFormat format(c.prefix, c.rig_id, c.key);
  Frame frame{};
  const std::size_t at = format.begin(frame, Channel::kState, 0);
  std::ranges::copy(distinct_payload(Channel::kState, kTestRig),
                    frame.begin() + static_cast<std::ptrdiff_t>(at));
  const std::span<const std::uint8_t> datagram(frame.data(), at + kWireSize<state_t>);
  format.sign(frame, datagram.size());
  for ([[maybe_unused]] auto _ : run) benchmark::DoNotOptimize(format.parse(datagram));
}
BENCHMARK(parse_state)->ArgName("signed")->Arg(0)->Arg(1);

/// A request that is answered by an echo in another thread.
class RoundTrip {
 public:
  virtual ~RoundTrip() = default;
  virtual void there_and_back() = 0;
};

/// Bytes of a STATE between two connected UDP sockets.
class RawTrip final : public RoundTrip {
 public:
  RawTrip() : near_(open_and_bind()), far_(open_and_bind()), bytes_(kWireSize<state_t>) {
    join(near_, far_);
    join(far_, near_);
    echo_ = std::jthread([this] {
      Bytes buffer(bytes_.size());
      while (recv(far_.get(), buffer.data(), buffer.size(), 0) > 1) {
        send(far_.get(), buffer.data(), buffer.size(), 0);
      }
    });
  }
  ~RawTrip() override { send(near_.get(), bytes_.data(), 1, 0); }

  void there_and_back() override {
    send(near_.get(), bytes_.data(), bytes_.size(), 0);
    if (recv(near_.get(), bytes_.data(), bytes_.size(), 0) < 0) throw std::runtime_error("recv");
  }

 private:
  static void check(int result) {
    if (result != 0) throw std::runtime_error("no raw UDP socket");
  }
  static Descriptor open_and_bind() {
    Descriptor socket(::socket(AF_INET, SOCK_DGRAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    check(bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address));
    return socket;
  }
  static void join(const Descriptor& socket, const Descriptor& peer) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(peer.get(), reinterpret_cast<sockaddr*>(&address), &size);
    check(connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), size));
  }

  Descriptor near_, far_;
  Bytes bytes_;
  std::jthread echo_;
};

/// STATE there, TRUTH (as long) back, each encoded, signed when there is a key, checked and
/// decoded.
class BusTrip final : public RoundTrip {
 public:
  explicit BusTrip(const BusConfig& c) : near_(c), far_(c) {
    echo_ = std::jthread([this](const std::stop_token& stop) {
      auto truth = distinct<truth_t>();
      while (!stop.stop_requested()) {
        far_.wait(kSecond / 10);
        while (const auto reception = far_.receive()) {
          Bus::decode(*reception, heard_);
          far_.send(Channel::kTruth, truth, {.epoch = 2, .sequence = heard_.header.sequence});
        }
      }
    });
  }

  void there_and_back() override {
    near_.send(Channel::kState, state_, {.epoch = 1, .sequence = ++sequence_});
    for (int i = 0; i < 1000; ++i) {
      near_.wait(kSecond / 10);
      while (const auto reception = near_.receive()) {
        Bus::decode(*reception, answer_);
        if (answer_.header.sequence == sequence_) return;
      }
    }
    throw std::runtime_error("no answer over the bus");
  }

 private:
  Bus near_, far_;
  state_t state_ = distinct<state_t>();
  state_t heard_;
  truth_t answer_;
  std::int64_t sequence_ = 0;
  std::jthread echo_;
};

/// The same two messages through liblcm, unsigned.
class LiblcmTrip final : public RoundTrip {
 public:
  explicit LiblcmTrip(const BusConfig& c) : near_(url(c)), far_(url(c)) {
    if (!near_.good() || !far_.good()) throw std::runtime_error("no liblcm: no multicast route?");
    near_.subscribe("B/TRUTH", &LiblcmTrip::take_answer, this);
    far_.subscribe("B/STATE", &LiblcmTrip::answer, this);
    echo_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) far_.handleTimeout(100);
    });
  }

  void there_and_back() override {
    state_.header.sequence = ++sequence_;
    near_.publish("B/STATE", &state_);
    for (int i = 0; i < 1000 && answered_ != sequence_; ++i) near_.handleTimeout(100);
    if (answered_ != sequence_) throw std::runtime_error("no answer over liblcm");
  }

 private:
  // A port of its own, so that neither bus pays for the other's datagrams.
  static std::string url(const BusConfig& c) {
    return "udpm://" + c.group + ":" + std::to_string(c.port + 10000) + "?ttl=0";
  }
  void answer(const lcm::ReceiveBuffer*, const std::string&, const state_t* state) {
    truth_.header.sequence = state->header.sequence;
    far_.publish("B/TRUTH", &truth_);
  }
  void take_answer(const lcm::ReceiveBuffer*, const std::string&, const truth_t* truth) {
    answered_ = truth->header.sequence;
  }

  lcm::LCM near_, far_;
  state_t state_ = distinct<state_t>();
  truth_t truth_ = distinct<truth_t>();
  std::int64_t sequence_ = 0;
  std::int64_t answered_ = 0;
  std::jthread echo_;
};

/// Duration of one trip [us].
double timed(RoundTrip& trip) {
  const auto start = std::chrono::steady_clock::now();
  trip.there_and_back();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}

double quantile(std::vector<double>& values, double q) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// One trip of each kind in turn, so that whatever else the machine does disturbs all alike.
void round_trip(benchmark::State& run) {
  try {
    RawTrip raw;
    BusTrip bus(config(false));
    BusConfig second = config(true);  // a port of its own, like liblcm's
    ++second.port;
    BusTrip signed_bus(second);
    LiblcmTrip liblcm(config(false));
    std::vector<double> raw_us, bus_us, signed_us, liblcm_us;
    for ([[maybe_unused]] auto _ : run) {
      raw_us.push_back(timed(raw));
      bus_us.push_back(timed(bus));
      signed_us.push_back(timed(signed_bus));
      liblcm_us.push_back(timed(liblcm));
    }
    const double reference = quantile(raw_us, 0.5);
    run.counters["raw_p50_us"] = reference;
    run.counters["raw_p99_us"] = quantile(raw_us, 0.99);
    run.counters["bus_p50_us"] = quantile(bus_us, 0.5);
    run.counters["bus_p99_us"] = quantile(bus_us, 0.99);
    run.counters["signed_p50_us"] = quantile(signed_us, 0.5);
    run.counters["signed_p99_us"] = quantile(signed_us, 0.99);
    run.counters["liblcm_p50_us"] = quantile(liblcm_us, 0.5);
    run.counters["liblcm_p99_us"] = quantile(liblcm_us, 0.99);
    run.counters["bus_over_raw"] = quantile(bus_us, 0.5) / reference;
    run.counters["signed_over_raw"] = quantile(signed_us, 0.5) / reference;
    run.counters["liblcm_over_raw"] = quantile(liblcm_us, 0.5) / reference;
  } catch (const std::exception& error) {
    run.SkipWithError(error.what());
  }
}
BENCHMARK(round_trip)->Iterations(5000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace gyrotwin
