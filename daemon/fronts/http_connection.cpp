// The only file of the daemon that knows Beast: it costs a minute to compile.
#include "fronts/http_connection.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "api/request.hpp"
#include "async/spawn.hpp"
#include "fronts/http_message.hpp"
#include "fronts/http_wire.hpp"
#include "fronts/metrics.hpp"
#include "fronts/session.hpp"
#include "tmcl/json_text.hpp"
#include "web/web_stream.hpp"

namespace tmcld {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace ssl = asio::ssl;
namespace websocket = beast::websocket;
using asio::awaitable;
using asio::redirect_error;
using asio::use_awaitable;
using boost::system::error_code;
using Tcp = asio::ip::tcp;
using namespace std::chrono_literals;

// A client has so long for TLS, and for the head of a request.
constexpr auto time_for_handshake = 5s;
constexpr auto time_for_head = 5s;
constexpr auto time_between_requests = 60s;
// A WebSocket is asked for a sign of life at half of it.
constexpr auto time_without_sign = 30s;
// A client that sends nothing any more is looked for so often while its call is in progress.
constexpr auto time_between_signs = 1s;
constexpr unsigned version_1_1 = 11;
constexpr std::uint32_t max_head_bytes = 8U * 1024U;
// Room that a message has taken and that is given back behind it.
constexpr std::size_t kept_buffer_bytes = 4096;

/// A client behind HTTP: its connection writes what it gives.
class HttpSession final : public Session {
 public:
  HttpSession(const asio::any_io_executor& executor, std::shared_ptr<Gateway> gateway,
              Options options, std::function<void()> disconnect)
      : Session(executor, std::move(gateway), std::move(options)),
        disconnect_(std::move(disconnect)) {}

  using Session::fail;
  using Session::greet;
  using Session::is_finishing;
  using Session::next_answer;
  using Session::next_message;
  using Session::output;
  using Session::take;
  using Session::wait_for_output;

 private:
  void disconnect() override { disconnect_(); }
  std::function<void()> disconnect_;
};

Error too_many_clients() {
  return not_now("too_many_clients", "tmcld has as many clients as it can serve",
                 "end programs that do not need their connection any more; stops are taken all the "
                 "same, by POST /rpc");
}

Error ending() { return not_now("daemon_ending", "tmcld is ending", "try again later"); }

// ---- one connection ----------------------------------------------------------------------------

class StreamConnection final : public HttpConnection,
                               public std::enable_shared_from_this<StreamConnection> {
  using Self = std::shared_ptr<StreamConnection>;

 public:
  /// `tls`: null for a port without.
  StreamConnection(WebStream stream, std::shared_ptr<ssl::context> tls,
                   std::shared_ptr<HttpConnections> connections, std::uint64_t id,
                   HttpConnectionInfo info)
      : wire_(std::move(stream), max_head_bytes + max_line_bytes),
        tls_(std::move(tls)),
        connections_(std::move(connections)),
        id_(id),
        info_(std::move(info)) {}

  void start() {
    const auto self = shared_from_this();
    spawn(executor(), run(self), [self](const auto& failure) { self->fail(failure); });
  }

  void finish() override {
    is_finishing_ = true;
    if (session_) session_->finish();
    if (!is_serving_ && !wire_.websocket()) close();
  }
  void close() override {
    if (session_) session_->close();
    wire_.close();
  }
  void end_if_by_token(const std::string& name) override {
    if (session_ && token_ == name) end_session("the token was revoked");
  }
  void end_if_signed_in_by(std::uint64_t sign_in) override {
    if (session_ && sign_in_ == sign_in) end_session("the sign-in has ended");
  }
  void end_if_it_lost_rights() override {
    if (session_ && !session_->is_closed() && session_->has_lost_rights())
      end_session("the configuration lets this client do less than before");
  }
  void end_if_idle(tmcl::TimePoint now) override {
    if (!idle_since_ || now - *idle_since_ < time_between_requests) return;
    if (!session_ || !session_->holds_axes()) close();
  }

 private:
  static awaitable<void> run(Self self) {
    const bool speaks = co_await self->shake_hands();
    if (speaks) co_await self->serve();
    self->end();
  }

  static awaitable<void> write(Self self) {
    auto& session = *self->session_;
    error_code error;
    while (!error) {
      const bool has_more = co_await session.wait_for_output();
      if (!has_more) break;
      const auto message = session.next_message();
      if (!message) continue;
      self->is_writing_ = true;
      co_await self->wire_.websocket()->async_write(asio::buffer(*message),
                                                    redirect_error(use_awaitable, error));
      self->is_writing_ = false;
    }
    if (!error && self->wire_.is_open())
      co_await self->wire_.websocket()->async_close(self->farewell_,
                                                    redirect_error(use_awaitable, error));
    session.close();
    self->wire_.close();
  }

  awaitable<bool> shake_hands() {
    if (!tls_) co_return true;
    wire_.lowest().expires_after(time_for_handshake);
    error_code error;
    const bool is_tls = co_await beast::async_detect_ssl(wire_.lowest(), wire_.buffer(),
                                                         redirect_error(use_awaitable, error));
    if (error) co_return false;
    if (!is_tls) {
      co_await refuse_plain_text();
      co_return false;
    }
    wire_.stream().use_tls(*tls_);
    auto received = beast::buffers_to_string(wire_.buffer().data());
    wire_.buffer().consume(wire_.buffer().size());
    error = co_await connections_->handshakes.perform(wire_.stream(), std::move(received),
                                                      info_.network);
    if (error) {
      log_tls(error);
      co_await wire_.linger();
    }
    co_return !error;
  }

  awaitable<void> refuse_plain_text() {
    log_refusal("speaks no TLS to a port that does");
    const auto refusal = not_now("needs_tls", "this port speaks TLS", "use https:// or wss://");
    co_await wire_.refuse(refusal);
  }

  awaitable<void> serve() {
    bool goes_on = true;
    for (bool is_first = true; goes_on && wire_.is_open() && !is_finishing_; is_first = false) {
      RequestParser parser;
      parser.header_limit(max_head_bytes);
      parser.body_limit(max_line_bytes);
      if (is_first) {
        wire_.lowest().expires_after(time_for_head);
      } else {
        wire_.lowest().expires_never();
        idle_since_ = connections_->gateway->clock().now();
      }
      error_code error;
      co_await http::async_read_header(wire_.stream(), wire_.buffer(), parser,
                                       redirect_error(use_awaitable, error));
      is_serving_ = true;
      idle_since_.reset();
      if (!parser.objection().empty()) {
        co_await refuse_head(parser.objection());
        break;
      }
      if (error) {
        co_await refuse_unreadable(error);
        break;
      }
      goes_on = co_await serve(parser);
      is_serving_ = false;
    }
  }

  /// False if this was the last request of the connection.
  awaitable<bool> serve(RequestParser& parser) {
    const auto* file = connections_->page.find(view_of(parser.get().target()));
    if (file != nullptr) {
      const bool goes_on = co_await serve_page(parser, *file);
      co_return goes_on;
    }
    const auto entry = connections_->admit(head_of(parser.get()), info_);
    if (!entry) {
      const auto status = http_status_of(entry.error());
      if (status == 401 || status == 403) log_refusal("was not let in: " + entry.error().message);
      co_await wire_.refuse(entry.error());
      co_return false;
    }
    // A body that is not read would be taken for the next request.
    if (entry->route != HttpRoute::rpc && !parser.is_done()) {
      co_await refuse_body();
      co_return false;
    }
    bool goes_on = false;
    switch (entry->route) {
      case HttpRoute::health: goes_on = co_await tell_health(parser.get()); break;
      case HttpRoute::metrics: goes_on = co_await tell_metrics(parser.get()); break;
      case HttpRoute::rpc: goes_on = co_await serve_call(parser); break;
      case HttpRoute::websocket: co_await serve_websocket(parser.release(), *entry); break;
      case HttpRoute::who: goes_on = co_await tell_who(parser.get(), *entry, {}); break;
      case HttpRoute::sign_in: goes_on = co_await sign_in(parser.get(), *entry); break;
      case HttpRoute::sign_out: goes_on = co_await sign_out(parser.get(), *entry); break;
    }
    co_return goes_on;
  }

  awaitable<bool> tell_health(const Request& request) {
    if (connections_->gateway->is_closing()) {
      const auto refusal = ending();
      co_await wire_.refuse(refusal);
      co_return false;
    }
    const bool goes_on = co_await respond(request, plain_type, "ok\n");
    co_return goes_on;
  }

  awaitable<bool> tell_metrics(const Request& request) {
    const auto& gateway = connections_->gateway;
    const auto axes = co_await measure_axes(gateway);
    auto text =
        metrics_text(*gateway, axes, connections_->share->stop_latency, connections_->clients());
    const bool goes_on = co_await respond(request, metrics_type, std::move(text));
    co_return goes_on;
  }

  // ---- the page ----

  awaitable<bool> serve_page(RequestParser& parser, const PageFile& file) {
    const auto method = parser.get().method();
    if (method != http::verb::get && method != http::verb::head) {
      const auto refusal =
          not_now("wrong_http_method", "the page is for GET, HEAD", "calls: POST /rpc");
      co_await wire_.refuse(refusal);
      co_return false;
    }
    if (!parser.is_done()) {
      co_await refuse_body();
      co_return false;
    }
    auto response = page_response(file, parser.get());
    const bool goes_on = co_await wire_.send(response);
    co_return goes_on;
  }

  /// `cookie`: what the client is to keep; empty: nothing new.
  awaitable<bool> tell_who(const Request& request, const HttpEntry& entry,
                           const std::string& cookie) {
    const boost::json::object who{{"role", name_of(entry.caller.role)},
                                  {"token", entry.token},
                                  {"signed_in", entry.sign_in != 0 || !cookie.empty()}};
    auto response = response_of(200, json_type, tmcl::json_text(who) + "\n", request.version(),
                                request.keep_alive());
    if (!cookie.empty()) response.set(http::field::set_cookie, cookie);
    const bool goes_on = co_await wire_.send(response);
    co_return goes_on;
  }

  awaitable<bool> sign_in(const Request& request, const HttpEntry& entry) {
    const auto cookie = cookie_with(connections_->sign_in(head_of(request), entry), time_signed_in);
    const bool goes_on = co_await tell_who(request, entry, cookie);
    co_return goes_on;
  }

  awaitable<bool> sign_out(const Request& request, const HttpEntry& entry) {
    connections_->sign_out(entry.sign_in, id_);
    auto response = response_of(200, json_type, "{}\n", request.version(), false);
    response.set(http::field::set_cookie, cookie_with("", std::chrono::seconds(0)));
    co_await wire_.send(response);
    // With it goes what this connection has let turn.
    co_return false;
  }

  std::string cookie_with(const std::string& secret, std::chrono::seconds age) const {
    return cookie_name(info_) + "=" + secret + "; Path=/; Max-Age=" + std::to_string(age.count()) +
           "; HttpOnly; SameSite=Strict" + (info_.has_tls ? "; Secure" : "");
  }

  awaitable<void> refuse_body() {
    const auto refusal = not_now("unexpected_body", "only a call to /rpc has a body",
                                 "send the request without one");
    co_await wire_.refuse(refusal);
  }

  // ---- calls ----

  awaitable<bool> serve_call(RequestParser& parser) {
    if (beast::iequals(parser.get()[http::field::expect], "100-continue")) {
      const auto version = parser.get().version();
      const bool is_sent = co_await wire_.send_interim(http::status::continue_, version);
      if (!is_sent) co_return false;
    }
    wire_.lowest().expires_after(time_for_body);
    error_code error;
    co_await http::async_read(wire_.stream(), wire_.buffer(), parser,
                              redirect_error(use_awaitable, error));
    if (error) {
      co_await refuse_unreadable(error);
      co_return false;
    }
    wire_.lowest().expires_never();
    const auto& body = parser.get().body();
    if (body.find_first_not_of(" \t\r\n") == std::string::npos) {
      const auto refusal =
          not_now("no_message", "the request has no body",
                  "one JSON-RPC message is wanted: {\"jsonrpc\":\"2.0\",\"id\":1,...}");
      co_await wire_.refuse(refusal);
      co_return false;
    }
    // The body may have taken a while: its token may be revoked by now.
    const auto entry = connections_->admit(head_of(parser.get()), info_);
    if (!entry) {
      co_await wire_.refuse(entry.error());
      co_return false;
    }
    const bool has_place = connections_->let_in(id_);
    begin_session(*entry, "http", has_place ? Session::Serves::all : Session::Serves::stops);
    if (session_->is_finishing()) {
      const auto refusal = ending();
      co_await wire_.refuse(refusal);
      co_return false;
    }
    session_->take(body);
    const auto answer = co_await next_answer(parser.get().version());
    if (!answer) co_return false;
    const bool goes_on = co_await respond(parser.get(), json_type, *answer + "\n");
    co_return goes_on&& has_place;
  }

  /// The calls of a connection are of one client, as long as it comes with the same token.
  void begin_session(const HttpEntry& entry, const char* door, Session::Serves serves) {
    if (session_ && !session_->is_closed() && is_of(entry)) return;
    if (session_) session_->close();
    token_ = entry.token;
    sign_in_ = entry.sign_in;
    Session::Options options;
    options.share = connections_->share;
    options.caller = [connections = connections_, token = entry.token, sign_in = entry.sign_in] {
      return connections->caller_by(token, sign_in);
    };
    options.name = entry.name;
    options.door = door;
    options.address = info_.peer;
    options.token = entry.token;
    options.serves = serves;
    const std::weak_ptr<StreamConnection> weak = weak_from_this();
    session_ = std::make_shared<HttpSession>(
        executor(), connections_->gateway, std::move(options), [weak] {
          const auto self = weak.lock();
          // One that can be told says farewell first.
          if (self && (!self->wire_.websocket() || self->is_writing_)) self->wire_.close();
        });
  }

  bool is_of(const HttpEntry& entry) const {
    return token_ == entry.token && sign_in_ == entry.sign_in;
  }

  void end_session(const char* why) {
    farewell_ = {websocket::close_code::policy_error, why};
    session_->close();
  }

  awaitable<std::optional<std::string>> next_answer(unsigned version) {
    const auto& clock = connections_->gateway->clock();
    auto next_sign = clock.now();
    std::optional<std::string> answer;
    while (!answer && !session_->is_closed()) {
      answer = session_->next_answer();
      if (answer) break;
      co_await session_->output().wait_for(hang_up_check_interval);
      const auto seen = wire_.hang_up_events();
      constexpr short gone = POLLHUP | POLLERR | POLLNVAL;
      // Clients do not end the output of TLS alone, and the oldest do not know interim answers.
      const bool can_be_asked = !tls_ && version >= version_1_1;
      if ((seen & gone) != 0 || (seen != 0 && !can_be_asked)) session_->close();
      if (seen == 0 || session_->is_closed() || clock.now() < next_sign) continue;
      next_sign = clock.now() + time_between_signs;
      co_await say_that_it_goes_on();
    }
    co_return answer;
  }

  /// To a client that sends nothing any more: one that still reads goes on waiting, and of one that
  /// has gone the connection breaks.
  awaitable<void> say_that_it_goes_on() {
    const bool is_sent = co_await wire_.send_interim(http::status::processing, version_1_1);
    if (!is_sent) session_->close();
  }

  // ---- WebSocket ----

  awaitable<void> serve_websocket(Request request, const HttpEntry& entry) {
    if (!connections_->let_in(id_)) {
      const auto refusal = too_many_clients();
      co_await wire_.refuse(refusal);
      co_return;
    }
    // RFC 6455, 4.1: it waits for the answer. Beast would take it for the first message.
    if (wire_.buffer().size() != 0) {
      const auto refusal =
          not_now("data_before_upgrade", "a WebSocket begins with the answer to the request for it",
                  "send nothing before that has come");
      co_await wire_.refuse(refusal);
      co_return;
    }
    // It has timers of its own.
    wire_.lowest().expires_never();
    wire_.begin_websocket();
    auto& socket = *wire_.websocket();
    set_up(socket, entry);
    error_code error;
    co_await socket.async_accept(request, redirect_error(use_awaitable, error));
    if (error) co_return;
    if (session_) session_->close();
    session_.reset();
    // The answer may have taken a while: its token may be revoked by now.
    const auto still = connections_->admit(head_of(request), info_);
    if (!still) {
      farewell_ = {websocket::close_code::policy_error, still.error().name};
      co_await socket.async_close(farewell_, redirect_error(use_awaitable, error));
      co_return;
    }
    begin_session(*still, "websocket", Session::Serves::all);
    session_->greet();
    if (is_finishing_) session_->finish();
    const auto self = shared_from_this();
    spawn(executor(), write(self), [self](const auto& failure) { self->fail(failure); });
    co_await read();
    session_->close();
  }

  static void set_up(HttpWire::WebSocket& socket, const HttpEntry& entry) {
    websocket::stream_base::timeout times{time_for_handshake, time_without_sign, true};
    socket.set_option(times);
    socket.set_option(
        websocket::stream_base::decorator([protocol = entry.protocol](auto& response) {
          response.set(http::field::server, "tmcld");
          if (!protocol.empty()) response.set(http::field::sec_websocket_protocol, protocol);
        }));
    socket.read_message_max(max_line_bytes);
    socket.text(true);
  }

  awaitable<void> read() {
    auto& socket = *wire_.websocket();
    auto& buffer = wire_.buffer();
    error_code error;
    while (!session_->is_closed()) {
      co_await socket.async_read(buffer, redirect_error(use_awaitable, error));
      if (error) break;
      if (!socket.got_text()) {
        farewell_ = {websocket::close_code::unknown_data, "messages are text"};
        break;
      }
      const auto bytes = buffer.data();
      session_->take(std::string_view(static_cast<const char*>(bytes.data()), bytes.size()));
      buffer.consume(bytes.size());
      if (buffer.capacity() > kept_buffer_bytes) buffer.shrink_to_fit();
    }
  }

  // ---- answers ----

  awaitable<bool> respond(const Request& request, const char* type, std::string body) {
    auto response =
        response_of(200, type, std::move(body), request.version(), request.keep_alive());
    const bool goes_on = co_await wire_.send(response);
    co_return goes_on;
  }

  awaitable<void> refuse_head(const std::string& objection) {
    const auto refusal = not_now("bad_head", objection, "send each field once, on one line");
    co_await wire_.refuse(refusal);
  }

  awaitable<void> refuse_unreadable(error_code why) {
    if (why == http::error::header_limit) {
      const auto refusal = not_now("head_too_long", "the head of a request may have 8192 bytes");
      co_await wire_.refuse(refusal);
    } else if (why == http::error::body_limit || why == http::error::buffer_overflow) {
      const auto refusal = not_now(
          "message_too_long", "a message may have " + std::to_string(max_line_bytes) + " bytes",
          "nothing of it was done");
      co_await wire_.refuse(refusal);
    } else if (why.category() == make_error_code(http::error::bad_method).category() &&
               why != http::error::end_of_stream && why != http::error::partial_message) {
      const auto refusal = not_now("no_http", "this is no request by HTTP: " + why.message(),
                                   "is it https:// to a port without TLS?");
      co_await wire_.refuse(refusal);
    }
  }

  void log_refusal(const std::string& what) {
    connections_->gateway->log_often("http refused", LogLevel::warning,
                                     "a client at " + info_.peer + " " + what);
  }

  /// A client that only goes away is not reported.
  void log_tls(error_code why) {
    if (why.category() != asio::error::get_ssl_category()) return;
    log_refusal("was not let in by TLS: " +
                tls_error_text(static_cast<unsigned long>(why.value())));
  }

  // ---- the connection itself ----

  asio::any_io_executor executor() { return wire_.executor(); }
  void end() {
    if (session_) session_->close();
    // The writer of a WebSocket says farewell, and closes it then.
    if (!wire_.websocket() || !session_) wire_.close();
    connections_->remove(id_);
  }
  void fail(const std::exception_ptr& failure) {
    close();
    connections_->gateway->log_failure("a client's connection, which was closed", failure);
    connections_->remove(id_);
  }

  HttpWire wire_;
  std::shared_ptr<ssl::context> tls_;
  std::shared_ptr<HttpConnections> connections_;
  std::uint64_t id_;
  HttpConnectionInfo info_;
  std::shared_ptr<HttpSession> session_;
  std::string token_;          ///< By which that was let in; empty: by none.
  std::uint64_t sign_in_ = 0;  ///< By the cookie of which; 0: by none.
  websocket::close_reason farewell_{websocket::close_code::going_away};
  std::optional<tmcl::TimePoint> idle_since_;  ///< Nothing while a request is served.
  bool is_serving_ = false;
  bool is_writing_ = false;
  bool is_finishing_ = false;
};

}  // namespace

void begin_http_connection(Tcp::socket socket, std::shared_ptr<ssl::context> tls,
                           HttpConnectionInfo info, std::shared_ptr<HttpConnections> connections) {
  const auto id = connections->add(info.network);
  WebStream stream{beast::tcp_stream(std::move(socket))};
  const auto connection = std::make_shared<StreamConnection>(std::move(stream), std::move(tls),
                                                             connections, id, std::move(info));
  connections->set(id, connection);
  connection->start();
}

}  // namespace tmcld
