/// A gateway in the caller's own process: the methods of tmcld, without a socket.
///
///     auto gateway = LocalGateway::open(config, {});
///     if (!gateway) return report(gateway.error());
///     LocalGateway& local = **gateway;
///     local.on_notification(print);
///
///     const auto state = local.call("axis.get_state", {{"axis", "x"}});
///
///     auto path = local.begin("path.run", params);
///     while (!path.has_ended()) {
///       local.listen(100ms);
///       if (is_interrupted()) report(local.call("path.stop", {{"axes", axes}}));
///     }
///     report(path.result());
///     local.end();
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/json/object.hpp>

#include "api/error.hpp"
#include "config/config.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

class LocalPeer;

/// A call in progress. May outlive its gateway, but ends only while that is listened to.
class LocalCall {
 public:
  bool has_ended() const { return result_->has_value(); }
  /// Only of a call that has ended.
  const Result<boost::json::object>& result() const { return **result_; }

 private:
  friend class LocalGateway;
  std::shared_ptr<std::optional<Result<boost::json::object>>> result_ =
      std::make_shared<std::optional<Result<boost::json::object>>>();
};

/// One client, on one thread: everything happens in call(), listen() and end(). A program
/// that does something else calls listen() from time to time while an axis is on a line or path.
///
/// Destroying it closes the links at once: motors go on as they do without a host, and calls in
/// progress never end. See end().
/// Throws only for bugs, and where memory is missing; end() is the thing to do then.
class LocalGateway {
 public:
  using OnNotification =
      std::function<void(std::string_view method, const boost::json::object& params)>;

  /// Opens all links; blocks until they are open. Nothing else runs the context, which may be on
  /// virtual time.
  /// Errors: those of tmcl::Link::open() for the first that cannot be opened.
  static tmcl::Result<std::unique_ptr<LocalGateway>> open(
      const Config& config, GatewayOptions options,
      std::shared_ptr<boost::asio::io_context> context =
          std::make_shared<boost::asio::io_context>(1));
  LocalGateway(const LocalGateway&) = delete;
  LocalGateway& operator=(const LocalGateway&) = delete;
  ~LocalGateway();

  /// Called by call(), listen() and end(), between turns of the reactor: it may make calls.
  void on_notification(OnNotification handler) { on_notification_ = std::move(handler); }

  /// Begins a call of a method as a client of tmcld would make it; any number at a time.
  LocalCall begin(std::string_view method, boost::json::object params);
  /// Waits for its end. `meanwhile` is called every few milliseconds until then: it can look at
  /// signals, and make other calls.
  Result<boost::json::object> call(std::string_view method, boost::json::object params,
                                   const std::function<void()>& meanwhile = {});
  /// Keeps everything going until the time is over, or until a call has ended or a notification
  /// came. False if nothing came.
  bool listen(tmcl::Duration at_most);

  /// As a client that ends its connection: calls in progress that only wait come to an end, a
  /// module that is loaded is brought out of its download mode, and nothing is watched any more.
  /// Calls may be made again.
  void hang_up();

  /// Ends as tmcld does, see end_gateway(): that may take seconds, for an upload minutes. Calls in
  /// progress have ended then.
  void end();
  /// Once end() was called.
  bool is_ending() const { return is_ending_; }

  /// By the clock of the gateway.
  tmcl::TimePoint now() const;
  /// What is there and what moves.
  Gateway& gateway() { return *gateway_; }

 private:
  explicit LocalGateway(std::shared_ptr<boost::asio::io_context> context);
  void run_until_news(tmcl::TimePoint limit);
  bool deliver();

  std::shared_ptr<boost::asio::io_context> context_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_;
  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<LocalPeer> peer_;
  OnNotification on_notification_;
  std::uint64_t last_id_ = 0;
  bool is_ending_ = false;
  /// Something came since it was looked at last.
  std::shared_ptr<bool> news_ = std::make_shared<bool>(false);
};

}  // namespace tmcld
