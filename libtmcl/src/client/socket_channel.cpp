#include <algorithm>
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

/// Requests and their answers over one line channel.
class Conversation {
 public:
  Conversation(std::unique_ptr<LineChannel> lines, const Options& options)
      : lines_(std::move(lines)), call_timeout_(options.call_timeout) {}

  Result<void> read_hello(Duration at_most);
  Result<json::object> call(std::string_view method, json::object params, Duration timeout);
  Result<void> listen(Duration at_most);
  const std::string& daemon_version() const { return daemon_version_; }

  Channel::Listener listener;

 private:
  Result<void> send(std::string_view method, json::object params, std::int64_t id);
  Result<std::optional<json::object>> next_message(TimePoint deadline);
  /// True if it was a progress report about the call `id`.
  bool hand_out(const json::object& notification, std::int64_t id);

  std::unique_ptr<LineChannel> lines_;
  Duration call_timeout_;
  std::string daemon_version_;
  std::int64_t last_id_ = 0;
};

Result<std::optional<json::object>> Conversation::next_message(TimePoint deadline) {
  const auto line = lines_->read_line(deadline);
  if (!line) return tl::unexpected(line.error());
  if (!line->has_value()) return std::optional<json::object>{};
  auto message = parse_message(**line);
  if (!message) return tl::unexpected(incompatible(lines_->name(), "does not speak JSON-RPC"));
  return message;
}

Result<void> Conversation::read_hello(Duration at_most) {
  auto message = next_message(from_now(at_most));
  if (!message) return tl::unexpected(message.error());
  if (!message->has_value()) {
    auto error = incompatible(lines_->name(), "does not greet in time");
    error.hint = "Is that tmcld, and is it neither stopped nor overloaded?";
    return tl::unexpected(std::move(error));
  }
  const auto* params = object_of(**message, "params");
  if (text_of(**message, "method") != "hello" || params == nullptr) {
    return tl::unexpected(incompatible(lines_->name(), "greets in another way than tmcld does"));
  }
  const auto* protocol = object_of(*params, "protocol");
  const auto major = protocol != nullptr ? integer_of(*protocol, "major") : std::nullopt;
  daemon_version_ = text_of(*params, "daemon");
  if (major != protocol_major) {
    return tl::unexpected(incompatible(
        lines_->name(),
        fmt::format("is tmcld {} with another protocol than {}", daemon_version_, protocol_major)));
  }
  return {};
}

bool Conversation::hand_out(const json::object& notification, std::int64_t id) {
  static const json::object none;
  const auto method = text_of(notification, "method");
  const auto* params = object_of(notification, "params");
  if (params == nullptr) params = &none;
  if (listener) listener(method, *params);
  return method == "notify_progress" && integer_of(*params, "id") == id;
}

Result<void> Conversation::send(std::string_view method, json::object params, std::int64_t id) {
  // It counts from now, however long the daemon takes to read this.
  if (params.contains("deadline_ms")) {
    const auto now = RealClock{}.now().time_since_epoch();
    params["sent_at_ms"] = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  }
  const json::object request{
      {"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", std::move(params)}};
  auto sent = lines_->write_line(json_text(request), from_now(call_timeout_));
  // A line that did not go out whole is not executed.
  if (!sent) sent.error().outcome = Outcome::not_sent;
  return sent;
}

Result<json::object> Conversation::call(std::string_view method, json::object params,
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

Result<void> Conversation::listen(Duration at_most) {
  auto message = next_message(from_now(at_most));
  if (!message) return tl::unexpected(std::move(message.error()));
  if (message->has_value() && (*message)->contains("method")) hand_out(**message, 0);
  return {};
}

/// To a daemon behind a socket, by one conversation and, for what is called meanwhile, a second.
class SocketChannel final : public Channel {
 public:
  SocketChannel(OpenLines open, Options options)
      : open_(std::move(open)), options_(std::move(options)) {
    if (options_.time_in_all) limit_ = from_now(*options_.time_in_all);
  }

  Result<json::object> call(std::string_view method, json::object params,
                            const CallOptions& options) override;
  Result<void> listen(Duration at_most) override { return first_->listen(at_most); }
  void on_notification(Listener listener) override { first_->listener = std::move(listener); }
  Result<void> reopen() override;
  std::string version() const override { return first_->daemon_version(); }

 private:
  Result<std::optional<Conversation>> converse(const Options& options) const;
  /// No longer than what is left until the limit.
  Duration bounded(Duration time) const {
    return limit_ ? std::clamp(*limit_ - RealClock{}.now(), Duration{}, time) : time;
  }

  OpenLines open_;
  Options options_;
  std::optional<TimePoint> limit_;
  std::function<void()> meanwhile_;  ///< Of the call in progress.
  std::optional<Conversation> first_;
  std::optional<Conversation> second_;
};

Result<std::optional<Conversation>> SocketChannel::converse(const Options& options) const {
  auto lines = open_(options);
  if (!lines) return tl::unexpected(std::move(lines.error()));
  std::optional<Conversation> conversation(std::in_place, std::move(*lines), options);
  if (auto greeted = conversation->read_hello(options.hello_timeout); !greeted) {
    greeted.error().outcome = Outcome::not_sent;
    return tl::unexpected(std::move(greeted.error()));
  }
  return conversation;
}

Result<void> SocketChannel::reopen() {
  auto options = options_;
  options.hello_timeout = bounded(options.hello_timeout);
  options.cancelled = [this] {
    if (!meanwhile_) return options_.cancelled && options_.cancelled();
    meanwhile_();
    return false;
  };
  // Only at first it may be worth waiting for a socket.
  if (first_) options.wait_for_socket = {};
  auto opened = converse(options);
  if (!opened) return tl::unexpected(std::move(opened.error()));
  first_ = std::move(*opened);
  return {};
}

Result<json::object> SocketChannel::call(std::string_view method, json::object params,
                                         const CallOptions& options) {
  const auto timeout = options.timeout.value_or(options_.call_timeout);
  if (meanwhile_) return second_->call(method, std::move(params), timeout);
  if (options.meanwhile && !second_) {
    auto second = converse({});
    if (!second) return tl::unexpected(std::move(second.error()));
    second_ = std::move(*second);
  }
  meanwhile_ = options.meanwhile;
  auto result = first_->call(method, std::move(params), bounded(timeout));
  meanwhile_ = {};
  return result;
}

}  // namespace

Result<std::unique_ptr<Channel>> open_channel(OpenLines open, Options options) {
  auto channel = std::make_unique<SocketChannel>(std::move(open), std::move(options));
  return channel->reopen().map([&] { return std::unique_ptr<Channel>(std::move(channel)); });
}

Result<std::unique_ptr<Channel>> open_channel(std::string socket_path, Options options) {
  const auto open =
      [path = std::move(socket_path)](const Options& how) -> Result<std::unique_ptr<LineChannel>> {
    auto socket = LineSocket::open(path, how.wait_for_socket, how.cancelled);
    if (!socket) return tl::unexpected(std::move(socket.error()));
    return std::make_unique<LineSocket>(std::move(*socket));
  };
  return open_channel(open, std::move(options));
}

Result<Caller> Caller::open(std::string socket_path, Options options) {
  return open_channel(std::move(socket_path), std::move(options))
      .map([](std::unique_ptr<Channel> channel) { return Caller(std::move(channel)); });
}

Result<json::object> Caller::call(std::string_view method, json::object params,
                                  const CallOptions& options) {
  if (lease_ && !method.starts_with("lease.")) {
    params[api::name_of<&api::lease::OnLease::lease>()] = lease_->lease;
    params[api::name_of<&api::lease::OnLease::epoch>()] = lease_->epoch;
  }
  return channel_->call(method, std::move(params), options);
}

}  // namespace tmcl::client
