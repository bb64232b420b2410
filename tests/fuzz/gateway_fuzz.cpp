// Anything that comes over HTTP or a WebSocket: who may do what is judged as README.md of the
// gateway says, and clients' messages are answered, never believed. The input is a list of pieces,
// each a kind, two bytes of length and so many bytes.
#include <algorithm>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <vector>

#include "services/gateway/gateway.hpp"
#include "services/gateway/metrics.hpp"
#include "services/gateway/page.hpp"
#include "services/gateway/recorder.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/distinct.hpp"

namespace gyrotwin {
namespace {

using fuzz::Bytes;
using fuzz::require;

constexpr std::string_view kOrigin = "https://lab.example";
constexpr std::int64_t kTenth = 100'000'000;  // [ns]

std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// Handshakes.
class Door {
 public:
  /// A whole HTTP request, as the server reads it.
  void request(Bytes bytes) {
    namespace http = boost::beast::http;
    http::request_parser<http::empty_body> parser;
    parser.header_limit(8 << 10);
    parser.body_limit(0);
    boost::system::error_code failure;
    std::size_t used = 1;
    for (Bytes rest = bytes; used > 0 && !failure && !parser.is_done();) {
      used = parser.put(boost::asio::const_buffer(rest.data(), rest.size()), failure);
      rest = rest.subspan(std::min(used, rest.size()));
      if (rest.empty()) break;
    }
    if (!parser.is_header_done()) return;
    const auto& question = parser.get();
    Caller caller{.from_loopback = false,
                  .host = view(question[http::field::host]),
                  .origin = {},
                  .target = view(question.target()),
                  .wants_socket = boost::beast::websocket::is_upgrade(question)};
    if (question.count(http::field::origin) > 0)
      caller.origin = view(question[http::field::origin]);
    judge(caller);
    caller.from_loopback = true;
    judge(caller);
    document(caller.target);
    foxglove::choose_subprotocol(view(question[http::field::sec_websocket_protocol]));
  }

  /// A caller: flags, and host, origin and target, a line each.
  void caller(Bytes bytes) {
    if (bytes.empty()) return;
    const std::uint8_t flags = bytes[0];
    bytes = bytes.subspan(1);
    Caller caller{.from_loopback = (flags & 1) != 0,
                  .host = fuzz::text_of(fuzz::cut(bytes, '\n')),
                  .origin = {},
                  .target = {},
                  .wants_socket = (flags & 2) != 0};
    const std::string_view origin = fuzz::text_of(fuzz::cut(bytes, '\n'));
    if ((flags & 4) != 0) caller.origin = origin;
    caller.target = fuzz::text_of(bytes);
    judge(caller);
    document(caller.target);
    const std::string_view protocol = foxglove::choose_subprotocol(caller.target);
    require(protocol.empty() || caller.target.find(protocol) != std::string_view::npos);
  }

 private:
  /// The verdict is what README.md says, in other words.
  void judge(const Caller& caller) {
    for (const Access* access : {&strict_, &open_}) {
      const Access::Verdict verdict = access->judge(caller);
      const std::string token = query_value(caller.target, "token");
      require((verdict.role == Role::kNobody) == !verdict.reason.empty());
      if (verdict.role == Role::kNobody) continue;
      require(token.empty() || token == tokens_.observer || token == tokens_.operator_);
      require((verdict.role == Role::kOperator) == (token == tokens_.operator_));
      require(caller.from_loopback || !token.empty());
      require(!caller.from_loopback || caller.host.starts_with("localhost") ||
              caller.host.starts_with("127.0.0.1") || caller.host.starts_with("[::1]"));
      if (caller.origin) {
        require(*caller.origin == kOrigin ||
                *caller.origin == "http://" + std::string(caller.host));
      } else {
        require(caller.from_loopback || !caller.wants_socket || access == &open_);
      }
    }
  }

  void document(std::string_view target) const {
    const std::string_view path = target.substr(0, target.find('?'));
    require(page_.find(path) == nullptr || path == "/");
    constexpr std::string_view kRecordings = "/recordings/";
    if (path.starts_with(kRecordings)) {
      require(recorder_.find(path.substr(kRecordings.size())).empty());  // there are none
    }
  }

  const Tokens tokens_{.observer = "look", .operator_ = "act"};
  const Access strict_{tokens_, {std::string(kOrigin)}, false};
  const Access open_{tokens_, {std::string(kOrigin)}, true};
  const Page page_{"/nowhere"};
  const Recorder recorder_{"r", "/", {}};
};

/// An operator and an observer at one gateway, which is expensive to make.
class Bench {
 public:
  void begin() {
    operator_ = &gateway_.join(Role::kOperator);
    observer_ = &gateway_.join(Role::kObserver);
    drain(*operator_, 2);
    drain(*observer_, 2);
  }

  void end() {
    gateway_.leave(*operator_);
    gateway_.leave(*observer_);
    require(gateway_.clients().empty());
    // The owner is forgotten, and so is what it has not answered.
    for (int i = 0; i <= kMostAsks + 1; ++i) {
      now_ += 30 * kTenth;
      gateway_.on_timer(now_, wall());
    }
    gateway_.on_recording({{"on", false}});
  }

  void piece(int kind, Bytes bytes) {
    const std::size_t sent = sent_, wished = wished_;
    Client& client = kind % 2 == 0 ? *operator_ : *observer_;
    now_ += 1'000'000;
    switch (kind) {
      case 0:
      case 1:
        gateway_.on_text(client, fuzz::text_of(bytes));
        break;
      case 2:
      case 3:
        gateway_.on_binary(client, bytes, now_);
        break;
      case 4:
      case 5:
        publish(client, bytes);
        break;
      case 6:
      case 7:
        hear(bytes);
        break;
      case 8:
        now_ += kTenth * (bytes.empty() ? 1 : bytes[0]);
        gateway_.on_timer(now_, wall());
        break;
      default:
        door_.caller(bytes);
        break;
    }
    // Who only looks moves nothing.
    if (kind < 6 && &client == observer_) require(sent_ == sent && wished_ == wished);
    for (Client* each : {operator_, observer_}) check(*each);
  }

  Door& door() { return door_; }

 private:
  std::uint64_t wall() const {
    return 1'700'000'000'000'000'000u + static_cast<std::uint64_t>(now_);
  }

  /// A request, on a channel that has been advertised.
  void publish(Client& client, Bytes json) {
    gateway_.on_text(client,
                     R"({"op":"advertise","channels":[{"id":9,"topic":"PROTOTYPE_B/REQUEST",)"
                     R"("encoding":"json","schemaName":"x"}]})");
    std::vector<std::uint8_t> bytes{1, 9, 0, 0, 0};
    bytes.insert(bytes.end(), json.begin(), json.end());
    gateway_.on_binary(client, bytes, now_);
  }

  /// A message of the bus, which has seen to its size: channel, place, and what stands there.
  void hear(Bytes bytes) {
    if (bytes.empty()) return;
    const Channel channel = kChannels[bytes[0] % kChannels.size()].channel;
    std::vector<std::uint8_t> payload = distinct_payload(channel, 1);
    if (bytes.size() > 2) {
      const std::size_t at = 8 + bytes[1] * 4 % (payload.size() - 8);
      const Bytes patch = bytes.subspan(2, std::min(bytes.size() - 2, payload.size() - at));
      std::ranges::copy(patch, payload.begin() + static_cast<std::ptrdiff_t>(at));
    }
    gateway_.on_reception({channel, false, payload}, now_, wall());
  }

  void drain(Client& client, int greetings) {
    for (int i = 0; !client.outbox.empty(); ++i) {
      const Outgoing message = client.outbox.take();
      require(message.body != nullptr || message.head_size > 0);
      if (message.is_text && i >= greetings) {
        require(foxglove::Json::accept(message.body->begin(), message.body->end()));
      }
    }
  }

  void check(Client& client) {
    require(client.subscriptions.size() <= Client::kMostEntries);
    require(client.publications.size() <= Client::kMostEntries);
    require(client.role == Role::kOperator || client.publications.empty());
    std::size_t watched = 0;
    for (const std::string& name : client.watched) watched += name.size();
    require(watched <= 64 << 10);
    require(client.outbox.size() <= 2 * Outbox::kRoom + (256 << 10));
    drain(client, 0);
  }

  const Rig rig_ = load_rig("prototype_b");
  std::size_t sent_ = 0, wished_ = 0;
  std::int64_t now_ = 0;
  Gateway gateway_{rig_, "[rig]\nname = \"r\"\n[loop]\nrate_hz = 1000.0\n",
                   [this](const request_t&, std::int64_t) { ++sent_; },
                   [this](bool on) {
                     ++wished_;
                     return foxglove::Json{{"on", on}};
                   }};
  Client *operator_ = nullptr, *observer_ = nullptr;
  Door door_;
};

}  // namespace
}  // namespace gyrotwin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gyrotwin;  // NOLINT(google-build-using-namespace)
  static Bench bench;
  fuzz::Bytes rest(data, size);
  // What does not begin with a kind is a request over HTTP: kinds are no letters.
  if (size > 0 && data[0] >= 'A') {
    bench.door().request(rest);
    return 0;
  }
  bench.begin();
  while (rest.size() >= 3) {
    const std::size_t length = std::min<std::size_t>(rest[1] + 256u * rest[2], rest.size() - 3);
    bench.piece(rest[0] % 10, rest.subspan(3, length));
    rest = rest.subspan(3 + length);
  }
  bench.end();
  return 0;
}
