/// A connection to tmcld, by which many calls are made at once: the channels of tmcl/client.hpp
/// wait for each. Errors are those of tmcl::client.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/json/object.hpp>

#include "async/wake.hpp"
#include "tmcl/client_error.hpp"

namespace tmclmqtt {

using tmcl::client::Result;

class GatewayLink : public std::enable_shared_from_this<GatewayLink> {
 public:
  using OnAnswer = std::function<void(Result<boost::json::object> answer)>;
  using OnNotification =
      std::function<void(std::string_view method, const boost::json::object& params)>;

  /// Calls in progress.
  static constexpr std::size_t most_calls = 128;

  /// Once tmcld has greeted. Errors: daemon_unreachable, daemon_incompatible.
  static boost::asio::awaitable<Result<std::shared_ptr<GatewayLink>>> open(
      std::string path, OnNotification on_notification = {});

  /// The answer comes in a later turn, and always: at the latest when the connection ends.
  void call(std::string_view method, boost::json::object params, OnAnswer on_answer);
  boost::asio::awaitable<Result<boost::json::object>> call(std::string_view method,
                                                           boost::json::object params);
  const std::string& daemon_version() const { return version_; }
  std::size_t calls_in_progress() const { return waiting_.size(); }
  bool is_lost() const { return lost_; }
  /// Until it is lost, or closed.
  boost::asio::awaitable<void> end();
  void close();

  GatewayLink(const boost::asio::any_io_executor& executor, OnNotification on_notification);

 private:
  static boost::asio::awaitable<void> read(std::shared_ptr<GatewayLink> self);
  static boost::asio::awaitable<void> write(std::shared_ptr<GatewayLink> self);

  /// `begun`: what came of a line before. False if it is too long, or as take().
  bool take_lines(std::string& begun, std::string_view bytes);
  /// False if it is no message of tmcld's.
  bool take(std::string_view line);
  bool take_greeting(const boost::json::object& params);

  boost::asio::local::stream_protocol::socket socket_;
  OnNotification on_notification_;
  std::string unsent_;
  tmcld::Wake has_output_;
  tmcld::Wake changed_;
  std::map<std::int64_t, OnAnswer> waiting_;
  std::int64_t last_id_ = 0;
  std::string version_;
  bool greeted_ = false;
  bool lost_ = false;
};

}  // namespace tmclmqtt
