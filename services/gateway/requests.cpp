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
  const bool urgent = request.verb == request_t::DISARM && waiting_.size() > 1;
  waiting_.insert(urgent ? waiting_.begin() + 1 : waiting_.end(), request);
  if (waiting_.size() == 1) {
    ++sequence_;
    send(now_ns);
  }
  return true;
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
  tries_ = 0;
  return false;
}

void Requests::on_reply(const reply_t& reply, std::int64_t now_ns) {
  if (waiting_.empty() || waiting_.front().writer != reply.request_writer ||
      waiting_.front().counter != reply.request_counter) {
    return;
  }
  waiting_.pop_front();
  tries_ = 0;
  if (waiting_.empty()) return;
  ++sequence_;
  send(now_ns);
}

}  // namespace gyrotwin
