/// A broker that takes everything, and is there until its client leaves it.
#pragma once

#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "async/wake.hpp"
#include "broker/broker.hpp"

namespace tmclmqtt::test {

class QuietBroker final : public Broker {
 public:
  /// What is published goes to `published`, which outlives it.
  QuietBroker(const boost::asio::any_io_executor& executor, std::vector<Publication>& published)
      : ended_(executor), published_(published) {}
  void subscribe(const Subscribed& /*to*/) override {}
  Sent publish(const Publication& publication) override {
    published_.push_back(publication);
    return Sent::yes;
  }
  bool has_room() const override { return true; }
  boost::asio::awaitable<std::string> end() override {
    while (!has_ended_) co_await ended_.wait();
    co_return std::string("ended");
  }
  void disconnect() override {
    has_ended_ = true;
    ended_.notify();
  }

 private:
  tmcld::Wake ended_;
  bool has_ended_ = false;
  std::vector<Publication>& published_;
};

}  // namespace tmclmqtt::test
