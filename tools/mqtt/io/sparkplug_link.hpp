/// The connection to the broker by which a gateway is an edge node of Sparkplug. A connection has
/// one will, and that of calls has another: so it is one of its own. It neither ends the other ones
/// nor ends with them: what it tells is known from tmcld, not from them. Only to connect it waits
/// for them: one thread waits for names and TCP, and calls and stops come first there.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "broker/broker.hpp"
#include "io/pauses.hpp"
#include "protocol/sparkplug.hpp"
#include "tmcl/context_clock.hpp"

namespace tmclmqtt {

class SparkplugLink : public std::enable_shared_from_this<SparkplugLink> {
 public:
  /// `options`: of its connections, but for the will. `may_connect`: the others are connected.
  /// `complain`: for the log; may be the same again and again.
  SparkplugLink(const boost::asio::any_io_executor& executor, BrokerOptions options,
                ConnectToBroker connect, Sparkplug node, std::function<bool()> may_connect,
                std::function<void(std::string)> complain);

  void start();
  /// Says farewell, and closes the connection.
  void stop();
  /// As that of Bridge.
  bool is_connecting() const { return connecting_; }

  // See Sparkplug.
  void hear(const boost::json::object& told);
  void know(const std::string& daemon, const std::vector<ListedAxis>& axes);
  void forget();
  /// What has become due is published; to be called a few times a second.
  void look() { flush(); }

 private:
  static boost::asio::awaitable<void> serve(std::shared_ptr<SparkplugLink> self);

  /// Until the connection is lost; why. Empty: it was ended here.
  boost::asio::awaitable<std::string> use_broker();
  void take(const Message& message);
  void flush();
  void disconnect();
  tmcl::UtcTime utc() const { return clock_.utc_of(clock_.now()); }

  boost::asio::any_io_executor executor_;
  tmcl::ContextClock clock_;
  BrokerOptions options_;
  ConnectToBroker connect_;
  Sparkplug node_;
  std::function<bool()> may_connect_;
  std::function<void(std::string)> complain_;
  std::shared_ptr<Broker> broker_;  ///< Null while there is none.
  bool connecting_ = false;
  bool stopping_ = false;
};

}  // namespace tmclmqtt
