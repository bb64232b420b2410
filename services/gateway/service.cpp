#include "services/gateway/service.hpp"

#include <unistd.h>

#include <array>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <exception>
#include <utility>  // before Asio, which forgets it

#include "services/runtime/clock.hpp"
#include "services/runtime/key.hpp"
#include "services/runtime/rig_bus.hpp"
#include "services/runtime/show_status.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

namespace asio = boost::asio;
using asio::use_awaitable;

constexpr std::chrono::milliseconds kPeriod{100};  // of STATUS and of all that is looked after
constexpr int kTurn = 64;  // messages on end, before clients have their turn
constexpr std::int64_t kPatience = 1'000'000'000;  // for the owner's STATUS [ns]

class Loop {
 public:
  Loop(const Rig& rig, const GatewayOptions& options, const Tokens& tokens, Bus& bus, Clock& clock,
       Daemon& daemon)
      : rig_(rig),
        bus_(bus),
        clock_(clock),
        daemon_(daemon),
        epoch_(random_id()),
        access_(tokens, options.origins, options.any_program),
        page_(options.page),
        recorder_(rig.name, options.recordings, options.rig_arguments),
        gateway_(
            rig, options.rig_text,
            [this](request_t request, std::int64_t sequence) { ask(request, sequence); },
            [this](bool on) { return recorder_.wish(on); }),
        // The bus's own, as report() brings them up to date.
        server_(io_, options.endpoint, {gateway_, access_, page_, recorder_, bus.counters()}),
        ear_(io_, dup(bus.descriptor())) {}

  void run() {
    // Without a token: a log has other readers than a key.
    daemon_.log(LogLevel::kInfo,
                "shows rig {}, {}, on http://{}/; `gyrotwin gateway --urls` prints "
                "whole addresses",
                rig_.name, reach(rig_), host_of(server_.endpoint()));
    const auto pass_on = [](const std::exception_ptr& failure) {
      if (failure) std::rethrow_exception(failure);
    };
    asio::co_spawn(io_, hear(), pass_on);
    asio::co_spawn(io_, look_after(), pass_on);
    io_.run();
  }

 private:
  asio::awaitable<void> hear() {
    for (;;) {
      co_await ear_.async_wait(asio::posix::stream_descriptor::wait_read, use_awaitable);
      int heard = 0;
      while (const auto reception = bus_.receive()) {
        if (is_owner_status(reception->channel)) owner_heard_ = clock_.now_ns();
        gateway_.on_reception(*reception, clock_.now_ns(), wall_ns());
        if (++heard % kTurn != 0) continue;
        server_.flush();
        co_await asio::post(io_, use_awaitable);
      }
      server_.flush();
    }
  }

  asio::awaitable<void> look_after() {
    asio::steady_timer timer(io_);
    for (;;) {
      timer.expires_after(kPeriod);
      co_await timer.async_wait(use_awaitable);
      if (!daemon_.next_round()) break;
      gateway_.on_recording(recorder_.look());
      gateway_.on_timer(clock_.now_ns(), wall_ns());
      server_.flush();
      const std::string refusal = server_.take_refusal();
      if (!refusal.empty()) daemon_.log(LogLevel::kWarning, "somebody was refused: {}", refusal);
      report();
    }
    io_.stop();
  }

  void ask(request_t& request, std::int64_t sequence) {
    bus_.send(Channel::kRequest, request,
              {epoch_, sequence, request.header.tick, request.header.sim_time_ns});
  }

  void report() {
    status_t status{};
    status.service = status_t::GATEWAY;
    const bool heard = owner_heard_ >= 0 && clock_.now_ns() - owner_heard_ < kPatience;
    status.mode = status_t::MODE_WAITING;
    if (heard) status.mode = status_t::MODE_ACTIVE;
    if (heard) {
      set_text(status.text, "{} clients", gateway_.clients().size());
    } else {
      set_text(status.text, "no owner of the rig is heard");
    }
    fill_process(status, identity_, bus_.counters());
    show_status(daemon_, status);
    bus_.send(Channel::kGatewayStatus, status, {epoch_, ++status_sequence_, 0, 0});
    // Nobody hears himself on the bus.
    std::array<std::uint8_t, kWireSize<status_t>> payload{};
    status.encode(payload.data(), 0, static_cast<int>(payload.size()));
    gateway_.on_reception({Channel::kGatewayStatus, false, payload}, clock_.now_ns(), wall_ns());
  }

  const Rig& rig_;
  Bus& bus_;
  Clock& clock_;
  Daemon& daemon_;
  std::int64_t epoch_, status_sequence_ = 0, owner_heard_ = -1;
  Identity identity_;
  asio::io_context io_{1};
  Access access_;
  Page page_;
  Recorder recorder_;
  Gateway gateway_;
  Server server_;
  asio::posix::stream_descriptor ear_;
};

}  // namespace

void run_gateway(const Rig& rig, const GatewayOptions& options, const Tokens& tokens, Bus& bus,
                 Clock& clock, Daemon& daemon) {
  Loop(rig, options, tokens, bus, clock, daemon).run();
}

std::string url(const Endpoint& endpoint, const std::string& token) {
  Endpoint shown = endpoint;
  if (shown.address == "0.0.0.0" || shown.address == "::") {
    char host[64] = {};
    gethostname(host, sizeof host - 1);
    shown.address = host;
  }
  return "http://" + host_of(shown) + "/?token=" + token;
}

}  // namespace gyrotwin
