#include "clients/top/monitor.hpp"

#include <algorithm>
#include <utility>

#include "clients/common/request_words.hpp"
#include "clients/common/status_words.hpp"
#include "clients/common/time_text.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kRequests = 128;             // that may wait for their answer to be heard
constexpr std::int64_t kSampleNs = 100'000'000;    // between two looks at the counters
constexpr std::int64_t kPauseNs = kSilenceNs / 2;  // is no mere hiccup

template <class T>
void keep(std::deque<T>& last, T value, std::size_t most) {
  last.push_back(std::move(value));
  if (last.size() > most) last.pop_front();
}

bool same_process(const status_t& a, const status_t& b) {
  return a.pid == b.pid && text_view(a.host) == text_view(b.host);
}

std::string because(const status_t& status) {
  const std::string why = get_text(status.text);
  return why.empty() ? "" : fmt::format(": {}", why);
}

Level gravity(std::int32_t mode) {
  switch (mode) {
    case status_t::MODE_RUNNING:
    case status_t::MODE_ACTIVE:
      return Level::kGood;
    case status_t::MODE_SAFE_STOP:
      return Level::kWarning;
    case status_t::MODE_FALLEN:
    case status_t::MODE_FAULT:
      return Level::kBad;
    default:
      return Level::kInfo;
  }
}

}  // namespace

void Monitor::hear(const Reception& reception, const Moment& now) {
  heard_at_[static_cast<std::size_t>(reception.channel)] = now.mono_ns;
  const auto decoded = [&reception]<class Message>(Message message) {
    Bus::decode(reception, message);
    return message;
  };
  switch (reception.channel) {
    case Channel::kState: {
      const auto state = decoded(state_t{});
      if (of_this_run(state.header)) state_ = {state, now.mono_ns};
      break;
    }
    case Channel::kTruth: {
      const auto truth = decoded(truth_t{});
      if (of_this_run(truth.header)) truth_ = {truth, now.mono_ns};
      break;
    }
    case Channel::kCommand:
      command_ = decoded(command_t{});
      break;
    case Channel::kRequest:
      keep(requests_, decoded(request_t{}), kRequests);
      break;
    case Channel::kReply:
      on_reply(decoded(reply_t{}), now);
      break;
    case Channel::kIntegratorStatus:
    case Channel::kHardwareStatus:
      on_status(owner_, decoded(status_t{}), now);
      break;
    case Channel::kControllerStatus:
      on_status(controller_, decoded(status_t{}), now);
      break;
    case Channel::kMirrorStatus:
      on_status(mirror_, decoded(status_t{}), now);
      break;
    case Channel::kHealth:
      on_health(decoded(health_t{}), now);
      break;
    case Channel::kForecast:
      on_forecast(decoded(forecast_t{}), now);
      break;
    case Channel::kLink:
      on_link(decoded(link_t{}), now);
      break;
    case Channel::kSensors:
    case Channel::kTwinState:
    case Channel::kGatewayStatus:
      break;  // their traffic is counted
  }
}

/// Whether the owner that is followed says this; without one, whoever says it.
bool Monitor::of_this_run(const header_t& header) const {
  return !owner_.alive || owner_.status->message.header.epoch == header.epoch;
}

/// Whether a second daemon speaks on the channel, which says so once until it falls silent.
bool Monitor::is_rival(Followed& peer, const status_t& status, const Moment& now) {
  const bool followed = peer.alive && now.mono_ns - peer.status->at_ns < kPauseNs;
  if (!followed || same_process(peer.status->message, status)) return false;
  const bool news = !peer.rival_at_ns || now.mono_ns - *peer.rival_at_ns > kSilenceNs;
  peer.rival_at_ns = now.mono_ns;
  if (news) {
    happen(now, Level::kBad, peer.name, "another one speaks too: " + process_text(status));
  }
  return true;
}

void Monitor::on_status(Followed& peer, const status_t& status, const Moment& now) {
  if (is_rival(peer, status, now)) return;
  const std::optional<Kept<status_t>> before = std::exchange(peer.status, {{status, now.mono_ns}});
  const bool was_alive = std::exchange(peer.alive, true);
  const std::string mode(mode_name(status.mode));
  if (!before) {
    return happen(now, gravity(status.mode), peer.name,
                  fmt::format("heard: {}, {}{}", process_text(status), mode, because(status)));
  }
  if (!same_process(before->message, status)) {
    return happen(now, Level::kWarning, peer.name,
                  fmt::format("is {} now, before it was {}; {}{}", process_text(status),
                              process_text(before->message), mode, because(status)));
  }
  if (!was_alive) {
    happen(now, gravity(status.mode), peer.name,
           fmt::format("heard again after {}, {}{}", time_text_ns(now.mono_ns - before->at_ns),
                       mode, because(status)));
  } else if (before->message.mode != status.mode) {
    happen(now, gravity(status.mode), peer.name,
           fmt::format("{} -> {}{}", mode_name(before->message.mode), mode, because(status)));
  }
  // A controller's epoch follows its owner's.
  if (&peer == &owner_ && before->message.header.epoch != status.header.epoch) {
    happen(now, Level::kInfo, peer.name, "a new run begins, ticks count from 0");
  }
}

void Monitor::on_health(const health_t& health, const Moment& now) {
  if (!of_this_run(health.header)) return;
  const std::optional<Kept<health_t>> before = std::exchange(health_, {{health, now.mono_ns}});
  const health_t was = before ? before->message : health_t{};
  if (was.verdict == health.verdict && was.blame == health.blame &&
      was.blamed_index == health.blamed_index) {
    return;
  }
  Level level = Level::kInfo;
  if (health.verdict == health_t::AGREES) level = Level::kGood;
  if (health.verdict == health_t::DISAGREES) level = Level::kBad;
  happen(now, level, "twin", verdict_text(health));
}

void Monitor::on_forecast(const forecast_t& forecast, const Moment& now) {
  if (!of_this_run(forecast.header)) return;
  const std::optional<Kept<forecast_t>> before =
      std::exchange(forecast_, {{forecast, now.mono_ns}});
  const bool falls = forecast.outcome == forecast_t::FALLS;
  const bool fell = before && before->message.outcome == forecast_t::FALLS;
  if (falls == fell) return;
  happen(now, falls ? Level::kBad : Level::kGood, "forecast",
         falls ? fmt::format("it falls in {}", time_text_ns(forecast.falls_in_ns)) : "it stands");
}

void Monitor::on_link(const link_t& link, const Moment& now) {
  if (!of_this_run(link.header)) return;
  const std::optional<Kept<link_t>> before = std::exchange(link_, {{link, now.mono_ns}});
  if (before && (before->message.connected != 0) == (link.connected != 0)) return;
  const bool connected = link.connected != 0;
  happen(now, connected ? Level::kGood : Level::kWarning, "line",
         fmt::format("the device is {} on {}", connected ? "heard" : "not heard",
                     get_text(link.text)));
}

void Monitor::on_reply(const reply_t& reply, const Moment& now) {
  const RequestId id{reply.request_writer, reply.request_counter};
  if (std::ranges::find(answered_, id) != answered_.end()) return;
  keep(answered_, id, kRequests);
  const request_t* request = request_of(reply);
  const bool event = reply.verb == request_t::DISTURB || reply.verb == request_t::FAULT;
  const std::string what =
      event && request != nullptr ? fmt::format(" {}", describe(*request)) : "";
  if (reply.result != reply_t::APPLIED) {
    return happen(
        now, Level::kWarning, "reply",
        fmt::format("{}{} refused: {}", verb_name(reply.verb), what, get_text(reply.text)));
  }
  schedule(reply, request);
  // An event's text names its ticks.
  const std::string when = event ? "" : fmt::format(" at tick {}", reply.applied_tick);
  happen(
      now, Level::kInfo, "reply",
      fmt::format("{}{} applied{}: {}", verb_name(reply.verb), what, when, get_text(reply.text)));
}

const request_t* Monitor::request_of(const reply_t& reply) const {
  const auto asked = [&reply](const request_t& r) {
    return r.writer == reply.request_writer && r.counter == reply.request_counter;
  };
  const auto found = std::ranges::find_if(requests_, asked);
  return found == requests_.end() ? nullptr : &*found;
}

/// Keeps the list of what acts in step with what the owner did.
void Monitor::schedule(const reply_t& reply, const request_t* request) {
  switch (reply.verb) {
    case request_t::DISTURB:
    case request_t::FAULT: {
      if (request == nullptr) return;
      Acting acting{.epoch = reply.header.epoch,
                    .id = reply.id,
                    .fault = reply.verb == request_t::FAULT,
                    .what = describe(*request),
                    .begin = reply.applied_tick,
                    .end = {}};
      if (request->duration_ns > 0 && owner_.status) {
        const std::int64_t tick_ns =
            std::max<std::int64_t>(owner_.status->message.tick_period_ns, 1);
        acting.end = acting.begin +
                     std::max<std::int64_t>(1, (request->duration_ns + tick_ns / 2) / tick_ns);
      }
      return acting_.push_back(std::move(acting));
    }
    case request_t::CANCEL:
      if (request == nullptr) return;
      std::erase_if(acting_, [request](const Acting& a) { return a.id == request->id; });
      return;
    case request_t::CLEAR:
    case request_t::RESET:
      return acting_.clear();
    default:
      return;
  }
}

std::optional<header_t> Monitor::latest() const {
  if (!owner_.status) return state_ ? std::optional(state_->message.header) : std::nullopt;
  const header_t& said = owner_.status->message.header;
  const bool state_is_newer = state_ && state_->message.header.epoch == said.epoch &&
                              state_->message.header.tick > said.tick;
  return state_is_newer ? state_->message.header : said;
}

void Monitor::forget_what_is_over() {
  const auto now = latest();
  if (!now) return;
  std::erase_if(acting_, [&now](const Acting& a) {
    return a.epoch != now->epoch || (a.end && *a.end <= now->tick);
  });
}

void Monitor::look(const Moment& now, const BusCounters& bus) {
  bus_ = bus;
  for (Followed* peer : {&owner_, &controller_, &mirror_}) {
    if (!peer->alive || now.mono_ns - peer->status->at_ns < kSilenceNs) continue;
    peer->alive = false;
    happen(now, Level::kBad, peer->name,
           fmt::format("not heard for {}; it was {}, {}",
                       time_text_ns(now.mono_ns - peer->status->at_ns),
                       process_text(peer->status->message), mode_name(peer->status->message.mode)));
  }
  forget_what_is_over();
  measure(now);
}

void Monitor::measure(const Moment& now) {
  const std::int64_t since = samples_.empty() ? kSilenceNs : now.mono_ns - samples_.back().at_ns;
  if (since < kSampleNs) return;
  // Whoever was suspended finds all that has come meanwhile at once.
  if (since >= kPauseNs) samples_.clear();
  Sample& sample = samples_.emplace_back(Sample{now.mono_ns, {}, 0, 0});
  std::copy_n(bus_.received.begin(), sample.received.size(), sample.received.begin());
  if (const auto header = latest()) {
    sample.epoch = header->epoch;
    sample.sim_time_ns = header->sim_time_ns;
  }
  while (samples_.size() > 2 && now.mono_ns - samples_[1].at_ns >= kSilenceNs) {
    samples_.pop_front();
  }
}

Picture Monitor::picture(const Moment& now) const {
  Picture picture;
  picture.utc_ns = now.utc_ns;
  if (owner_.status) picture.owner = owner_.status->at(now);
  if (controller_.status) picture.controller = controller_.status->at(now);
  if (mirror_.status) picture.mirror = mirror_.status->at(now);
  if (health_) picture.health = health_->at(now);
  if (forecast_) picture.forecast = forecast_->at(now);
  if (link_) picture.link = link_->at(now);
  if (state_) picture.state = state_->at(now);
  if (truth_) picture.truth = truth_->at(now);
  picture.latest = latest();
  picture.command = command_;
  picture.bus = bus_;
  picture.acting = acting_;
  picture.happenings = happenings_;
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    ChannelTraffic& traffic = picture.channels[i];
    traffic = {.per_second = 0.0,
               .received = bus_.received[i],
               .gaps = bus_.gaps[i],
               .repeats = bus_.repeats[i],
               .reordered = bus_.reordered[i],
               .age_ns = {}};
    if (heard_at_[i]) traffic.age_ns = now.mono_ns - *heard_at_[i];
  }
  if (samples_.size() < 2) return picture;
  const Sample &from = samples_.front(), &to = samples_.back();
  const double span_ns = static_cast<double>(to.at_ns - from.at_ns);
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    picture.channels[i].per_second =
        1e9 * static_cast<double>(to.received[i] - from.received[i]) / span_ns;
  }
  if (from.epoch == to.epoch && picture.owner_live()) {
    picture.speed = static_cast<double>(to.sim_time_ns - from.sim_time_ns) / span_ns;
  }
  return picture;
}

void Monitor::happen(const Moment& now, Level level, std::string who, std::string what) {
  keep(happenings_, Happening{++happened_, now.utc_ns, level, std::move(who), std::move(what)},
       kHappenings);
}

}  // namespace gyrotwin
