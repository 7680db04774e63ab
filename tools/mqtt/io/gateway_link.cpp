#include "io/gateway_link.hpp"

#include <array>
#include <chrono>
#include <optional>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/json/parse.hpp>

#include "async/spawn.hpp"
#include "tmcl/client.hpp"
#include "tmcl/json_text.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;
using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using tmcl::client::Error;
using tmcl::client::ErrorKind;

constexpr auto greeting_timeout = std::chrono::seconds(3);
constexpr std::size_t read_bytes = 4096;

Error link_error(std::string_view name, tmcl::Outcome outcome, std::string message,
                 std::string hint = {}) {
  return {std::string(name), ErrorKind::failed, outcome, std::move(message), std::move(hint)};
}

Error lost_link() {
  return link_error(tmcl::client::error_name::lost, tmcl::Outcome::unknown,
                    "the connection to tmcld broke before it had answered",
                    "see where the axis is before it is moved again");
}

const json::object* member_object(const json::object& object, std::string_view name) {
  const auto* value = object.if_contains(name);
  return value == nullptr ? nullptr : value->if_object();
}

const std::int64_t* member_number(const json::object& object, std::string_view name) {
  const auto* value = object.if_contains(name);
  return value == nullptr ? nullptr : value->if_int64();
}

std::string member_text(const json::object& object, std::string_view name) {
  const auto* value = object.if_contains(name);
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::string();
}

}  // namespace

GatewayLink::GatewayLink(const boost::asio::any_io_executor& executor,
                         OnNotification on_notification)
    : socket_(executor),
      on_notification_(std::move(on_notification)),
      has_output_(executor),
      changed_(executor) {}

awaitable<Result<std::shared_ptr<GatewayLink>>> GatewayLink::open(std::string path,
                                                                  OnNotification on_notification) {
  const auto executor = co_await boost::asio::this_coro::executor;
  const auto link = std::make_shared<GatewayLink>(executor, std::move(on_notification));
  boost::system::error_code error;
  const boost::asio::local::stream_protocol::endpoint endpoint(path);
  // A unix socket answers at once.
  link->socket_.connect(endpoint, error);
  if (error) {
    co_return tl::unexpected(
        link_error(tmcl::client::error_name::unreachable, tmcl::Outcome::not_sent,
                   "cannot connect to tmcld at " + path + ": " + error.message()));
  }
  tmcld::spawn(executor, read(link));
  tmcld::spawn(executor, write(link));
  const auto deadline = tmcl::ContextClock(executor).now() + greeting_timeout;
  while (!link->greeted_ && !link->lost_ && tmcl::ContextClock(executor).now() < deadline)
    co_await link->changed_.wait_until(deadline);
  if (!link->greeted_) {
    link->close();
    co_return tl::unexpected(link_error(tmcl::client::error_name::incompatible,
                                        tmcl::Outcome::not_sent,
                                        "what listens at " + path + " does not greet as tmcld"));
  }
  co_return link;
}

void GatewayLink::call(std::string_view method, json::object params, OnAnswer on_answer) {
  std::optional<Error> refused;
  if (lost_)
    refused = link_error(tmcl::client::error_name::unreachable, tmcl::Outcome::not_sent,
                         "tmcld is not there");
  if (!refused && waiting_.size() >= most_calls)
    refused = link_error("too_many_requests", tmcl::Outcome::not_sent,
                         "too many calls of this user are in progress",
                         "wait for answers before calling again");
  if (refused) {
    boost::asio::post(socket_.get_executor(),
                      [on_answer = std::move(on_answer), refused = std::move(*refused)] {
                        on_answer(tl::unexpected(refused));
                      });
    return;
  }
  const auto id = ++last_id_;
  const json::object request{
      {"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", std::move(params)}};
  unsent_ += tmcl::json_text(request) + '\n';
  waiting_.emplace(id, std::move(on_answer));
  has_output_.notify();
}

awaitable<Result<json::object>> GatewayLink::call(std::string_view method, json::object params) {
  const auto executor = co_await boost::asio::this_coro::executor;
  struct Waiting {
    explicit Waiting(const boost::asio::any_io_executor& its_executor) : came(its_executor) {}
    tmcld::Wake came;
    std::optional<Result<json::object>> answer;
  };
  const auto waiting = std::make_shared<Waiting>(executor);
  call(method, std::move(params), [waiting](Result<json::object> answer) {
    waiting->answer.emplace(std::move(answer));
    waiting->came.notify();
  });
  while (!waiting->answer) co_await waiting->came.wait();
  co_return std::move(*waiting->answer);
}

awaitable<void> GatewayLink::read(std::shared_ptr<GatewayLink> self) {
  std::array<char, read_bytes> bytes;
  std::string line;
  while (!self->lost_) {
    boost::system::error_code error;
    const auto count = co_await self->socket_.async_read_some(boost::asio::buffer(bytes),
                                                              redirect_error(use_awaitable, error));
    if (error || !self->take_lines(line, std::string_view(bytes.data(), count))) break;
  }
  self->close();
}

bool GatewayLink::take_lines(std::string& begun, std::string_view bytes) {
  for (auto end = bytes.find('\n'); end != bytes.npos && !lost_; end = bytes.find('\n')) {
    begun += bytes.substr(0, end);
    if (!take(begun)) return false;
    begun.clear();
    bytes.remove_prefix(end + 1);
  }
  begun += bytes;
  return begun.size() <= tmcl::client::max_line_bytes;
}

awaitable<void> GatewayLink::write(std::shared_ptr<GatewayLink> self) {
  while (!self->lost_) {
    if (self->unsent_.empty()) {
      co_await self->has_output_.wait();
      continue;
    }
    const auto batch = std::exchange(self->unsent_, {});
    boost::system::error_code error;
    co_await boost::asio::async_write(self->socket_, boost::asio::buffer(batch),
                                      redirect_error(use_awaitable, error));
    if (error) break;
  }
  self->close();
}

bool GatewayLink::take_greeting(const json::object& params) {
  const auto* protocol = member_object(params, "protocol");
  const auto* major = protocol == nullptr ? nullptr : member_number(*protocol, "major");
  if (major == nullptr || *major != tmcl::client::protocol_major) return false;
  version_ = member_text(params, "daemon");
  greeted_ = true;
  changed_.notify();
  return true;
}

bool GatewayLink::take(std::string_view line) {
  boost::system::error_code error;
  const auto value = json::parse(json::string_view(line.data(), line.size()), error);
  if (error || !value.is_object()) return false;
  const auto& message = value.get_object();
  const auto method = member_text(message, "method");
  static const json::object none;
  if (!method.empty()) {
    const auto* params = member_object(message, "params");
    if (!greeted_) return method == "hello" && params != nullptr && take_greeting(*params);
    if (on_notification_) on_notification_(method, params == nullptr ? none : *params);
    return true;
  }
  const auto* id = member_number(message, "id");
  if (id == nullptr) return true;
  auto found = waiting_.extract(*id);
  if (found.empty()) return true;
  if (const auto* result = member_object(message, "result")) {
    found.mapped()(*result);
  } else {
    const auto* failure = member_object(message, "error");
    found.mapped()(
        tl::unexpected(tmcl::client::error_from_json(failure == nullptr ? none : *failure)));
  }
  return true;
}

awaitable<void> GatewayLink::end() {
  while (!lost_) co_await changed_.wait();
}

void GatewayLink::close() {
  if (std::exchange(lost_, true)) return;
  boost::system::error_code ignored;
  socket_.close(ignored);
  has_output_.notify();
  changed_.notify();
  for (auto& [id, on_answer] : std::exchange(waiting_, {})) on_answer(tl::unexpected(lost_link()));
}

}  // namespace tmclmqtt
