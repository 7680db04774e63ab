// Stops that the bridge reads when tmcld has just cut it off.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include <boost/asio/io_context.hpp>
#include <boost/json/parse.hpp>

#include "config/load.hpp"
#include "fronts/socket_file.hpp"
#include "fronts/unix_server.hpp"
#include "gateway/gateway.hpp"
#include "io/bridge.hpp"
#include "support/quiet_broker.hpp"
#include "support/temp_path.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmcld::test {
namespace {

using std::chrono::milliseconds;
using tmclmqtt::Publication;

class StopLink : public testing::Test {
 protected:
  StopLink() {
    server->start();
    bridge->start();
    time.run_for(milliseconds(5'000));
  }
  ~StopLink() override {
    bridge->stop();
    server->stop_accepting();
    server->close_sessions();
    gateway->close();
    time.run_for(milliseconds(5'000));
  }

  std::shared_ptr<UnixServer> make_server() {
    return std::make_shared<UnixServer>(context.get_executor(),
                                        std::move(*SocketFile::claim(socket)), gateway, max_clients,
                                        std::make_shared<FrontShare>());
  }
  std::shared_ptr<tmclmqtt::Bridge> make_bridge() {
    tmclmqtt::MqttConfig config;
    config.gateway = "hall";
    config.socket = socket;
    tmclmqtt::BridgeParts parts;
    parts.connect = [this](const auto& options, auto on_message, const auto& /*on_room*/) {
      return connect(options.client_id, std::move(on_message));
    };
    parts.draw = [drawn = 0]() mutable { return "drawn-" + std::to_string(++drawn); };
    parts.on_turn = [] {};
    return std::make_shared<tmclmqtt::Bridge>(context.get_executor(), config, std::move(parts));
  }
  boost::asio::awaitable<tmclmqtt::Connected> connect(std::string client,
                                                      tmclmqtt::Broker::OnMessage on_message) {
    if (client.ends_with("-stop")) say = std::move(on_message);
    std::shared_ptr<tmclmqtt::Broker> broker =
        std::make_shared<tmclmqtt::test::QuietBroker>(context.get_executor(), published);
    co_return broker;
  }
  void stop() {
    tmclmqtt::Message message;
    message.topic = "tmcl/v1/hall/stop";
    message.response_topic = "tmcl/v1/reply/anna/hall/s";
    message.correlation = "of a stop";
    say(std::move(message));
  }
  bool is_answered_with(std::string_view member) const {
    return std::ranges::any_of(published, [&](const Publication& one) {
      return one.correlation == "of a stop" &&
             boost::json::parse(one.payload).as_object().contains(member);
    });
  }

  boost::asio::io_context context{1};
  tmcl::VirtualTime time{context};
  std::string socket = tmcl::test::temp_path("stop-link.sock");
  std::shared_ptr<Gateway> gateway = Gateway::create(
      context.get_executor(), parse_config("[daemon]\nsocket = \"/none\"\n").value());
  std::shared_ptr<UnixServer> server = make_server();
  std::vector<Publication> published;
  tmclmqtt::Broker::OnMessage say;
  std::shared_ptr<tmclmqtt::Bridge> bridge = make_bridge();
};

TEST_F(StopLink, IsAnotherOneWhenTheFirstHasJustBeenCut) {
  server->close_sessions();
  stop();
  time.run_for(milliseconds(100));
  EXPECT_TRUE(is_answered_with("result"));
}

TEST_F(StopLink, IsAnotherOneWhileTheBridgeWaitsBeforeItConnectsAgain) {
  server->close_sessions();
  time.run_for(milliseconds(100));
  stop();
  time.run_for(milliseconds(100));
  EXPECT_TRUE(is_answered_with("result"));
}

TEST_F(StopLink, IsOneMoreWhenTheOtherIsCutAtAnyOfItsSteps) {
  for (int turns = 0; turns < 40; ++turns) {
    published.clear();
    server->close_sessions();
    stop();
    context.restart();
    for (int turn = 0; turn < turns; ++turn) context.poll_one();
    server->close_sessions();
    time.run_for(milliseconds(100));
    EXPECT_TRUE(is_answered_with("result")) << "cut after " << turns << " turns";
    time.run_for(milliseconds(3'000));
  }
}

TEST_F(StopLink, IsNoneWithoutTmcld) {
  server->stop_accepting();
  std::filesystem::remove(socket);
  server->close_sessions();
  stop();
  time.run_for(milliseconds(100));
  EXPECT_TRUE(is_answered_with("error"));
}

}  // namespace
}  // namespace tmcld::test
