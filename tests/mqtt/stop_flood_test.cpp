// Stops that come faster than tmcld answers them.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include "io/bridge.hpp"
#include "support/quiet_broker.hpp"
#include "support/temp_path.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;
using std::chrono::milliseconds;

/// Answers at once what a bridge asks first; a stop only when it is told to.
class SlowTmcld {
 public:
  using Protocol = boost::asio::local::stream_protocol;

  SlowTmcld(boost::asio::io_context& context, const std::string& path)
      : acceptor_(context, Protocol::endpoint(path)), socket_(context) {
    acceptor_.async_accept(socket_, [this](const boost::system::error_code& error) {
      if (error) return;
      say({{"method", "hello"}, {"params", {{"protocol", {{"major", 1}}}, {"daemon", "slow"}}}});
      read();
    });
  }

  int stops() const { return stops_; }
  void answer_stops() {
    is_slow_ = false;
    for (const auto& id : std::exchange(held_, {})) answer_stop(id);
  }

 private:
  void read() {
    boost::asio::async_read_until(
        socket_, boost::asio::dynamic_buffer(received_), '\n',
        [this](const boost::system::error_code& error, std::size_t count) {
          if (error) return;
          take(json::parse(json::string_view(received_.data(), count)).as_object());
          received_.erase(0, count);
          read();
        });
  }
  void take(const json::object& request) {
    const auto& id = request.at("id");
    if (request.at("method") != "system.stop_all")
      return say({{"id", id}, {"result", {{"methods", {moves()}}, {"axes", json::array()}}}});
    ++stops_;
    is_slow_ ? held_.push_back(id) : answer_stop(id);
  }
  static json::object moves() {
    tmcl::api::rpc::MethodInfo method;
    method.name = "axis.move_to";
    method.effect = "moves";
    return tmcl::api::to_json(method);
  }
  void answer_stop(const json::value& id) {
    say({{"id", id}, {"result", {{"stopped", json::array()}, {"failed", json::array()}}}});
  }
  void say(json::object message) {
    message["jsonrpc"] = "2.0";
    boost::asio::write(socket_, boost::asio::buffer(json::serialize(message) + '\n'));
  }

  Protocol::acceptor acceptor_;
  Protocol::socket socket_;
  std::string received_;
  std::vector<json::value> held_;
  bool is_slow_ = true;
  int stops_ = 0;
};

class MqttStopFlood : public testing::Test {
 protected:
  MqttStopFlood() {
    bridge->start();
    time.run_for(milliseconds(1000));
  }
  ~MqttStopFlood() override {
    bridge->stop();
    time.run_for(milliseconds(2000));
    std::filesystem::remove(socket);
  }

  static std::string free_path() {
    auto path = tmcl::test::temp_path("stop-flood.sock");
    std::filesystem::remove(path);
    return path;
  }
  std::shared_ptr<Bridge> make_bridge() {
    MqttConfig config;
    config.gateway = "hall";
    config.socket = socket;
    BridgeParts parts;
    parts.connect = [this](const auto& options, auto on_message, const auto& /*on_room*/) {
      return connect(options.client_id, std::move(on_message));
    };
    parts.draw = [drawn = 0]() mutable { return "drawn-" + std::to_string(++drawn); };
    parts.on_turn = [] {};
    return std::make_shared<Bridge>(context.get_executor(), config, std::move(parts));
  }
  boost::asio::awaitable<Connected> connect(std::string client, Broker::OnMessage on_message) {
    (client.ends_with("-stop") ? say : call) = std::move(on_message);
    std::shared_ptr<Broker> broker =
        std::make_shared<test::QuietBroker>(context.get_executor(), published);
    co_return broker;
  }
  void stop(int times, const std::string& correlation) {
    Message message;
    message.topic = "tmcl/v1/all/stop";
    message.response_topic = "tmcl/v1/reply/anna/all/stop";
    message.correlation = correlation;
    for (; times > 0; --times) say(message);
    time.run_for(milliseconds(10));
  }
  json::object answer_to_call(const std::string& method, const json::object& said) {
    Message message;
    message.topic = "tmcl/v1/hall/call/operate/anna/" + method;
    message.payload = json::serialize(said);
    message.response_topic = "tmcl/v1/reply/anna/hall/call";
    call(message);
    time.run_for(milliseconds(10));
    return json::parse(published.back().payload).as_object();
  }
  std::ptrdiff_t answers(const std::string& correlation) const {
    return std::ranges::count(published, correlation, &Publication::correlation);
  }

  boost::asio::io_context context{1};
  tmcl::VirtualTime time{context};
  std::string socket = free_path();
  SlowTmcld tmcld{context, socket};
  std::vector<Publication> published;
  Broker::OnMessage say;
  Broker::OnMessage call;
  std::shared_ptr<Bridge> bridge = make_bridge();
};

TEST_F(MqttStopFlood, GoesOutAsOneStopAndOneAnswerForEachSender) {
  stop(8, "first");
  EXPECT_EQ(tmcld.stops(), 8) << "each at once";
  stop(1000, "again");
  stop(1, "other");
  EXPECT_EQ(tmcld.stops(), 8);
  tmcld.answer_stops();
  time.run_for(milliseconds(10));
  EXPECT_EQ(tmcld.stops(), 9) << "one for all that waited";
  EXPECT_EQ(answers("first"), 8);
  EXPECT_EQ(answers("again"), 1);
  EXPECT_EQ(answers("other"), 1);
  const auto answer = json::parse(published.back().payload).as_object();
  EXPECT_TRUE(answer.contains("result") && answer.contains("epoch")) << published.back().payload;
}

TEST_F(MqttStopFlood, KeepsNoStopBackThatComesBehindAMove) {
  stop(9, "first");
  EXPECT_EQ(tmcld.stops(), 8);
  const auto permit = answer_to_call("nonce", {});
  answer_to_call(
      "axis.move_to",
      {{"params", {{"axis", "x"}}}, {"epoch", permit.at("epoch")}, {"nonce", permit.at("nonce")}});
  stop(9, "again");
  EXPECT_EQ(tmcld.stops(), 9);
}

}  // namespace
}  // namespace tmclmqtt
