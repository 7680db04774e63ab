#include "io/bridge.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "async/rest.hpp"
#include "async/slept.hpp"
#include "async/spawn.hpp"
#include "broker/password_file.hpp"
#include "log/log.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/json_text.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;
using boost::asio::awaitable;
using tmcl::client::Error;
using tmcl::client::ErrorKind;
using tmcl::client::Result;
using tmcld::LogLevel;

constexpr auto look_interval = std::chrono::milliseconds(100);
constexpr auto pause_without_gateway = std::chrono::seconds(1);
constexpr std::int32_t state_interval_ms = 500;
constexpr std::size_t longest_short_answer = 4096;
// All gateways come at once when a broker has started again: the handshakes of a thousand keep it
// busy for some ten seconds, and those that give up meanwhile begin theirs anew.
constexpr auto time_to_be_let_in = std::chrono::seconds(30);
// The one that stood on the broker before, and the will of a connection that was lost.
constexpr int most_replaced_births = 2;
// More of them at a time cost a gateway that is late more time, and stop nothing sooner: those that
// come meanwhile go out as one.
constexpr int most_stops_in_progress = 8;
// One behind a call that may move something overtakes that, so it does not wait. tmcld takes 64 of
// a connection.
constexpr int most_stops_behind_calls = 48;
// tmcld may cut off the other links, too.
constexpr int most_links_for_a_stop = 3;
// Those beyond are carried out with them, without an answer.
constexpr std::size_t most_waiting_stops = 4096;

std::map<std::string, tmcl::Effect, std::less<>> methods_of(const api::rpc::Methods& told) {
  std::map<std::string, tmcl::Effect, std::less<>> methods;
  for (const auto& method : told.methods) {
    // What this program does not know may do most.
    auto effect = tmcl::Effect::moves;
    if (method.effect == "reads") effect = tmcl::Effect::reads;
    if (method.effect == "writes") effect = tmcl::Effect::writes;
    if (method.effect == "stops") effect = tmcl::Effect::stops;
    methods.emplace(method.name, effect);
  }
  return methods;
}

std::vector<ListedAxis> axes_in(const json::object& listed) {
  std::vector<ListedAxis> axes;
  for (const auto& axis : api::from_json<api::axis::List::Result>(listed).axes)
    axes.push_back({axis.name, axis.unit.value_or(""), axis.state == "ready"});
  return axes;
}

std::vector<std::string> names_of(const std::vector<ListedAxis>& axes) {
  std::vector<std::string> names;
  for (const auto& axis : axes) names.push_back(axis.name);
  return names;
}

/// There may be other axes, or other ones may answer.
bool tells_of_axes(const json::object& event) {
  const auto* value = event.if_contains(api::name_of<&api::Event::kind>());
  if (value == nullptr || !value->is_string()) return false;
  const std::string_view kind(value->get_string());
  return kind == "configuration_loaded" || kind.starts_with("module_") || kind.starts_with("link_");
}

BrokerOptions broker_options(const MqttConfig& config, std::string client_id) {
  BrokerOptions options;
  options.host = config.host;
  options.port = config.port;
  options.client_id = std::move(client_id);
  options.ca = config.ca;
  options.certificate = config.certificate;
  options.key = config.key;
  options.user = config.user;
  if (!config.password_file.empty())
    options.password = [path = config.password_file] { return password_in(path); };
  options.time_to_be_let_in = time_to_be_let_in;
  return options;
}

/// By its effect the call may have been carried out.
Error answer_too_long() {
  return {"answer_too_long", ErrorKind::failed, tmcl::Outcome::unknown,
          "the answer is longer than the broker takes", "ask for less at a time"};
}

/// When the first is lost, the second ends.
awaitable<void> end_with(std::shared_ptr<Broker> first, std::shared_ptr<Broker> second,
                         Publication farewell) {
  co_await first->end();
  second->publish(farewell);
  second->disconnect();
}

Error no_gateway() {
  return {std::string(tmcl::client::error_name::unreachable), ErrorKind::failed,
          tmcl::Outcome::not_sent, "tmcld is not there",
          "'tmclctl doctor' on the gateway says why"};
}

awaitable<Result<json::object>> stop_over_new_link(std::string socket) {
  auto opening = GatewayLink::open(std::move(socket), nullptr);
  const auto opened = co_await std::move(opening);
  if (!opened) co_return tl::unexpected(no_gateway());
  auto asking = (*opened)->call(api::system::StopAll::method.name, json::object());
  auto result = co_await std::move(asking);
  (*opened)->close();
  co_return result;
}

bool is_of_broken_link(const Error& error) {
  return error.name == tmcl::client::error_name::lost ||
         error.name == tmcl::client::error_name::unreachable;
}

}  // namespace

Bridge::Bridge(const boost::asio::any_io_executor& executor, MqttConfig config, BridgeParts parts)
    : executor_(executor),
      clock_(executor),
      config_(std::move(config)),
      parts_(std::move(parts)),
      client_id_(fmt::format("tmcld-mqtt-{}-{}", config_.gateway, parts_.draw())),
      gate_(config_.gateway, parts_.draw, config_.nonce_ttl),
      births_(gate_.topics().birth(), TMCL_VERSION),
      news_(gate_.topics()),
      users_(std::make_shared<UserLinks>(executor, config_.socket, gate_)) {
  if (config_.home_assistant)
    home_.emplace(config_.gateway, config_.home_assistant_prefix, TMCL_VERSION);
}

void Bridge::start() {
  start_sparkplug();
  tmcld::spawn(executor_, serve_gateway(shared_from_this()));
  tmcld::spawn(executor_, serve_broker(shared_from_this()));
  tmcld::spawn(executor_, look(shared_from_this()));
}

void Bridge::start_sparkplug() {
  if (config_.sparkplug_group.empty()) return;
  Sparkplug node({config_.sparkplug_group, config_.gateway, config_.sparkplug_host}, TMCL_VERSION);
  const auto weak = weak_from_this();
  sparkplug_ = std::make_shared<SparkplugLink>(
      executor_, broker_options(config_, client_id_ + "-sparkplug"), parts_.connect,
      std::move(node),
      [weak] {
        const auto self = weak.lock();
        return self && self->calls_.broker;
      },
      [weak](std::string line) {
        if (const auto self = weak.lock()) self->log_often(std::move(line));
      });
  sparkplug_->start();
}

void Bridge::stop() {
  if (std::exchange(stopping_, true)) return;
  disconnect();
  if (sparkplug_) sparkplug_->stop();
  users_->close();
  if (gateway_) gateway_->close();
}

awaitable<void> Bridge::look(std::shared_ptr<Bridge> self) {
  while (!self->stopping_) {
    const auto now = self->now();
    self->gate_.look(now, tmcld::slept(self->executor_));
    self->users_->end_silent_ones(now);
    if (self->calls_.broker) {
      self->add_due_news(now);
      self->flush(self->calls_);
    }
    if (self->sparkplug_) self->sparkplug_->look();
    self->parts_.on_turn();
    co_await tmcld::rest(look_interval);
  }
}

void Bridge::add_due_news(tmcl::TimePoint now) {
  add_news(news_.due(now));
  if (auto birth = births_.due(now)) replace_birth(std::move(*birth));
  if (!home_) return;
  if (auto config = home_->due(now)) calls_.outbox.add_news(std::move(*config));
}

void Bridge::log_often(std::string line) {
  if (const auto admitted = limiter_.admit(std::move(line), now()))
    tmcld::log(LogLevel::warning, *admitted);
}

// ---- tmcld -------------------------------------------------------------------------------------

awaitable<void> Bridge::serve_gateway(std::shared_ptr<Bridge> self) {
  while (!self->stopping_) {
    const auto why = co_await self->use_gateway();
    if (self->stopping_) break;
    self->log_often(why);
    co_await tmcld::rest(pause_without_gateway);
  }
}

awaitable<std::string> Bridge::use_gateway() {
  auto opening = GatewayLink::open(
      config_.socket, [weak = weak_from_this()](std::string_view method, const json::object& said) {
        if (const auto self = weak.lock()) self->hear(method, said);
      });
  const auto opened = co_await std::move(opening);
  if (!opened) co_return opened.error().message;
  const auto link = *opened;
  const auto known = co_await get_to_know(*link);
  if (!known) {
    link->close();
    co_return known.error().message;
  }
  gateway_ = link;
  know_axes(axes_);
  if (std::exchange(axes_are_old_, false)) tmcld::spawn(executor_, list_axes(shared_from_this()));
  say_birth();
  add_news(news_.all_states(now()));
  flush(calls_);
  tmcld::log(LogLevel::info, fmt::format("tmcld {} is there", link->daemon_version()));
  co_await link->end();
  gateway_ = nullptr;
  axes_.clear();
  if (sparkplug_) sparkplug_->forget();
  gate_.know_methods({});
  news_.forget_axes();
  say_birth();
  co_return std::string("the connection to tmcld has ended");
}

awaitable<Result<void>> Bridge::get_to_know(GatewayLink& link) {
  auto asking = link.call(api::rpc::Discover::method.name, json::object());
  const auto methods = co_await std::move(asking);
  if (!methods) co_return tl::unexpected(methods.error());
  api::Subscribe all;
  all.interval_ms = state_interval_ms;
  asking = link.call(api::Subscribe::method.name, api::to_json(all));
  const auto subscribed = co_await std::move(asking);
  if (!subscribed) co_return tl::unexpected(subscribed.error());
  // Modules may have been met only by the looks of the subscription.
  axes_are_old_ = false;
  asking = link.call(api::axis::List::method.name, json::object());
  const auto axes = co_await std::move(asking);
  if (!axes) co_return tl::unexpected(axes.error());
  gate_.know_methods(methods_of(api::from_json<api::rpc::Methods>(*methods)));
  axes_ = axes_in(*axes);
  if (const auto* states = subscribed->if_contains("states"); states && states->is_array()) {
    for (const auto& state : states->get_array())
      if (state.is_object()) hear_state(state.get_object());
  }
  co_return Result<void>();
}

awaitable<void> Bridge::list_axes(std::shared_ptr<Bridge> self) {
  const auto link = self->gateway_;
  if (!link) co_return;
  auto asking = link->call(api::axis::List::method.name, json::object());
  const auto axes = co_await std::move(asking);
  if (!axes || self->gateway_ != link) co_return;
  const auto before = names_of(self->axes_);
  self->know_axes(axes_in(*axes));
  const auto names = names_of(self->axes_);
  self->add_news(self->news_.keep_only(names));
  if (names != before) self->say_birth();
}

void Bridge::know_axes(std::vector<ListedAxis> axes) {
  axes_ = std::move(axes);
  if (sparkplug_) sparkplug_->know(gateway_->daemon_version(), axes_);
  if (home_) home_->know(axes_, now());
}

void Bridge::hear(std::string_view method, const json::object& params) {
  if (method == api::Event::notification && tells_of_axes(params)) {
    axes_are_old_ = !gateway_;
    tmcld::spawn(executor_, list_axes(shared_from_this()));
  }
  if (method != api::NewState::notification) return;
  hear_state(params);
  flush(calls_);
}

void Bridge::hear_state(const json::object& state) {
  add_news(news_.hear(state, now()));
  if (sparkplug_) sparkplug_->hear(state);
}

// ---- the broker --------------------------------------------------------------------------------

awaitable<void> Bridge::serve_broker(std::shared_ptr<Bridge> self) {
  Pauses pauses;
  while (!self->stopping_) {
    const auto began = self->now();
    const auto why = co_await self->use_broker();
    if (self->stopping_) break;
    // Once: it is tried again for days.
    if (std::exchange(self->broker_problem_, why) != why)
      self->log_often(fmt::format("broker {}:{}: {}", self->config_.host, self->config_.port, why));
    co_await tmcld::rest(pauses.next(self->now() - began));
  }
}

awaitable<std::string> Bridge::use_broker() {
  gate_.begin_epoch();
  connecting_ = true;
  auto connecting = connect(stops_, "-stop", std::nullopt);
  auto connected = co_await std::move(connecting);
  if (connected) {
    // Before a birth can say that the gateway is there. QoS 1 keeps a stop from being left out;
    // without a session that lasts none comes late.
    stops_.broker->subscribe({gate_.topics().stop(), 1});
    stops_.broker->subscribe({Topics::stop_of_all(), 1});
    connecting = connect(calls_, "", births_.will(gate_.epoch()));
    connected = co_await std::move(connecting);
  }
  connecting_ = false;
  if (!connected || stopping_) {
    disconnect();
    std::string why;
    if (!connected) why = connected.error();
    co_return why;
  }
  begin_on_broker();
  // One without the other is not what the birth says.
  const auto calls = calls_.broker;
  tmcld::spawn(executor_, end_with(stops_.broker, calls, births_.farewell(gate_.epoch())));
  const auto why = co_await calls->end();
  disconnect();
  co_return why;
}

awaitable<tl::expected<void, std::string>> Bridge::connect(Line& line, std::string_view client,
                                                           std::optional<Publication> will) {
  auto options = broker_options(config_, client_id_ + std::string(client));
  options.will = std::move(will);
  auto on_message = [weak = weak_from_this(), &line](const Message& message) {
    if (const auto self = weak.lock()) self->take(line, message);
  };
  auto on_room = [weak = weak_from_this(), &line] {
    if (const auto self = weak.lock()) self->flush(line);
  };
  auto connecting = parts_.connect(std::move(options), on_message, on_room);
  auto connected = co_await std::move(connecting);
  tl::expected<void, std::string> result;
  if (connected) {
    line.broker = std::move(*connected);
    line.outbox.clear();
  } else {
    result = tl::unexpected(std::move(connected.error()));
  }
  co_return result;
}

void Bridge::begin_on_broker() {
  replaced_births_ = 0;
  broker_problem_.clear();
  calls_.broker->subscribe({gate_.topics().all_calls(), 0});
  calls_.broker->subscribe({gate_.topics().all_wishes(), 0});
  calls_.broker->subscribe({gate_.topics().birth(), 0});
  if (home_) {
    for (const auto& filter : home_->filters()) calls_.broker->subscribe({filter, 0});
    home_->begin(now());
  }
  say_birth();
  add_news(news_.all_states(now()));
  flush(calls_);
  tmcld::log(LogLevel::info, fmt::format("gateway {} is on broker {}:{}", config_.gateway,
                                         config_.host, config_.port));
}

void Bridge::disconnect() {
  if (calls_.broker) {
    flush(calls_);
    calls_.broker->publish(births_.farewell(gate_.epoch()));
  }
  for (auto* line : {&calls_, &stops_})
    if (const auto broker = std::exchange(line->broker, nullptr)) broker->disconnect();
}

void Bridge::say_birth() {
  if (!calls_.broker) return;
  calls_.outbox.add_news(
      births_.birth({gate_.epoch(), gate_.time_to_live(),
                     gateway_ ? gateway_->daemon_version() : std::string(), names_of(axes_)},
                    now()));
  flush(calls_);
}

void Bridge::replace_birth(Publication its_own) {
  if (++replaced_births_ > most_replaced_births)
    log_often("another gateway has its name: births that are not its own come to the broker");
  calls_.outbox.add_news(std::move(its_own));
}

void Bridge::add_news(std::vector<Publication> news) {
  if (!calls_.broker) return;
  for (auto& one : news) calls_.outbox.add_news(std::move(one));
}

void Bridge::flush(Line& line) {
  while (line.broker && line.broker->has_room()) {
    auto next = line.outbox.take();
    if (!next) return;
    if (line.broker->publish(*next) != Broker::Sent::too_long) continue;
    log_often("what was to go to " + next->topic + " is longer than the broker takes");
    if (next->retained || next->payload.size() <= longest_short_answer) continue;
    next->payload = tmcl::json_text(json::object{{"error", to_json(answer_too_long())}});
    line.outbox.add_answer(std::move(*next));
  }
}

// ---- messages ----------------------------------------------------------------------------------

void Bridge::take(Line& line, const Message& message) {
  if (stopping_) return;
  const auto now = this->now();
  gate_.look(now, tmcld::slept(executor_));
  auto judged = gate_.judge(message, now);
  if (std::holds_alternative<BirthSeen>(judged.is)) births_.see(message);
  if (home_) home_->take(message, now);
  if (judged.must_be_cleared) {
    log_often("a message that a broker keeps was taken off it: " + message.topic);
    line.outbox.add_news({.topic = message.topic, .retained = true});
  }
  carry_out(line, std::move(judged), now);
  flush(line);
}

void Bridge::carry_out(Line& line, Judged judged, tmcl::TimePoint now) {
  auto& reply = judged.reply;
  if (std::holds_alternative<StopWanted>(judged.is)) return stop_axes(line, reply);
  if (const auto* refused = std::get_if<Refused>(&judged.is))
    return answer(line, reply, tl::unexpected(refused->error));
  if (std::holds_alternative<NonceWanted>(judged.is)) return answer(line, reply, json::object());
  if (const auto* wish = std::get_if<WishMade>(&judged.is))
    return news_.wish(wish->user, wish->time, now);
  auto* call = std::get_if<CallWanted>(&judged.is);
  if (call == nullptr) return;
  auto on_answer = [weak = weak_from_this(), reply, &line](const Result<json::object>& result) {
    if (const auto self = weak.lock()) self->answer(line, reply, result);
  };
  // A stop is carried out all the same, in this program's own name.
  if (call->effect == tmcl::Effect::stops && !users_->has_room_for(*call) && gateway_)
    return gateway_->call(call->method, std::move(call->params), std::move(on_answer));
  if (call->effect == tmcl::Effect::moves || call->effect == tmcl::Effect::writes)
    has_acted_since_stop_ = true;
  users_->call(std::move(*call), now, std::move(on_answer));
}

void Bridge::stop_axes(Line& line, const std::optional<ReplyTo>& reply) {
  StopAsked stop{&line, {}, {}};
  if (reply) stop = {&line, reply->topic, reply->correlation};
  if (waiting_stops_.size() < most_waiting_stops) waiting_stops_.insert(std::move(stop));
  send_stops();
}

void Bridge::send_stops() {
  const int most = has_acted_since_stop_ ? most_stops_behind_calls : most_stops_in_progress;
  if (waiting_stops_.empty() || stops_in_progress_ >= most) return;
  has_acted_since_stop_ = false;
  auto stops = std::exchange(waiting_stops_, {});
  ++stops_in_progress_;
  if (!gateway_) return stop_by_another_link(std::move(stops));
  auto on_answer = [weak = weak_from_this(), stops](const Result<json::object>& result) {
    const auto self = weak.lock();
    if (!self) return;
    if (!result && !self->stopping_ && is_of_broken_link(result.error()))
      return self->stop_by_another_link(stops);
    self->end_stops(stops, result);
  };
  gateway_->call(api::system::StopAll::method.name, {}, std::move(on_answer));
}

void Bridge::stop_by_another_link(Stops stops) {
  tmcld::spawn(executor_, stop_anew(shared_from_this(), std::move(stops)));
}

awaitable<void> Bridge::stop_anew(std::shared_ptr<Bridge> self, Stops stops) {
  Result<json::object> result = tl::unexpected(no_gateway());
  for (int links = most_links_for_a_stop; links > 0; --links) {
    auto stopping = stop_over_new_link(self->config_.socket);
    result = co_await std::move(stopping);
    const bool is_cut = !result && result.error().name == tmcl::client::error_name::lost;
    if (!is_cut || self->stopping_) break;
  }
  self->end_stops(stops, result);
}

void Bridge::end_stops(const Stops& stops, const Result<json::object>& result) {
  --stops_in_progress_;
  const auto text = answer_text(result, {});
  for (const auto& stop : stops) {
    if (!stop.topic || !stop.line->broker) continue;
    stop.line->outbox.add_answer(
        {.topic = *stop.topic, .payload = text, .correlation = stop.correlation});
    flush(*stop.line);
  }
  send_stops();
}

void Bridge::answer(Line& line, const std::optional<ReplyTo>& reply,
                    const Result<json::object>& result) {
  if (!reply || !line.broker) return;
  line.outbox.add_answer({.topic = reply->topic,
                          .payload = answer_text(result, reply->user),
                          .correlation = reply->correlation});
  flush(line);
}

std::string Bridge::answer_text(const Result<json::object>& result, const std::string& user) {
  std::string text = result ? R"({"result":)" : R"({"error":)";
  if (result) {
    tmcl::append_json(text, *result);
  } else {
    tmcl::append_json(text, tmcl::client::to_json(result.error()));
  }
  json::object more{{"epoch", gate_.epoch()}};
  if (!user.empty()) more["nonce"] = gate_.give_nonce(user, now());
  return text + ',' + tmcl::json_text(more).substr(1);
}

}  // namespace tmclmqtt
