#include "world/fleet/fleet_user.hpp"

#include <utility>

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

namespace tmcld::test {
namespace {

constexpr auto pause_without_broker = std::chrono::milliseconds(700);
/// A broker that begins anew may have lost the attempt.
constexpr auto let_in_timeout = std::chrono::seconds(5);
constexpr auto retry_interval = std::chrono::milliseconds(300);

std::string member(const json::object& object, std::string_view name) {
  const auto* value = object.if_contains(name);
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : "";
}

}  // namespace

void FleetUser::connect() {
  is_let_in_ = false;
  const auto number = ++last_connection_;
  connection_ = network_.open([weak = weak_from_this(), number](Delivery delivery) {
    const auto self = weak.lock();
    // What a connection before it still says is not heard.
    if (self && self->last_connection_ == number) self->on_delivery(std::move(delivery));
  });
  connection_->connect({.client_id = "user-" + name_,
                        .user = name_,
                        .clean_start = false,
                        .session_expiry = std::chrono::seconds(60)});
  was_let_in_ = false;
  network_.later(let_in_timeout, [weak = weak_from_this(), number] {
    const auto self = weak.lock();
    if (!self || self->last_connection_ != number || self->was_let_in_) return;
    self->connection_->abandon();
    self->connect_later(number);
  });
}

void FleetUser::connect_later(int number) {
  network_.later(pause_without_broker, [weak = weak_from_this(), number] {
    const auto self = weak.lock();
    if (self && !self->has_ended_ && self->last_connection_ == number) self->connect();
  });
}

void FleetUser::end() {
  has_ended_ = true;
  if (connection_) connection_->disconnect();
}

void FleetUser::on_delivery(Delivery delivery) {
  using Kind = Delivery::Kind;
  if (delivery.kind == Kind::message) return on_message(delivery.message);
  if (delivery.kind == Kind::acknowledged) {
    ++reasons[delivery.reason];
    unacknowledged_.erase(delivery.packet);
    return;
  }
  is_let_in_ = delivery.kind == Kind::let_in;
  if (is_let_in_) {
    was_let_in_ = true;
    connection_->subscribe("tmcl/v1/+/birth", 1);
    connection_->subscribe("tmcl/v1/reply/" + name_ + "/#", 1);
    // What the broker has not acknowledged is sent once more.
    for (const auto& [packet, publication] : unacknowledged_)
      connection_->publish(publication, packet);
    for (auto& publication : std::exchange(to_send_, {})) publish(std::move(publication));
    return;
  }
  connect_later(last_connection_);
}

// ---- what it says ------------------------------------------------------------------------------

void FleetUser::publish(Publication publication) {
  if (!is_connected()) {
    if (publication.qos > 0) to_send_.push_back(std::move(publication));
    return;
  }
  const auto packet = publication.qos > 0 ? ++last_packet_ : 0;
  if (packet != 0) unacknowledged_.emplace(packet, publication);
  connection_->publish(publication, packet);
}

Publication FleetUser::publication_of(const std::string& method, const json::object& said,
                                      Form form) {
  return {
      .topic = call_topic(method),
      .payload = form.payload.empty() ? json::serialize(said) : std::move(form.payload),
      .retained = form.retained,
      .qos = form.qos,
      .expiry_s = form.expiry_s,
      .response_topic =
          form.response_topic.empty() ? reply_topic() : std::move(form.response_topic),
      .correlation = form.correlation.empty() ? next_correlation() : std::move(form.correlation)};
}

std::string FleetUser::publish(const std::string& method, const json::object& said, Form form) {
  auto publication = publication_of(method, said, std::move(form));
  const auto correlation = publication.correlation;
  publish(std::move(publication));
  return correlation;
}

boost::asio::awaitable<std::optional<json::object>> FleetUser::answer_to(std::string correlation,
                                                                         tmcl::Duration patience) {
  const auto deadline = network_.now() + patience;
  while (!unread_answers_.contains(correlation) && network_.now() < deadline)
    co_await came_.wait_until(std::min(deadline, network_.now() + retry_interval));
  std::optional<json::object> answer;
  if (auto found = unread_answers_.extract(correlation)) answer = std::move(found.mapped());
  co_return answer;
}

std::optional<Nonce> FleetUser::take_nonce() {
  if (nonces_.empty()) return std::nullopt;
  auto nonce = std::move(nonces_.back());
  nonces_.pop_back();
  used_nonces.push_back(nonce);
  if (used_nonces.size() > 20) used_nonces.pop_front();
  return nonce;
}

// ---- what it hears -----------------------------------------------------------------------------

void FleetUser::learn(const std::string& epoch) {
  if (epoch.empty() || epoch == epoch_) return;
  if (!epoch_.empty()) old_epochs.insert(epoch_);
  epoch_ = epoch;
  nonces_.clear();
}

void FleetUser::on_message(const tmclmqtt::Message& message) {
  if (message.topic == std::string("tmcl/v1/") + gateway + "/birth")
    return on_birth(message.payload);
  if (message.topic.starts_with("tmcl/v1/reply/")) on_answer(message);
}

void FleetUser::on_birth(const std::string& text) {
  boost::system::error_code error;
  const auto value = json::parse(text, error);
  if (error || !value.is_object()) return;
  const auto* online = value.get_object().if_contains("online");
  online_ = online != nullptr && online->is_bool() && online->get_bool();
  if (online_) learn(member(value.get_object(), "epoch"));
}

void FleetUser::on_answer(const tmclmqtt::Message& message) {
  if (!message.topic.starts_with("tmcl/v1/reply/" + name_ + "/"))
    return complain(name_ + " gets an answer of another user: " + message.topic);
  if (!message.correlation.starts_with(name_ + "-"))
    return complain(name_ + " gets an answer to what it has not asked: " + message.correlation);
  ++answered;
  if (++answers[message.correlation] > read[message.correlation])
    complain(name_ + " gets more answers than the gateway has read calls: " + message.correlation);
  boost::system::error_code error;
  const auto value = json::parse(message.payload, error);
  if (error || !value.is_object()) return complain("an answer is no JSON: " + message.payload);
  const auto& answer = value.get_object();
  learn(member(answer, "epoch"));
  if (const auto nonce = member(answer, "nonce"); !nonce.empty())
    nonces_.push_back({nonce, network_.now()});
  if (nonces_.size() > 8) nonces_.pop_front();
  unread_answers_.insert_or_assign(message.correlation, answer);
  came_.notify();
}

}  // namespace tmcld::test
