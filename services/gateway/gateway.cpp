#include "services/gateway/gateway.hpp"

#include <algorithm>
#include <utility>

#include "services/runtime/error.hpp"
#include "services/runtime/key.hpp"
#include "services/schema/lcm_json.hpp"

namespace gyrotwin {

using foxglove::Level;

namespace {

constexpr std::int64_t kSilence = 2'000'000'000;  // without STATUS [ns]
constexpr int kDeepest = 8;                       // arrays and objects in each other
constexpr std::size_t kRequest = static_cast<std::size_t>(Channel::kRequest);

/// @throws Error, or JSON's own, naming the place
template <class Json>
Json parsed(std::string_view text) {
  return Json::parse(text, [](int depth, auto, auto&) {
    if (depth > kDeepest) throw Error("JSON with more than 8 levels");
    return true;
  });
}

std::size_t index_of(Channel channel) { return static_cast<std::size_t>(channel); }

/// The array that a message must have under this name.
const foxglove::Json& array_at(const foxglove::Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_array()) {
    throw Error(json.value("op", "") + ": expected an array `" + name + "`");
  }
  if (found->size() > Client::kMostEntries) {
    throw Error(json.value("op", "") + ": more than " + std::to_string(Client::kMostEntries) +
                " entries in `" + name + "`");
  }
  return *found;
}

std::uint32_t number_of(const foxglove::Json& json, std::string_view what) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > UINT32_MAX) {
    throw Error(std::string(what) + ": expected a number from 0 to 2^32 - 1");
  }
  return json.get<std::uint32_t>();
}

std::uint32_t number_at(const foxglove::Json& json, const char* name) {
  return number_of(json.at(name), name);
}

std::string question_of(const foxglove::Json& json) {
  const auto id = json.find("id");
  return id != json.end() && id->is_string() ? id->get<std::string>() : std::string();
}

}  // namespace

Gateway::Gateway(const Rig& rig, std::string_view rig_text, Requests::Send send, RecordWish record)
    : rig_(rig),
      types_(lcm_sources()),
      session_(std::to_string(random_id())),
      parameters_(rig_text),
      requests_([this, send = std::move(send)](request_t request, std::int64_t sequence) {
        address(request);
        send(request, sequence);
      }),
      record_(std::move(record)) {
  std::vector<foxglove::Advertised> offered;
  for (const ChannelSpec& channel : kChannels) {
    const Ros2Message& encoder = encoders_.emplace_back(*types_.find(channel.type));
    offered.push_back({.id = static_cast<std::uint32_t>(channel.channel),
                       .topic = rig.network.prefix + '/' + std::string(channel.suffix),
                       .schema_name = encoder.name(),
                       .schema = encoder.definition()});
  }
  advertisement_ = foxglove::advertise(offered);
}

Client& Gateway::join(Role role) {
  Client& client = clients_.emplace_back();
  client.role = role;
  client.outbox.put_text(foxglove::server_info("gyrotwin " + rig_.name, session_,
                                               {{"rig", rig_.name},
                                                {"prefix", rig_.network.prefix},
                                                {"role", std::string(role_name(role))}}));
  client.outbox.put_text(advertisement_);
  return client;
}

void Gateway::leave(Client& client) {
  for (const auto& [id, channel] : client.subscriptions) --subscribers_[index_of(channel)];
  counters_.messages_left_out += client.outbox.dropped();
  clients_.remove_if([&](const Client& other) { return &other == &client; });
}

void Gateway::complain(Client& client, std::string_view text) {
  ++counters_.client_errors;
  client.outbox.put_text(foxglove::status(Level::kError, text));
}

void Gateway::tell_operators(Level level, const std::string& text) {
  for (Client& client : clients_) {
    if (client.role == Role::kOperator) client.outbox.put_text(foxglove::status(level, text));
  }
}

void Gateway::on_text(Client& client, std::string_view text) {
  try {
    const Json json = parsed<Json>(text);
    if (!json.is_object()) throw Error("expected a JSON object with `op`");
    act(client, json);
  } catch (const std::exception& error) {  // JSON's own as well
    complain(client, error.what());
  }
}

void Gateway::act(Client& client, const Json& json) {
  const std::string op = json.value("op", "");
  if (op == "subscribe") return subscribe(client, json);
  if (op == "unsubscribe") return unsubscribe(client, json);
  if (op == "advertise") return advertise(client, json);
  if (op == "unadvertise") return unadvertise(client, json);
  if (op == "getParameters") return get_parameters(client, json);
  if (op == "setParameters") return set_parameters(client, json);
  if (op == "subscribeParameterUpdates") return watch_parameters(client, json, true);
  if (op == "unsubscribeParameterUpdates") return watch_parameters(client, json, false);
  throw Error('`' + op + "` is no operation that this server knows");
}

void Gateway::subscribe(Client& client, const Json& json) {
  for (const Json& entry : array_at(json, "subscriptions")) {
    const std::uint32_t id = number_at(entry, "id");
    const std::uint32_t channel = number_at(entry, "channelId");
    if (channel >= kChannels.size()) {
      throw Error("subscribe: there is no channel " + std::to_string(channel));
    }
    if (client.subscriptions.size() >= Client::kMostEntries) {
      throw Error("subscribe: too many subscriptions");
    }
    if (!client.subscriptions.try_emplace(id, kChannels[channel].channel).second) {
      throw Error("subscribe: subscription " + std::to_string(id) + " exists already");
    }
    ++subscribers_[channel];
  }
}

void Gateway::unsubscribe(Client& client, const Json& json) {
  for (const Json& entry : array_at(json, "subscriptionIds")) {
    const auto found = client.subscriptions.find(number_of(entry, "subscriptionIds"));
    if (found == client.subscriptions.end()) throw Error("unsubscribe: no such subscription");
    --subscribers_[index_of(found->second)];
    client.subscriptions.erase(found);
  }
}

void Gateway::advertise(Client& client, const Json& json) {
  const std::string topic = rig_.network.prefix + '/' + std::string(kChannels[kRequest].suffix);
  for (const Json& entry : array_at(json, "channels")) {
    const std::uint32_t id = number_at(entry, "id");
    const std::string wanted = entry.value("topic", "");
    if (wanted != topic) {
      throw Error("advertise: `" + wanted + "` cannot be published, only `" + topic + '`');
    }
    if (entry.value("encoding", "") != "json") {
      throw Error("advertise: `" + topic + "` takes the encoding `json`");
    }
    if (client.role != Role::kOperator) {
      ++counters_.requests_denied;
      throw Error(
          "advertise: only an operator may ask for something: `gyrotwin gateway --urls` "
          "prints the address with the operator's token");
    }
    if (client.publications.size() >= Client::kMostEntries) {
      throw Error("advertise: too many channels");
    }
    client.publications.insert_or_assign(id, wanted);
  }
}

void Gateway::unadvertise(Client& client, const Json& json) {
  for (const Json& entry : array_at(json, "channelIds")) {
    client.publications.erase(number_of(entry, "channelIds"));
  }
}

void Gateway::get_parameters(Client& client, const Json& json) {
  const Json& names = array_at(json, "parameterNames");
  client.outbox.put_text(foxglove::parameter_values(parameters_.pick(names), question_of(json)));
}

void Gateway::set_parameters(Client& client, const Json& json) {
  for (const Json& entry : array_at(json, "parameters")) {
    const std::string name = entry.value("name", "");
    if (name != Parameters::kRecording) {
      throw Error(parameters_.has(name) ? "setParameters: `" + name +
                                              "` stands in the rig file: change it there and "
                                              "start the daemons again"
                                        : "setParameters: there is no parameter `" + name + '`');
    }
    if (client.role != Role::kOperator) {
      ++counters_.requests_denied;
      throw Error("setParameters: only an operator may record");
    }
    const auto value = entry.find("value");
    if (value == entry.end() || !value->is_boolean()) {
      throw Error("setParameters: `recording` takes true or false");
    }
    on_recording(record_(value->get<bool>()));
  }
  const std::string question = question_of(json);
  if (question.empty()) return;
  client.outbox.put_text(
      foxglove::parameter_values(parameters_.pick({Parameters::kRecording}), question));
}

void Gateway::watch_parameters(Client& client, const Json& json, bool watch) {
  const Json& names = array_at(json, "parameterNames");
  if (names.empty()) {
    client.watches_all = watch;
    if (!watch) client.watched.clear();
  }
  for (const Json& name : names) {
    if (!watch) {
      client.watched.erase(name.get<std::string>());
    } else if (parameters_.has(name.get<std::string>())) {
      client.watched.insert(name.get<std::string>());
    }
  }
}

void Gateway::on_recording(const Json& recording) {
  if (recording == parameters_.recording()) return;
  parameters_.set_recording(recording);
  const std::string text =
      foxglove::parameter_values({{std::string(Parameters::kRecording), recording}}, "");
  for (Client& client : clients_) {
    if (client.watches_all || client.watched.contains(Parameters::kRecording)) {
      client.outbox.put_text(text);
    }
  }
}

void Gateway::on_binary(Client& client, std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  const auto published = foxglove::published(bytes);
  if (!published) return complain(client, "a binary message that this server does not know");
  if (!client.publications.contains(published->channel)) {
    return complain(client, "a message on channel " + std::to_string(published->channel) +
                                ", which this client has not advertised");
  }
  request(client, published->data, now_ns);
}

void Gateway::request(Client& client, std::string_view json_text, std::int64_t now_ns) {
  try {
    // The same message from everywhere: as request_t names it.
    const auto payload = payload_from_json(*types_.find(kChannels[kRequest].type),
                                           parsed<nlohmann::json>(json_text));
    request_t request;
    request.decode(payload.data(), 0, static_cast<int>(payload.size()));
    if (!owner_) {
      throw Error("no owner of rig " + rig_.name + " is heard: start gyrotwin-integrator or " +
                  "gyrotwin-hardware");
    }
    if (request.verb == request_t::DISARM) {
      if (const std::size_t forgotten = requests_.forget(); forgotten > 0) {
        tell_operators(Level::kWarning, "disarm: forgets " + std::to_string(forgotten) +
                                            " that the owner has not answered yet");
      }
    }
    if (!requests_.ask(request, now_ns)) throw Error("too many requests wait for an answer");
    ++counters_.requests;
  } catch (const std::exception& error) {
    complain(client, std::string("request: ") + error.what());
  }
}

/// To the owner's run as it is now: one request may have ended the run that the next was meant for.
void Gateway::address(request_t& request) const {
  if (!owner_) return;
  if (request.owner_epoch == 0) request.owner_epoch = owner_->header.epoch;
  request.header.tick = owner_->header.tick;
  request.header.sim_time_ns = owner_->header.sim_time_ns;
}

void Gateway::on_reception(const Reception& reception, std::int64_t now_ns, std::uint64_t wall_ns) {
  const std::size_t index = index_of(reception.channel);
  if (reception.channel == Channel::kReply) {
    reply_t reply;
    Bus::decode(reception, reply);
    if (owner_) owner_->header = reply.header;
    requests_.on_reply(reply, now_ns);
  }
  if (kChannels[index].type == "status_t") {
    Bus::decode(reception, statuses_[index].emplace());
    status_at_[index] = now_ns;
    if (is_owner_status(reception.channel)) {
      owner_ = statuses_[index];
      owner_on_ = reception.channel;
    }
  }
  if (subscribers_[index] == 0) return;
  auto body = std::make_shared<std::vector<std::uint8_t>>();
  body->reserve(kChannels[index].size + kChannels[index].size / 4);
  encoders_[index].encode(reception.payload, *body);
  for (Client& client : clients_) {
    for (const auto& [id, channel] : client.subscriptions) {
      if (channel != reception.channel) continue;
      Outgoing message = foxglove::message_data(id, wall_ns, body);
      // Who has asked waits for the answer, and no other follows.
      message.is_data = reception.channel != Channel::kReply;
      client.outbox.put(std::move(message));
      ++counters_.messages_out;
    }
  }
}

/// Who is silent is not there.
void Gateway::forget(std::int64_t now_ns) {
  for (std::size_t i = 0; i < statuses_.size(); ++i) {
    if (!statuses_[i] || now_ns - status_at_[i] < kSilence) continue;
    if (owner_on_ == kChannels[i].channel) owner_.reset();
    statuses_[i].reset();
  }
}

void Gateway::on_timer(std::int64_t now_ns, std::uint64_t wall_ns) {
  forget(now_ns);
  if (!requests_.on_timer(now_ns)) {
    tell_operators(Level::kError, "request: the owner of rig " + rig_.name + " does not answer");
  }
  for (Client& client : clients_) {
    client.outbox.put(foxglove::time(wall_ns));
    const std::int64_t dropped = client.outbox.dropped();
    if (dropped > client.drops_told) {
      client.outbox.put_text(foxglove::status(
          Level::kWarning, std::to_string(dropped - client.drops_told) +
                               " messages were left out: this connection is too slow"));
      client.drops_told = dropped;
    }
  }
}

}  // namespace gyrotwin
