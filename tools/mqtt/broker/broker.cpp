#include "broker/broker.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <utility>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/elsewhere.hpp"
#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "async/wake.hpp"

namespace tmclmqtt {
namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::posix::stream_descriptor;

// A broker that has fallen silent is noticed after one and a half of it.
constexpr int keep_alive_s = 10;
constexpr auto housekeeping_interval = std::chrono::seconds(1);
constexpr const char* authorities_of_system = "/etc/ssl/certs";

/// Calls of libmosquitto's are allowed from any thread, but here from one at a time.
void begin_library() {
  static const int begun = ::mosquitto_lib_init();
  (void)begun;
}

class Properties {
 public:
  Properties() = default;
  Properties(const Properties&) = delete;
  Properties& operator=(const Properties&) = delete;
  ~Properties() { ::mosquitto_property_free_all(&list_); }

  void add_number(int id, std::uint32_t value) {
    ::mosquitto_property_add_int32(&list_, id, value);
  }
  void add_text(int id, const std::string& text) {
    ::mosquitto_property_add_string(&list_, id, text.c_str());
  }
  void add_bytes(int id, const std::string& bytes) {
    ::mosquitto_property_add_binary(&list_, id, bytes.data(),
                                    static_cast<std::uint16_t>(bytes.size()));
  }
  const mosquitto_property* list() const { return list_; }
  /// For a function that frees them.
  mosquitto_property* release() { return std::exchange(list_, nullptr); }

 private:
  mosquitto_property* list_ = nullptr;
};

std::string text_property(const mosquitto_property* list, int id) {
  char* text = nullptr;
  if (::mosquitto_property_read_string(list, id, &text, false) == nullptr) return {};
  std::string result(text);
  std::free(text);
  return result;
}

std::string bytes_property(const mosquitto_property* list, int id) {
  void* bytes = nullptr;
  std::uint16_t size = 0;
  if (::mosquitto_property_read_binary(list, id, &bytes, &size, false) == nullptr) return {};
  std::string result(static_cast<const char*>(bytes), size);
  std::free(bytes);
  return result;
}

std::optional<std::uint32_t> number_property(const mosquitto_property* list, int id) {
  std::uint32_t value = 0;
  if (::mosquitto_property_read_int32(list, id, &value, false) == nullptr) return std::nullopt;
  return value;
}

Message message_of(const mosquitto_message& came, const mosquitto_property* properties) {
  return {came.topic,
          std::string(static_cast<const char*>(came.payload),
                      static_cast<std::size_t>(came.payloadlen)),
          came.retain,
          number_property(properties, MQTT_PROP_MESSAGE_EXPIRY_INTERVAL),
          text_property(properties, MQTT_PROP_RESPONSE_TOPIC),
          bytes_property(properties, MQTT_PROP_CORRELATION_DATA)};
}

class MosquittoBroker final : public Broker, public std::enable_shared_from_this<MosquittoBroker> {
 public:
  MosquittoBroker(const boost::asio::any_io_executor& executor, BrokerOptions options,
                  OnMessage on_message, std::function<void()> on_room);
  MosquittoBroker(const MosquittoBroker&) = delete;
  MosquittoBroker& operator=(const MosquittoBroker&) = delete;
  ~MosquittoBroker() override;

  std::string prepare();
  /// Blocks. Gives what is wrong; empty if nothing is.
  std::string connect();
  /// On the reactor again: until the broker has let it in.
  awaitable<std::string> wait_until_let_in();

  void subscribe(const Subscribed& to) override;
  Sent publish(const Publication& publication) override;
  bool has_room() const override { return !lost_ && !::mosquitto_want_write(client_); }
  awaitable<std::string> end() override;
  void disconnect() override;

 private:
  static MosquittoBroker& of(void* self) { return *static_cast<MosquittoBroker*>(self); }
  static awaitable<void> read(std::shared_ptr<MosquittoBroker> self);
  static awaitable<void> write(std::shared_ptr<MosquittoBroker> self);
  static awaitable<void> keep_house(std::shared_ptr<MosquittoBroker> self);

  std::string sign_in();
  std::string text_of(int error) const;
  std::string text_of_refusal(int reason) const;
  void note(int error);
  void lose(std::string why);
  void hand_out();

  boost::asio::any_io_executor executor_;
  BrokerOptions options_;
  OnMessage on_message_;
  std::function<void()> on_room_;
  mosquitto* client_ = nullptr;
  stream_descriptor descriptor_;
  std::deque<Message> came_;  ///< During a call of the library's.
  tmcld::Wake has_output_;
  tmcld::Wake changed_;
  bool is_let_in_ = false;
  bool lost_ = false;
  std::string why_;
  std::string tls_error_;  ///< What the library has logged of it last.
};

/// Of a line that the library logs; empty: it is about something else.
std::string tls_error_in(std::string_view line) {
  if (!line.starts_with("OpenSSL Error")) return {};
  return std::string(line.substr(line.rfind(':') + 1));
}

MosquittoBroker::MosquittoBroker(const boost::asio::any_io_executor& executor,
                                 BrokerOptions options, OnMessage on_message,
                                 std::function<void()> on_room)
    : executor_(executor),
      options_(std::move(options)),
      on_message_(std::move(on_message)),
      on_room_(std::move(on_room)),
      descriptor_(executor),
      has_output_(executor),
      changed_(executor) {}

MosquittoBroker::~MosquittoBroker() {
  // The library closes what is the library's.
  if (descriptor_.is_open()) descriptor_.release();
  if (client_ != nullptr) ::mosquitto_destroy(client_);
}

std::string MosquittoBroker::prepare() {
  begin_library();
  client_ = ::mosquitto_new(options_.client_id.c_str(), true, this);
  if (client_ == nullptr) return "libmosquitto makes no client";
  ::mosquitto_int_option(client_, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
  ::mosquitto_int_option(client_, MOSQ_OPT_TCP_NODELAY, 1);
  int error = MOSQ_ERR_SUCCESS;
  if (const auto& will = options_.will) {
    Properties of_will;
    of_will.add_number(MQTT_PROP_WILL_DELAY_INTERVAL, options_.will_delay_s);
    error = ::mosquitto_will_set_v5(client_, will->topic.c_str(),
                                    static_cast<int>(will->payload.size()), will->payload.data(),
                                    will->qos, will->retained, of_will.release());
  }
  const auto file = [](const std::string& path) { return path.empty() ? nullptr : path.c_str(); };
  if (error == MOSQ_ERR_SUCCESS && (!options_.ca.empty() || options_.trusts_system)) {
    error = ::mosquitto_tls_set(client_, file(options_.ca),
                                options_.ca.empty() ? authorities_of_system : nullptr,
                                file(options_.certificate), file(options_.key), nullptr);
  }
  if (error != MOSQ_ERR_SUCCESS) return "libmosquitto: " + std::string(::mosquitto_strerror(error));
  ::mosquitto_log_callback_set(client_, [](mosquitto*, void* self, int, const char* line) {
    if (auto why = tls_error_in(line); !why.empty()) of(self).tls_error_ = std::move(why);
  });
  ::mosquitto_connect_v5_callback_set(
      client_, [](mosquitto*, void* self, int reason, int, const mosquitto_property*) {
        if (reason != 0) return of(self).lose(of(self).text_of_refusal(reason));
        of(self).is_let_in_ = true;
        of(self).changed_.notify();
      });
  ::mosquitto_disconnect_v5_callback_set(
      client_, [](mosquitto*, void* self, int reason, const mosquitto_property*) {
        of(self).lose(reason >= MQTT_RC_UNSPECIFIED ? ::mosquitto_reason_string(reason)
                                                    : ::mosquitto_strerror(reason));
      });
  ::mosquitto_message_v5_callback_set(client_,
                                      [](mosquitto*, void* self, const mosquitto_message* came,
                                         const mosquitto_property* properties) {
                                        of(self).came_.push_back(message_of(*came, properties));
                                      });
  return {};
}

/// Blocks. Gives what is wrong; empty if nothing is.
std::string MosquittoBroker::sign_in() {
  if (options_.user.empty()) return {};
  tl::expected<std::string, std::string> password;
  if (options_.password) password = options_.password();
  if (!password) return std::move(password.error());
  const int error = ::mosquitto_username_pw_set(client_, options_.user.c_str(),
                                                password->empty() ? nullptr : password->c_str());
  return error == MOSQ_ERR_SUCCESS ? std::string() : text_of(error);
}

std::string MosquittoBroker::connect() {
  if (auto problem = sign_in(); !problem.empty()) return problem;
  Properties properties;
  properties.add_number(MQTT_PROP_MAXIMUM_PACKET_SIZE, options_.max_packet_bytes);
  const int error = ::mosquitto_connect_bind_v5(client_, options_.host.c_str(), options_.port,
                                                keep_alive_s, nullptr, properties.list());
  return error == MOSQ_ERR_SUCCESS ? std::string() : text_of(error);
}

awaitable<std::string> MosquittoBroker::wait_until_let_in() {
  descriptor_.assign(::mosquitto_socket(client_));
  const auto self = shared_from_this();
  tmcld::spawn(executor_, read(self));
  tmcld::spawn(executor_, write(self));
  tmcld::spawn(executor_, keep_house(self));
  const auto deadline = tmcl::ContextClock(executor_).now() + options_.time_to_be_let_in;
  while (!is_let_in_ && !lost_ && tmcl::ContextClock(executor_).now() < deadline)
    co_await changed_.wait_until(deadline);
  if (!is_let_in_) lose("it accepts the connection and then says nothing");
  co_return lost_ ? why_ : std::string();
}

// ---- input and output --------------------------------------------------------------------------

awaitable<void> MosquittoBroker::read(std::shared_ptr<MosquittoBroker> self) {
  while (!self->lost_) {
    boost::system::error_code error;
    co_await self->descriptor_.async_wait(stream_descriptor::wait_read,
                                          redirect_error(use_awaitable, error));
    if (error || self->lost_) break;
    self->note(::mosquitto_loop_read(self->client_, 1));
    self->hand_out();
    self->has_output_.notify();
  }
}

awaitable<void> MosquittoBroker::write(std::shared_ptr<MosquittoBroker> self) {
  while (!self->lost_) {
    if (!::mosquitto_want_write(self->client_)) {
      co_await self->has_output_.wait();
      continue;
    }
    boost::system::error_code error;
    co_await self->descriptor_.async_wait(stream_descriptor::wait_write,
                                          redirect_error(use_awaitable, error));
    if (error || self->lost_) break;
    self->note(::mosquitto_loop_write(self->client_, 1));
    if (self->has_room()) self->on_room_();
  }
}

awaitable<void> MosquittoBroker::keep_house(std::shared_ptr<MosquittoBroker> self) {
  while (!self->lost_) {
    co_await tmcld::rest(housekeeping_interval);
    if (self->lost_) break;
    // The library would take a handshake that lasts for silence.
    if (!self->is_let_in_) continue;
    self->note(::mosquitto_loop_misc(self->client_));
    self->has_output_.notify();
  }
}

/// The library calls back about messages while it reads; what they lead to is published after that.
void MosquittoBroker::hand_out() {
  while (!came_.empty() && !lost_) {
    auto message = std::move(came_.front());
    came_.pop_front();
    on_message_(std::move(message));
  }
}

/// The library calls every error of TLS by one name.
std::string MosquittoBroker::text_of(int error) const {
  if (error == MOSQ_ERR_EAI) return "its name is not known";
  if (error == MOSQ_ERR_ERRNO) return std::strerror(errno);
  if (error == MOSQ_ERR_TLS && !tls_error_.empty()) return "TLS: " + tls_error_;
  return ::mosquitto_strerror(error);
}

/// Brokers say one of two things of a wrong password, of a user whom they do not know, and of a
/// client that shows them nothing.
std::string MosquittoBroker::text_of_refusal(int reason) const {
  const std::string said = ::mosquitto_reason_string(reason);
  if (reason != MQTT_RC_NOT_AUTHORIZED && reason != MQTT_RC_BAD_USERNAME_OR_PASSWORD) return said;
  if (!options_.user.empty())
    return said + ": does it know the user '" + options_.user + "', and is the password right?";
  if (options_.certificate.empty())
    return said + ": it wants a user name and a password, or a certificate";
  return said + ": does it take the name in the certificate, or want a user name and a password?";
}

void MosquittoBroker::note(int error) {
  if (error != MOSQ_ERR_SUCCESS) lose(text_of(error));
}

void MosquittoBroker::lose(std::string why) {
  if (std::exchange(lost_, true)) return;
  why_ = std::move(why);
  // The library has closed it, or does so when it ends.
  if (descriptor_.is_open()) descriptor_.release();
  has_output_.notify();
  changed_.notify();
}

// ---- for others --------------------------------------------------------------------------------

void MosquittoBroker::subscribe(const Subscribed& to) {
  if (lost_) return;
  const int options = (to.own ? 0 : MQTT_SUB_OPT_NO_LOCAL) | MQTT_SUB_OPT_RETAIN_AS_PUBLISHED |
                      MQTT_SUB_OPT_SEND_RETAIN_ALWAYS;
  note(::mosquitto_subscribe_v5(client_, nullptr, to.filter.c_str(), to.qos, options, nullptr));
  has_output_.notify();
}

Broker::Sent MosquittoBroker::publish(const Publication& publication) {
  if (lost_) return Sent::no;
  Properties properties;
  if (publication.expiry_s)
    properties.add_number(MQTT_PROP_MESSAGE_EXPIRY_INTERVAL, *publication.expiry_s);
  if (!publication.response_topic.empty())
    properties.add_text(MQTT_PROP_RESPONSE_TOPIC, publication.response_topic);
  if (!publication.correlation.empty())
    properties.add_bytes(MQTT_PROP_CORRELATION_DATA, publication.correlation);
  const int error = ::mosquitto_publish_v5(
      client_, nullptr, publication.topic.c_str(), static_cast<int>(publication.payload.size()),
      publication.payload.data(), publication.qos, publication.retained, properties.list());
  has_output_.notify();
  if (error == MOSQ_ERR_OVERSIZE_PACKET || error == MOSQ_ERR_PAYLOAD_SIZE) return Sent::too_long;
  note(error);
  return error == MOSQ_ERR_SUCCESS ? Sent::yes : Sent::no;
}

awaitable<std::string> MosquittoBroker::end() {
  while (!lost_) co_await changed_.wait();
  co_return why_;
}

void MosquittoBroker::disconnect() {
  if (lost_) return;
  const int reason = options_.will_at_end ? MQTT_RC_DISCONNECT_WITH_WILL_MSG : 0;
  ::mosquitto_disconnect_v5(client_, reason, nullptr);
  lose("ended");
}

}  // namespace

awaitable<Connected> connect_to_broker(tmcld::Workers& workers, BrokerOptions options,
                                       Broker::OnMessage on_message,
                                       std::function<void()> on_room) {
  const auto executor = co_await boost::asio::this_coro::executor;
  const auto broker = std::make_shared<MosquittoBroker>(executor, std::move(options),
                                                        std::move(on_message), std::move(on_room));
  if (auto problem = broker->prepare(); !problem.empty()) co_return tl::unexpected(problem);
  auto connecting = [broker] { return broker->connect(); };
  auto problem = co_await tmcld::elsewhere(workers, std::move(connecting));
  if (problem.empty()) problem = co_await broker->wait_until_let_in();
  if (!problem.empty()) co_return tl::unexpected(problem);
  std::shared_ptr<Broker> connected = broker;
  co_return connected;
}

}  // namespace tmclmqtt
