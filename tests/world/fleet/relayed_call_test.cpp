// What tmcld does with calls of a relay's users that were late on their way to it.
#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>

#include "config/load.hpp"
#include "gateway/gateway.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/fleet/relay_session.hpp"

namespace tmcld::test {
namespace {

using std::chrono::milliseconds;

class RelayedCall : public testing::Test {
 protected:
  RelayedCall() {
    share->clients_share_virtual_time = true;
    EXPECT_FALSE(relay->speak_for({"anna", Role::operate}));
    pass(milliseconds(5'000));
  }
  ~RelayedCall() override {
    for (const auto& one : {relay, other}) one->close();
    gateway->close();
    pass(milliseconds(5'000));
  }

  std::shared_ptr<RelaySession> connect() {
    Session::Options options;
    options.share = share;
    options.caller = [] {
      Caller caller;
      caller.lends = Role::configure;
      return caller;
    };
    return std::make_shared<RelaySession>(context.get_executor(), gateway, std::move(options));
  }
  void pass(tmcl::Duration duration) { time.run_for(duration); }
  std::int64_t ms() const {
    return std::chrono::duration_cast<milliseconds>(time.now().time_since_epoch()).count();
  }
  /// Of a call that was sent then: an axis that is not there, once it is let through.
  std::string outcome_of_move(std::int64_t sent_ms) {
    relay->say("axis.move_to",
               {{"axis", "x"}, {"position_microsteps", 5}, {"sent_at_ms", sent_ms}});
    pass(milliseconds(50));
    return relay->outcome();
  }

  boost::asio::io_context context{1};
  tmcl::VirtualTime time{context};
  std::shared_ptr<Gateway> gateway = Gateway::create(
      context.get_executor(), parse_config("[daemon]\nsocket = \"/none\"\n").value());
  std::shared_ptr<FrontShare> share = std::make_shared<FrontShare>();
  std::shared_ptr<RelaySession> relay = connect();
  std::shared_ptr<RelaySession> other = connect();
};

TEST_F(RelayedCall, IsLetThroughWhenItComesSoon) {
  const auto sent = ms();
  pass(milliseconds(900));
  EXPECT_EQ(outcome_of_move(sent), "unknown_axis");
}

TEST_F(RelayedCall, IsRefusedWhenTheRelayStoodStillWithIt) {
  const auto sent = ms();
  pass(milliseconds(1'002));
  EXPECT_EQ(outcome_of_move(sent), "stale_request");
}

TEST_F(RelayedCall, IsRefusedWhenAStopHasOvertakenIt) {
  const auto sent = ms();
  pass(milliseconds(5));
  other->say("system.stop_all", {});
  pass(milliseconds(5));
  EXPECT_EQ(outcome_of_move(sent), "stale_request");
  EXPECT_EQ(outcome_of_move(ms()), "unknown_axis");
}

}  // namespace
}  // namespace tmcld::test
