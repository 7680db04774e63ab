#include "protocol/gate.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include <boost/json/parse.hpp>

#include "tmcl/spelling.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;
using tmcl::Effect;
using tmcl::client::ErrorKind;

constexpr std::size_t max_depth = 16;
constexpr std::array<std::string_view, 3> members{"params", "epoch", "nonce"};
// They are about a connection, which no client of a broker has.
constexpr std::array<std::string_view, 3> of_connections{"subscribe", "unsubscribe", "speak_for"};
// It turns until a connection ends, and through a broker none does: a lease ends by itself.
constexpr std::string_view rotate = "axis.rotate";
// A wish that is not taken back may last so long.
constexpr std::uint32_t longest_wish_s = 3600;

Error bad(std::string_view name, std::string message, std::string hint = {}) {
  return {std::string(name), ErrorKind::bad_request, tmcl::Outcome::not_sent, std::move(message),
          std::move(hint)};
}

Error not_now(std::string_view name, std::string message, std::string hint = {}) {
  return {std::string(name), ErrorKind::not_now, tmcl::Outcome::not_sent, std::move(message),
          std::move(hint)};
}

Error refusal_of_retained() {
  return not_now("retained_call",
                 "the call was retained: a broker would give it to the gateway again and again",
                 "publish calls without 'retain'; this one was taken off the broker");
}

Error too_often() {
  return {"too_many_requests", ErrorKind::failed, tmcl::Outcome::not_sent,
          "this user calls more often than 50 times a second: other calls were dropped, too",
          "wait for answers before calling again"};
}

Error no_daemon() {
  return {std::string(tmcl::client::error_name::unreachable), ErrorKind::failed,
          tmcl::Outcome::not_sent, "tmcld is not there: the gateway has no axes now",
          "'tmclctl axes' on the gateway says what is wrong"};
}

std::string text_of(const json::object& said, std::string_view name) {
  const auto* value = said.if_contains(name);
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::string();
}

bool is_true(const json::object& params, std::string_view name) {
  const auto* value = params.if_contains(name);
  return value != nullptr && value->is_bool() && value->get_bool();
}

std::variant<Error, json::object> said_in(const Message& message) {
  if (message.payload.empty()) return json::object();
  if (message.payload.size() > max_payload_bytes) {
    return bad("line_too_long",
               "a call may have " + std::to_string(max_payload_bytes) + " bytes of text");
  }
  json::parse_options options;
  options.max_depth = max_depth;
  boost::system::error_code error;
  auto value = json::parse(message.payload, error, {}, options);
  if (error || !value.is_object())
    return bad("parse_error", "a call is a JSON object with the members params, epoch and nonce");
  for (const auto& [key, one] : value.get_object()) {
    const std::string_view name(key.data(), key.size());
    if (std::ranges::count(members, name) != 0) continue;
    return bad("invalid_request",
               "a call has no member " + tmcl::quoted(std::string(name)) + "." +
                   tmcl::did_you_mean(name, members),
               "what the method takes goes into 'params'");
  }
  const auto* params = value.get_object().if_contains("params");
  if (params != nullptr && !params->is_object())
    return bad("invalid_request", "the member \"params\" must be an object");
  return std::move(value.get_object());
}

bool acts(Effect effect) { return effect == Effect::moves || effect == Effect::writes; }

/// Of a call whose user is known, or of a stop.
std::optional<ReplyTo> reply_of(const Topics& topics, const Message& message,
                                const std::optional<std::string>& user) {
  const auto topic = topics.reply(message.response_topic, user);
  if (!topic || message.correlation.size() > max_correlation_bytes) return std::nullopt;
  return ReplyTo{*topic, message.correlation, user.value_or("")};
}

Judged refused(Error error, std::optional<ReplyTo> reply) {
  return {Refused{std::move(error)}, std::move(reply)};
}

}  // namespace

void Gate::begin_epoch() {
  epoch_ = draw_();
  nonces_.forget();
}

void Gate::look(tmcl::TimePoint now, tmcl::Duration slept) {
  gaps_.look(now, slept);
  if (!gaps_.is_in_gap()) return;
  gaps_.end(0);
  nonces_.forget();
}

Error Gate::stale_call() const {
  return not_now(
      "stale_request",
      "it was asked for before the gateway's tmcld-mqtt stood still for " +
          std::to_string(
              std::chrono::duration_cast<std::chrono::milliseconds>(gaps_.duration()).count()) +
          " ms",
      std::string(tmcld::stale_hint));
}

Judged Gate::judge(const Message& message, tmcl::TimePoint now) {
  const auto topic = topics_.read(message.topic);
  if (!topic) return {};
  if (std::holds_alternative<BirthTopic>(*topic)) return {BirthSeen{}};
  if (const auto* wish = std::get_if<WishTopic>(&*topic)) return judge_wish(*wish, message);
  if (const auto* call = std::get_if<CallTopic>(&*topic)) return judge_call(*call, message, now);
  // A stop that was retained stops, too. That of all gateways is not this one's to take away.
  return {StopWanted{}, reply_of(topics_, message, std::nullopt),
          message.retained && !std::get<StopTopic>(*topic).of_all};
}

Judged Gate::judge_wish(const WishTopic& topic, const Message& message) const {
  if (message.payload.empty()) return {WishMade{topic.user, {}}};
  // Without an end it would be there when its user has long gone.
  if (!message.expiry_s) return {Nothing{}, std::nullopt, message.retained};
  return {WishMade{topic.user, std::chrono::seconds(std::min(*message.expiry_s, longest_wish_s))}};
}

Judged Gate::judge_call(const CallTopic& topic, const Message& message, tmcl::TimePoint now) {
  auto reply = reply_of(topics_, message, topic.user);
  const auto known = methods_.find(topic.method);
  const bool stops = known != methods_.end() && known->second == Effect::stops;
  // That is how one is taken off a broker; but a stop is meant to stop.
  if (message.payload.empty() && message.retained && !stops) return {};
  if (message.retained && !stops) {
    auto judged = refused(refusal_of_retained(), std::move(reply));
    judged.must_be_cleared = true;
    return judged;
  }
  const auto rate = stops ? CallRate::Verdict::pass : rate_.judge(topic.user, now);
  if (rate == CallRate::Verdict::drop) return {};
  if (rate == CallRate::Verdict::refuse) return refused(too_often(), std::move(reply));
  // What cannot be answered was not asked for by any client that follows the protocol.
  if (!reply && !stops) return {};
  if (topic.method == nonce_method) return {NonceWanted{}, std::move(reply)};
  auto call = call_of(topic, message, now);
  if (auto* error = std::get_if<Error>(&call)) return refused(std::move(*error), std::move(reply));
  return {std::get<CallWanted>(std::move(call)), std::move(reply),
          message.retained && !message.payload.empty()};
}

std::variant<Error, CallWanted> Gate::call_of(const CallTopic& topic, const Message& message,
                                              tmcl::TimePoint now) {
  if (methods_.empty()) return no_daemon();
  if (std::ranges::count(of_connections, topic.method) != 0)
    return bad("not_by_mqtt", topic.method + " is for connections to tmcld itself",
               "states are retained below state/; docs/FLEET.md says what else there is");
  const auto known = methods_.find(topic.method);
  if (known == methods_.end()) {
    std::vector<std::string_view> names;
    for (const auto& [name, effect] : methods_) names.push_back(name);
    return bad("method_not_found", "there is no method '" + topic.method + "'." +
                                       tmcl::did_you_mean(topic.method, names));
  }
  auto said = said_in(message);
  if (auto* error = std::get_if<Error>(&said)) return std::move(*error);
  const auto& object = std::get<json::object>(said);
  const auto effect = known->second;
  if (acts(effect)) {
    if (auto objection = objection_to_age(object, topic.user, now)) return std::move(*objection);
  }
  const auto* given = object.if_contains("params");
  CallWanted call{topic.user, topic.role, topic.method, effect,
                  given == nullptr ? json::object() : given->get_object()};
  const bool ends =
      topic.method != rotate || call.params.contains("lease") || is_true(call.params, "unattended");
  if (!ends) {
    return not_now("needs_lease", "an axis that turns through a broker needs a lease",
                   "lease.acquire gives one: when it is not renewed the axis stops; or "
                   "\"unattended\": true");
  }
  return call;
}

std::optional<Error> Gate::objection_to_age(const json::object& said, std::string_view user,
                                            tmcl::TimePoint now) {
  if (text_of(said, "epoch") != epoch_ || epoch_.empty()) {
    return not_now("stale_epoch",
                   "the call is not of the present connection of the gateway to its broker",
                   "'epoch' and 'nonce' of this answer are; ask again if it is still wanted");
  }
  if (nonces_.take(user, text_of(said, "nonce"), now)) return std::nullopt;
  return not_now("stale_nonce",
                 "the nonce was used, or is none that the gateway has given to this user within "
                 "its last " +
                     std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(
                                        nonces_.time_to_live())
                                        .count()) +
                     " ms",
                 "'nonce' of this answer is one; ask again if it is still wanted");
}

}  // namespace tmclmqtt
