/// Takes in clients by HTTP and WebSocket, with and without TLS.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <tl/expected.hpp>

#include "config/http_config.hpp"
#include "fronts/front_share.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// What is wrong with the files of [http]: sentences for a person. Reads them.
std::vector<std::string> problems_of_files(const HttpConfig& config);

/// What would make them better: sentences for a person. Reads them, too.
std::vector<std::string> advice_on_files(const HttpConfig& config);

class HttpServer {
 public:
  /// Listens, but serves no client yet; at most `clients`. Errors: a sentence, with what
  /// to try.
  static tl::expected<std::shared_ptr<HttpServer>, std::string> create(
      const boost::asio::any_io_executor& executor, const HttpConfig& config,
      std::shared_ptr<Gateway> gateway, std::shared_ptr<FrontShare> share, std::size_t clients);
  virtual ~HttpServer() = default;

  virtual void start() = 0;
  virtual void stop_accepting() = 0;
  /// Lets every client have its answers, and then closes its connection.
  virtual void finish_sessions() = 0;
  virtual void close_sessions() = 0;
  /// As UnixServer::review_rights().
  virtual void review_rights() = 0;
  /// Waits for what other threads do for it.
  virtual void join() = 0;
  virtual std::size_t connections() const = 0;
  /// "https://127.0.0.1:4143", one for each address.
  virtual std::vector<std::string> addresses() const = 0;
};

}  // namespace tmcld
