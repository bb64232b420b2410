#include "services/gateway/server.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <list>
#include <utility>  // before Asio, which forgets it

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::use_awaitable;
using asio::ip::tcp;
using Socket = websocket::stream<beast::tcp_stream>;
using Question = http::request<http::empty_body>;

constexpr std::chrono::seconds kPatience{10};  // for a request, and for its answer to be taken
constexpr std::chrono::seconds kSocketPatience{20};  // for anything from a client, a pong at least
constexpr std::size_t kLongestHead = 8 << 10;        // [byte]
constexpr std::size_t kLongestMessage = 64 << 10;    // of a client [byte]
constexpr int kSendBuffer = 256 << 10;  // what a client that sleeps holds in the kernel [byte]
constexpr std::string_view kRecordings = "/recordings";

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

/// One WebSocket.
struct Session {
  explicit Session(beast::tcp_stream&& stream)
      : socket(std::move(stream)), wake(socket.get_executor()) {
    wake.expires_at(asio::steady_timer::time_point::max());
  }
  Socket socket;
  asio::steady_timer wake;   // of the writer
  Client* client = nullptr;  // null once it has gone
};

}  // namespace

class Server::Impl {
 public:
  Impl(asio::io_context& io, const Endpoint& endpoint, const Parts& parts)
      : parts_(parts), acceptor_(io) {
    boost::system::error_code failure;
    const auto address = asio::ip::make_address(endpoint.address, failure);
    const tcp::endpoint at(address, endpoint.port);
    if (!failure) acceptor_.open(at.protocol(), failure);
    if (!failure) acceptor_.set_option(tcp::acceptor::reuse_address(true), failure);
    if (!failure) acceptor_.bind(at, failure);
    if (!failure) acceptor_.listen(asio::socket_base::max_listen_connections, failure);
    if (failure) {
      throw Error("cannot listen on " + host_of(endpoint) + ": " + failure.message() +
                  "; --listen takes another ADDRESS:PORT");
    }
    asio::co_spawn(io, accept(), asio::detached);
  }

  void flush() {
    for (const auto& session : sessions_) {
      if (session->client == nullptr) continue;
      if (session->client->outbox.overfull()) beast::get_lowest_layer(session->socket).cancel();
      if (!session->client->outbox.empty()) session->wake.cancel();
    }
  }

  Endpoint endpoint() const {
    const tcp::endpoint at = acceptor_.local_endpoint();
    return {at.address().to_string(), at.port()};
  }
  std::string take_refusal() { return std::exchange(refusal_, {}); }
  const ServerCounters& counters() const { return counters_; }

 private:
  asio::awaitable<void> accept() {
    asio::steady_timer pause(acceptor_.get_executor());
    for (;;) {
      boost::system::error_code failure;
      tcp::socket socket =
          co_await acceptor_.async_accept(asio::redirect_error(use_awaitable, failure));
      if (failure) {
        // No descriptors left, most likely: others may go meanwhile.
        pause.expires_after(std::chrono::milliseconds(100));
        co_await pause.async_wait(asio::redirect_error(use_awaitable, failure));
        continue;
      }
      ++counters_.accepted;
      if (counters_.connections >= kMostConnections) {
        ++counters_.refused_busy;
        continue;  // closes it
      }
      ++counters_.connections;
      asio::co_spawn(acceptor_.get_executor(), converse(std::move(socket)), asio::detached);
    }
  }

  /// All that one connection says.
  asio::awaitable<void> converse(tcp::socket accepted) {
    try {
      accepted.set_option(asio::socket_base::send_buffer_size(kSendBuffer));
      accepted.set_option(tcp::no_delay(true));
      const bool from_loopback = accepted.remote_endpoint().address().is_loopback();
      beast::tcp_stream stream(std::move(accepted));
      beast::flat_buffer buffer(kLongestHead + kLongestMessage);
      for (bool more = true; more;) {
        http::request_parser<http::empty_body> parser;
        parser.header_limit(kLongestHead);
        parser.body_limit(0);
        stream.expires_after(kPatience);
        boost::system::error_code failure;
        co_await http::async_read(stream, buffer, parser,
                                  asio::redirect_error(use_awaitable, failure));
        if (failure) {
          if (parser.got_some()) ++counters_.refused_malformed;
          break;
        }
        const Question& question = parser.get();
        if (websocket::is_upgrade(question)) {
          co_await open_socket(std::move(stream), question, from_loopback);
          break;
        }
        more = co_await answer(stream, question, from_loopback);
      }
    } catch (const std::exception&) {
      // The other side has gone, or its patience or ours is over.
    }
    --counters_.connections;
  }

  Access::Verdict judge(const Question& question, bool from_loopback) {
    Caller caller{.from_loopback = from_loopback,
                  .host = view(question[http::field::host]),
                  .origin = {},
                  .target = view(question.target()),
                  .wants_socket = websocket::is_upgrade(question)};
    if (question.count(http::field::origin) > 0) {
      caller.origin = view(question[http::field::origin]);
    }
    Access::Verdict verdict = parts_.access.judge(caller);
    if (verdict.role == Role::kNobody) {
      ++counters_.refused_access;
      refusal_ = verdict.reason;
    }
    return verdict;
  }

  /// @return whether the connection goes on
  template <class Body>
  asio::awaitable<bool> send(beast::tcp_stream& stream, const Question& question,
                             http::response<Body> response) {
    response.set(http::field::server, "gyrotwin");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("X-Frame-Options", "DENY");
    response.set("Referrer-Policy", "no-referrer");
    response.set(
        "Content-Security-Policy",
        "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
        "connect-src 'self' ws: wss:; frame-ancestors 'none'");
    response.keep_alive(question.keep_alive());
    response.prepare_payload();
    stream.expires_after(kPatience);
    http::response_serializer<Body> serializer(response);
    if (question.method() == http::verb::head) {
      co_await http::async_write_header(stream, serializer, use_awaitable);
      co_return response.keep_alive();
    }
    // Patience is for each piece: a long recording takes as long as it takes.
    while (!serializer.is_done()) {
      stream.expires_after(kPatience);
      co_await http::async_write_some(stream, serializer, use_awaitable);
    }
    co_return response.keep_alive();
  }

  static http::response<http::string_body> text(const Question& question, http::status status,
                                                std::string body, std::string_view type) {
    http::response<http::string_body> response(status, question.version());
    response.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response.set(http::field::cache_control, "no-cache");
    response.body() = std::move(body);
    return response;
  }
  static http::response<http::string_body> plain(const Question& question, http::status status,
                                                 std::string body) {
    return text(question, status, std::move(body) + '\n', "text/plain; charset=utf-8");
  }

  asio::awaitable<bool> answer(beast::tcp_stream& stream, const Question& question,
                               bool from_loopback) {
    const std::string_view path = path_of(view(question.target()));
    if (question.method() != http::verb::get && question.method() != http::verb::head) {
      co_return co_await send(
          stream, question, plain(question, http::status::method_not_allowed, "GET and HEAD only"));
    }
    // The page is no secret; what it shows is.
    if (const PageFile* file = parts_.page.find(path)) {
      auto response = text(question, http::status::ok, file->content, file->type);
      if (file->lasts) response.set(http::field::cache_control, "max-age=31536000, immutable");
      co_return co_await send(stream, question, std::move(response));
    }
    const Access::Verdict verdict = judge(question, from_loopback);
    if (verdict.role == Role::kNobody) {
      co_return co_await send(stream, question,
                              plain(question, http::status::forbidden, verdict.reason));
    }
    if (path == "/metrics") {
      co_return co_await send(
          stream, question,
          text(question, http::status::ok, metrics_text(parts_.gateway, counters_, parts_.bus),
               "text/plain; version=0.0.4"));
    }
    if (path == kRecordings) {
      co_return co_await send(
          stream, question,
          text(question, http::status::ok, parts_.recorder.list().dump(), "application/json"));
    }
    if (path.starts_with(kRecordings) && path[kRecordings.size()] == '/') {
      const auto file = parts_.recorder.find(path.substr(kRecordings.size() + 1));
      if (!file.empty()) co_return co_await send_file(stream, question, file);
    }
    co_return co_await send(stream, question,
                            plain(question, http::status::not_found, "there is nothing here"));
  }

  asio::awaitable<bool> send_file(beast::tcp_stream& stream, const Question& question,
                                  const std::filesystem::path& file) {
    http::response<http::file_body> response(http::status::ok, question.version());
    boost::system::error_code failure;
    response.body().open(file.c_str(), beast::file_mode::scan, failure);
    if (failure) {
      co_return co_await send(stream, question,
                              plain(question, http::status::not_found, failure.message()));
    }
    response.set(http::field::content_type, "application/octet-stream");
    response.set(http::field::content_disposition,
                 "attachment; filename=\"" + file.filename().string() + '"');
    co_return co_await send(stream, question, std::move(response));
  }

  asio::awaitable<void> open_socket(beast::tcp_stream stream, const Question& question,
                                    bool from_loopback) {
    const Access::Verdict verdict = judge(question, from_loopback);
    const std::string protocol(
        foxglove::choose_subprotocol(view(question[http::field::sec_websocket_protocol])));
    if (verdict.role == Role::kNobody || protocol.empty()) {
      const std::string reason =
          verdict.role == Role::kNobody
              ? verdict.reason
              : "offer the subprotocol foxglove.sdk.v1 or foxglove.websocket.v1";
      co_await send(
          stream, question,
          plain(question,
                verdict.role == Role::kNobody ? http::status::forbidden : http::status::bad_request,
                reason));
      co_return;
    }
    stream.expires_never();  // the WebSocket has its own patience
    const auto session = std::make_shared<Session>(std::move(stream));
    Socket& socket = session->socket;
    socket.set_option(websocket::stream_base::timeout{
        .handshake_timeout = kPatience, .idle_timeout = kSocketPatience, .keep_alive_pings = true});
    socket.set_option(websocket::stream_base::decorator([&](websocket::response_type& response) {
      response.set(http::field::server, "gyrotwin");
      response.set(http::field::sec_websocket_protocol, protocol);
    }));
    socket.read_message_max(kLongestMessage);
    socket.auto_fragment(false);
    co_await socket.async_accept(question, use_awaitable);

    session->client = &parts_.gateway.join(verdict.role);
    const auto place = sessions_.insert(sessions_.end(), session);
    asio::co_spawn(acceptor_.get_executor(), write(session), asio::detached);
    try {
      co_await read(*session);
    } catch (const std::exception&) {
      // It has gone, or is sent away.
    }
    parts_.gateway.leave(*session->client);
    session->client = nullptr;
    session->wake.cancel();
    beast::get_lowest_layer(socket).cancel();
    sessions_.erase(place);
  }

  asio::awaitable<void> read(Session& session) {
    beast::flat_buffer buffer;
    for (;;) {
      co_await session.socket.async_read(buffer, use_awaitable);
      const auto* data = static_cast<const std::uint8_t*>(buffer.data().data());
      const std::size_t size = buffer.size();
      if (session.socket.got_text()) {
        parts_.gateway.on_text(*session.client, {reinterpret_cast<const char*>(data), size});
      } else {
        const std::int64_t now =
            std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
        parts_.gateway.on_binary(*session.client, {data, size}, now);
      }
      buffer.consume(size);
      flush();
    }
  }

  /// @param session kept while something of it is being sent
  asio::awaitable<void> write(std::shared_ptr<Session> session) {
    try {
      while (session->client != nullptr) {
        if (session->client->outbox.empty()) {
          boost::system::error_code woken;
          co_await session->wake.async_wait(asio::redirect_error(use_awaitable, woken));
          continue;
        }
        const Outgoing message = session->client->outbox.take();
        session->socket.text(message.is_text);
        const std::array<asio::const_buffer, 2> parts{
            asio::const_buffer(message.head.data(), message.head_size),
            message.body ? asio::const_buffer(message.body->data(), message.body->size())
                         : asio::const_buffer()};
        co_await session->socket.async_write(parts, use_awaitable);
      }
    } catch (const std::exception&) {
      beast::get_lowest_layer(session->socket).cancel();  // the reader ends as well
    }
  }

  Parts parts_;
  tcp::acceptor acceptor_;
  std::list<std::shared_ptr<Session>> sessions_;
  ServerCounters counters_;
  std::string refusal_;
};

Server::Server(asio::io_context& io, const Endpoint& endpoint, const Parts& parts)
    : impl_(std::make_unique<Impl>(io, endpoint, parts)) {}
Server::~Server() = default;
void Server::flush() { impl_->flush(); }
Endpoint Server::endpoint() const { return impl_->endpoint(); }
std::string Server::take_refusal() { return impl_->take_refusal(); }
const ServerCounters& Server::counters() const { return impl_->counters(); }

Endpoint parse_endpoint(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  Endpoint endpoint{.address = text.substr(0, colon), .port = 0};
  if (endpoint.address.starts_with('[') && endpoint.address.ends_with(']')) {
    endpoint.address = endpoint.address.substr(1, endpoint.address.size() - 2);
  }
  boost::system::error_code failure;
  asio::ip::make_address(endpoint.address, failure);
  const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
  int number = -1;
  if (!port.empty() && port.size() <= 5 &&
      port.find_first_not_of("0123456789") == std::string::npos) {
    number = std::stoi(port);
  }
  if (failure || number < 0 || number > UINT16_MAX) {
    throw Error("`" + text + "` is no ADDRESS:PORT; for example 127.0.0.1:8765 or 0.0.0.0:8765");
  }
  endpoint.port = static_cast<std::uint16_t>(number);
  return endpoint;
}

std::string host_of(const Endpoint& endpoint) {
  const bool is_v6 = endpoint.address.find(':') != std::string::npos;
  return (is_v6 ? '[' + endpoint.address + ']' : endpoint.address) + ':' +
         std::to_string(endpoint.port);
}

}  // namespace gyrotwin
