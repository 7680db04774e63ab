// TLS handshakes: computed on another thread than the reactor's, and in turns.
#include "fronts/handshakes.hpp"

#include <set>
#include <thread>

#include <openssl/evp.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <sys/socket.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/ssl/context.hpp>

#include <gmock/gmock.h>

#include "fronts/http_connection.hpp"
#include "fronts/http_connections.hpp"
#include "log/sink.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmcld::test {
namespace {

namespace asio = boost::asio;
using testing::StartsWith;
using Tcp = asio::ip::tcp;

/// For a certificate that vouches for itself.
void give_certificate(SSL_CTX* context) {
  const std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)> key(EVP_RSA_gen(2048), EVP_PKEY_free);
  const std::unique_ptr<X509, void (*)(X509*)> certificate(X509_new(), X509_free);
  constexpr long day_s = 86'400;
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -day_s);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), day_s);
  X509_set_pubkey(certificate.get(), key.get());
  X509_sign(certificate.get(), key.get(), EVP_sha256());
  SSL_CTX_use_certificate(context, certificate.get());
  SSL_CTX_use_PrivateKey(context, key.get());
}

/// Where what OpenSSL does in a handshake is done. Of one thread at a time.
std::set<std::thread::id> threads_of_handshakes;
void note_thread(const SSL*, int, int) { threads_of_handshakes.insert(std::this_thread::get_id()); }

class HttpsServer : public testing::Test {
 protected:
  HttpsServer() {
    threads_of_handshakes.clear();
    give_certificate(tls->native_handle());
    SSL_CTX_set_info_callback(tls->native_handle(), note_thread);
    share->tokens = Tokens::open("", no_log);
  }
  ~HttpsServer() override {
    for (const auto& one : connections->all()) one->close();
    context.restart();
    context.poll();
    connections->handshakes.join();
    gateway->close();
  }

  /// The other end of a connection that is served.
  int connect() {
    Tcp::acceptor acceptor(context, {asio::ip::address_v4::loopback(), 0});
    Tcp::socket client(context);
    client.connect(acceptor.local_endpoint());
    HttpConnectionInfo info{"127.0.0.1:5", "127.0.0.1", true, true, 4143};
    begin_http_connection(acceptor.accept(), tls, std::move(info), connections);
    return client.release();
  }
  void serve_while(const std::function<void(int)>& client) {
    const int socket = connect();
    std::atomic<bool> has_ended = false;
    std::thread thread([&] {
      client(socket);
      ::close(socket);
      has_ended = true;
    });
    while (!has_ended) {
      context.restart();
      context.run_for(std::chrono::milliseconds(10));
    }
    thread.join();
  }

  asio::io_context context{1};
  std::shared_ptr<Gateway> gateway = Gateway::create(context.get_executor(), Config{});
  std::shared_ptr<FrontShare> share = std::make_shared<FrontShare>();
  std::shared_ptr<HttpConnections> connections =
      std::make_shared<HttpConnections>(context.get_executor(), gateway, share, HttpConfig{}, 100);
  std::shared_ptr<asio::ssl::context> tls =
      std::make_shared<asio::ssl::context>(asio::ssl::context::tls_server);
};

std::string healthz_by_tls(int socket, int version) {
  const std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context(SSL_CTX_new(TLS_client_method()),
                                                             SSL_CTX_free);
  SSL_CTX_set_max_proto_version(context.get(), version);
  const std::unique_ptr<SSL, void (*)(SSL*)> ssl(SSL_new(context.get()), SSL_free);
  SSL_set_fd(ssl.get(), socket);
  if (SSL_connect(ssl.get()) != 1) return "no handshake";
  const std::string request = "GET /healthz HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n";
  SSL_write(ssl.get(), request.data(), static_cast<int>(request.size()));
  std::string said;
  std::array<char, 1000> bytes{};
  for (int count = 1; count > 0;) {
    count = SSL_read(ssl.get(), bytes.data(), static_cast<int>(bytes.size()));
    if (count > 0) said.append(bytes.data(), static_cast<std::size_t>(count));
  }
  return said;
}

TEST_F(HttpsServer, MakesNoHandshakeOnTheThreadOfTheReactor) {
  for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
    std::string said;
    serve_while([&](int socket) { said = healthz_by_tls(socket, version); });
    EXPECT_THAT(said, StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(said, testing::HasSubstr("ok"));
  }
  EXPECT_EQ(threads_of_handshakes.size(), 1U);
  EXPECT_FALSE(threads_of_handshakes.contains(std::this_thread::get_id()));
}

TEST_F(HttpsServer, OutlivesHandshakesThatAreNone) {
  tmcl::test::Random random(tmcl::test::seed());
  for (int i = 0; i < 50; ++i) {
    serve_while([&](int socket) {
      // The head of a record, which may be the first of a handshake, and anything.
      std::string bytes("\x16\x03\x01\x00\x10\x01\x00\x00\x0C", 9);
      bytes[4] = static_cast<char>(random.between(0, 255));
      for (auto left = random.between(0, 300); left > 0; --left)
        bytes += static_cast<char>(random.between(0, 255));
      ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      ::shutdown(socket, SHUT_WR);
      std::array<char, 1000> answer{};
      while (::recv(socket, answer.data(), answer.size(), 0) > 0) {
      }
    });
  }
  std::string said;
  serve_while([&](int socket) { said = healthz_by_tls(socket, TLS1_3_VERSION); });
  EXPECT_THAT(said, StartsWith("HTTP/1.1 200"));
}

// ---- turns -------------------------------------------------------------------------------------

TEST(FairTurns, AreOfOneGroupAfterTheOther) {
  asio::io_context context;
  FairTurns turns(context.get_executor());
  std::string order;
  const auto take = [&](std::string group) -> asio::awaitable<void> {
    co_await turns.take(group);
    order += group;
    turns.give_back();
  };
  const auto first = [&]() -> asio::awaitable<void> { co_await turns.take("first"); };
  asio::co_spawn(context, first, asio::detached);
  context.poll();
  for (const auto* group : {"a", "a", "a", "a", "b", "c", "c"})
    asio::co_spawn(context, take(group), asio::detached);
  context.restart();
  context.poll();
  EXPECT_EQ(order, "");
  turns.give_back();
  context.restart();
  context.run();
  EXPECT_EQ(order, "abcacaa");
}

}  // namespace
}  // namespace tmcld::test
