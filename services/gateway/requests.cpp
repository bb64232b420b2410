#include "services/gateway/requests.hpp"

#include <utility>

#include "services/runtime/key.hpp"

namespace gyrotwin {

Requests::Requests(Send send) : send_(std::move(send)), writer_(random_id()) {}

bool Requests::ask(request_t request, std::int64_t now_ns) {
  if (waiting_.size() >= kMost) return false;
  if (request.writer == 0) {
    request.writer = writer_;
    request.counter = ++counter_;
  }
  waiting_.push_back(request);
  if (waiting_.size() == 1) begin(now_ns);
  return true;
}

std::size_t Requests::forget() {
  return std::erase_if(waiting_, [](const request_t& r) { return r.verb != request_t::DISARM; });
}

/// Sends the first for the first time.
void Requests::begin(std::int64_t now_ns) {
  ++sequence_;
  tries_ = 0;
  send(now_ns);
}

void Requests::send(std::int64_t now_ns) {
  sent_ns_ = now_ns;
  ++tries_;
  send_(waiting_.front(), sequence_);
}

bool Requests::on_timer(std::int64_t now_ns) {
  if (waiting_.empty() || now_ns - sent_ns_ < kAskAgain) return true;
  if (tries_ < kMostAsks) {
    send(now_ns);
    return true;
  }
  waiting_.clear();
  return false;
}

void Requests::on_reply(const reply_t& reply, std::int64_t now_ns) {
  if (waiting_.empty() || waiting_.front().writer != reply.request_writer ||
      waiting_.front().counter != reply.request_counter) {
    return;
  }
  waiting_.pop_front();
  if (!waiting_.empty()) begin(now_ns);
}

}  // namespace gyrotwin
