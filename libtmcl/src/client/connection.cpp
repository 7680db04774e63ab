#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <boost/json/parse.hpp>

#include "client/line_socket.hpp"
#include "tmcl/client.hpp"
#include "tmcl/json_text.hpp"

namespace tmcl::client {
namespace {

namespace json = boost::json;

std::string text_of(const json::object& object, std::string_view key) {
  const auto* value = object.if_contains(key);
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::string{};
}

const json::object* object_of(const json::object& object, std::string_view key) {
  const auto* value = object.if_contains(key);
  return value != nullptr ? value->if_object() : nullptr;
}

std::optional<std::int64_t> integer_of(const json::object& object, std::string_view key) {
  const auto* value = object.if_contains(key);
  const auto* number = value != nullptr ? value->if_int64() : nullptr;
  return number != nullptr ? std::optional(*number) : std::nullopt;
}

Error incompatible(const std::string& path, std::string_view what) {
  return {std::string(error_name::incompatible), ErrorKind::failed, Outcome::not_sent,
          fmt::format("what answers at {} {}", path, what),
          "Is that the socket of a tmcld of this version?"};
}

std::optional<json::object> parse_message(const std::string& line) {
  boost::system::error_code problem;
  auto value = json::parse(line, problem);
  if (problem || !value.is_object()) return std::nullopt;
  return std::move(value.get_object());
}

TimePoint from_now(Duration duration) { return RealClock{}.now() + duration; }

}  // namespace

class Connection::State {
 public:
  State(std::unique_ptr<Channel> channel, Options options)
      : channel_(std::move(channel)), options_(std::move(options)) {}

  Result<void> read_hello();
  Result<json::object> call(std::string_view method, json::object params, Duration timeout);
  const Options& options() const { return options_; }
  Result<void> listen(Duration at_most);

  Handler handler_;
  std::string daemon_version_;

 private:
  Result<void> send(std::string_view method, json::object params, std::int64_t id);
  Result<std::optional<json::object>> next_message(TimePoint deadline);
  /// True if it was a progress report about the call `id`.
  bool hand_out(const json::object& notification, std::int64_t id);

  std::unique_ptr<Channel> channel_;
  Options options_;
  std::int64_t last_id_ = 0;
};

Result<std::optional<json::object>> Connection::State::next_message(TimePoint deadline) {
  const auto line = channel_->read_line(deadline);
  if (!line) return tl::unexpected(line.error());
  if (!line->has_value()) return std::optional<json::object>{};
  auto message = parse_message(**line);
  if (!message) return tl::unexpected(incompatible(channel_->name(), "does not speak JSON-RPC"));
  return message;
}

Result<void> Connection::State::read_hello() {
  auto message = next_message(from_now(options_.hello_timeout));
  if (!message) return tl::unexpected(message.error());
  if (!message->has_value()) {
    auto error = incompatible(channel_->name(), "does not greet in time");
    error.hint = "Is that tmcld, and is it neither stopped nor overloaded?";
    return tl::unexpected(std::move(error));
  }
  const auto* params = object_of(**message, "params");
  if (text_of(**message, "method") != "hello" || params == nullptr) {
    return tl::unexpected(incompatible(channel_->name(), "greets in another way than tmcld does"));
  }
  const auto* protocol = object_of(*params, "protocol");
  const auto major = protocol != nullptr ? integer_of(*protocol, "major") : std::nullopt;
  daemon_version_ = text_of(*params, "daemon");
  if (major != protocol_major) {
    return tl::unexpected(incompatible(
        channel_->name(),
        fmt::format("is tmcld {} with another protocol than {}", daemon_version_, protocol_major)));
  }
  return {};
}

bool Connection::State::hand_out(const json::object& notification, std::int64_t id) {
  static const json::object none;
  const auto method = text_of(notification, "method");
  const auto* params = object_of(notification, "params");
  if (params == nullptr) params = &none;
  if (handler_) handler_(method, *params);
  return method == "notify_progress" && integer_of(*params, "id") == id;
}

Result<void> Connection::State::send(std::string_view method, json::object params,
                                     std::int64_t id) {
  // It counts from now, however long the daemon takes to read this.
  if (params.contains("deadline_ms")) {
    const auto now = RealClock{}.now().time_since_epoch();
    params["sent_at_ms"] = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  }
  const json::object request{
      {"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", std::move(params)}};
  auto sent = channel_->write_line(json_text(request), from_now(options_.call_timeout));
  // A line that did not go out whole is not executed.
  if (!sent) sent.error().outcome = Outcome::not_sent;
  return sent;
}

Result<json::object> Connection::State::call(std::string_view method, json::object params,
                                             Duration timeout) {
  const auto id = ++last_id_;
  if (auto sent = send(method, std::move(params), id); !sent)
    return tl::unexpected(std::move(sent.error()));
  auto deadline = from_now(timeout);
  while (true) {
    auto message = next_message(deadline);
    if (!message) {
      message.error().outcome = Outcome::unknown;
      return tl::unexpected(std::move(message.error()));
    }
    if (!message->has_value()) {
      return tl::unexpected(Error{std::string(error_name::timeout), ErrorKind::failed,
                                  Outcome::unknown,
                                  fmt::format("tmcld did not answer {} in time", method),
                                  "Look at its log; 'tmclctl axes' shows which axes answer"});
    }
    if ((*message)->contains("method")) {
      if (hand_out(**message, id)) deadline = from_now(timeout);
      continue;
    }
    // An error without an id is about a line that the daemon could not read, and only ours can be
    // that.
    const auto answered = integer_of(**message, "id");
    if (answered != id && !(!answered && (*message)->contains("error"))) continue;
    if (const auto* result = object_of(**message, "result")) return *result;
    const auto* error = object_of(**message, "error");
    return tl::unexpected(error_from_json(error != nullptr ? *error : json::object{}));
  }
}

Result<void> Connection::State::listen(Duration at_most) {
  auto message = next_message(from_now(at_most));
  if (!message) return tl::unexpected(std::move(message.error()));
  if (message->has_value() && (*message)->contains("method")) hand_out(**message, 0);
  return {};
}

Result<Connection> Connection::open(const std::string& socket_path, Options options) {
  auto socket = LineSocket::open(socket_path, options.wait_for_socket, options.cancelled);
  if (!socket) return tl::unexpected(std::move(socket.error()));
  return open(std::make_unique<LineSocket>(std::move(*socket)), std::move(options));
}

Result<Connection> Connection::open(std::unique_ptr<Channel> channel, Options options) {
  auto state = std::make_unique<State>(std::move(channel), std::move(options));
  if (auto greeted = state->read_hello(); !greeted) {
    greeted.error().outcome = Outcome::not_sent;
    return tl::unexpected(std::move(greeted.error()));
  }
  return Connection(std::move(state));
}

Connection::Connection(std::unique_ptr<State> state) : state_(std::move(state)) {}
Connection::Connection(Connection&&) noexcept = default;
Connection& Connection::operator=(Connection&&) noexcept = default;
Connection::~Connection() = default;

Result<json::object> Connection::call(std::string_view method, json::object params) {
  return state_->call(method, std::move(params), state_->options().call_timeout);
}
Result<json::object> Connection::call(std::string_view method, json::object params,
                                      Duration timeout) {
  return state_->call(method, std::move(params), timeout);
}
Result<void> Connection::listen(Duration at_most) { return state_->listen(at_most); }
void Connection::on_notification(Handler handler) { state_->handler_ = std::move(handler); }
const std::string& Connection::daemon_version() const { return state_->daemon_version_; }

}  // namespace tmcl::client
