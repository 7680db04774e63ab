/// A client of the broker with the traffic of a gateway and nothing behind it: how far the broker
/// and the library alone would go.
#pragma once

#include <memory>
#include <string>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>

#include "async/workers.hpp"
#include "broker/broker.hpp"
#include "fleet/place.hpp"

namespace tmclfleet {

class PlainGateway {
 public:
  PlainGateway(boost::asio::io_context& context, tmcld::Workers& workers, const FleetPlace& place,
               int number);

  void start();

 private:
  static boost::asio::awaitable<void> serve(PlainGateway& gateway);
  boost::asio::awaitable<std::shared_ptr<tmclmqtt::Broker>> connect(std::string_view client);
  boost::asio::awaitable<void> tell();
  void take(const tmclmqtt::Message& message);

  boost::asio::io_context& context_;
  tmcld::Workers& workers_;
  FleetPlace place_;
  std::string name_;
  std::shared_ptr<tmclmqtt::Broker> calls_;
  std::shared_ptr<tmclmqtt::Broker> stops_;
  bool is_wanted_ = false;
};

}  // namespace tmclfleet
