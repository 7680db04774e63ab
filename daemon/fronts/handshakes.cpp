#include "fronts/handshakes.hpp"

#include <array>
#include <cstddef>
#include <memory>
#include <utility>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>

#include "async/elsewhere.hpp"

namespace tmcld {
namespace {

namespace asio = boost::asio;
using asio::awaitable;
using asio::redirect_error;
using asio::use_awaitable;
using boost::system::error_code;

// Of TLS: what a record has in front of its content, and the most that it can have of that.
constexpr std::size_t record_head_bytes = 5;
constexpr std::size_t most_record_bytes = 16384 + 2048;

// ---- on the worker ----

struct Step {
  std::string to_send{};
  bool is_done = false;
  bool has_failed = false;
  unsigned long error = 0;  ///< Of OpenSSL.
};

std::string all_of(BIO* bio) {
  std::string bytes(BIO_ctrl_pending(bio), '\0');
  const int count = BIO_read(bio, bytes.data(), static_cast<int>(bytes.size()));
  bytes.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  return bytes;
}

Step take_step(SSL* ssl, const std::string& record) {
  ERR_clear_error();
  BIO_write(SSL_get_rbio(ssl), record.data(), static_cast<int>(record.size()));
  const int result = SSL_do_handshake(ssl);
  const int why = SSL_get_error(ssl, result);
  Step step;
  step.is_done = result == 1;
  step.has_failed = !step.is_done && why != SSL_ERROR_WANT_READ;
  step.error = ERR_peek_last_error();
  ERR_clear_error();
  step.to_send = all_of(SSL_get_wbio(ssl));
  return step;
}

// ---- on the reactor ----

struct FreeBio {
  void operator()(BIO* bio) const { BIO_free(bio); }
};

/// Lets the handshake read and write memory; gives the stream back what it reads and writes then.
class InMemory {
 public:
  explicit InMemory(SSL* ssl) : ssl_(ssl), of_stream_(SSL_get_rbio(ssl)) {
    BIO_up_ref(of_stream_.get());
    SSL_set_bio(ssl, BIO_new(BIO_s_mem()), BIO_new(BIO_s_mem()));
    SSL_set_accept_state(ssl);
  }
  void give_back() {
    auto* bio = of_stream_.release();
    SSL_set_bio(ssl_, bio, bio);
  }

 private:
  SSL* ssl_;
  std::unique_ptr<BIO, FreeBio> of_stream_;
};

/// How long the record is that begins so; of its head, if that is not there yet.
std::size_t record_bytes(const std::string& begin) {
  if (begin.size() < record_head_bytes) return record_head_bytes;
  const auto byte = [&](std::size_t at) {
    return std::size_t{static_cast<unsigned char>(begin[at])};
  };
  return record_head_bytes + (byte(3) << 8U | byte(4));
}

/// The next record and nothing behind it; `received` has the beginning.
awaitable<std::string> read_record(WebStream::Tcp& tcp, std::string& received, error_code& error) {
  while (received.size() < record_bytes(received) && !error) {
    const auto have = received.size();
    received.resize(record_bytes(received));
    const auto count =
        co_await asio::async_read(tcp, asio::buffer(received.data() + have, received.size() - have),
                                  redirect_error(use_awaitable, error));
    received.resize(have + count);
    if (record_bytes(received) > record_head_bytes + most_record_bytes)
      error = asio::error::message_size;
  }
  if (error) co_return std::string();
  auto record = received.substr(0, record_bytes(received));
  received.erase(0, record.size());
  co_return record;
}

error_code error_of(const Step& step) {
  if (step.error == 0) return asio::error::connection_reset;
  return {static_cast<int>(step.error), asio::error::get_ssl_category()};
}

}  // namespace

awaitable<error_code> Handshakes::perform(WebStream& stream, std::string received,
                                          std::string network) {
  struct Turn {
    Handshakes& of;
    ~Turn() {
      if (!of.has_ended_) of.turns_.give_back();
    }
  };
  auto& tcp = stream.next_layer();
  // The worker may outlive this connection.
  SSL_up_ref(stream.native_handle());
  const std::shared_ptr<SSL> ssl(stream.native_handle(), SSL_free);
  InMemory memory(ssl.get());
  error_code error;
  while (true) {
    auto record = co_await read_record(tcp, received, error);
    if (error) co_return error;
    Step step;
    {
      co_await turns_.take(network);
      const Turn turn{*this};
      if (!tcp.socket().is_open()) co_return error_code(asio::error::operation_aborted);
      auto work = [ssl, record = std::move(record)] { return take_step(ssl.get(), record); };
      step = co_await elsewhere(worker_, std::move(work));
    }
    // Also the alert that says what is wrong.
    if (!step.to_send.empty())
      co_await asio::async_write(tcp, asio::buffer(step.to_send),
                                 redirect_error(use_awaitable, error));
    if (step.has_failed) co_return error_of(step);
    if (error) co_return error;
    if (step.is_done) break;
  }
  // A client cannot have sent anything behind what it had not been answered.
  if (!received.empty()) co_return error_code(asio::error::message_size);
  memory.give_back();
  co_return error_code();
}

void Handshakes::join() {
  has_ended_ = true;
  worker_.join();
}

}  // namespace tmcld
