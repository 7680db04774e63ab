// tmcld stands still with a call in it, or its computer sleeps, at each of its steps: what has not
// gone out by then moves nothing when it goes on.
#include <gmock/gmock.h>

#include <memory>
#include <ostream>
#include <string>
#include <tuple>

#include <boost/asio/io_context.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include "async/slept.hpp"
#include "config/load.hpp"
#include "gateway/gateway.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/fleet/relay_session.hpp"
#include "world/ledger.hpp"
#include "world/wire.hpp"

namespace tmcld::test {
namespace {

using std::chrono::milliseconds;

constexpr tmcl::Duration time_to_stand = milliseconds(5'400);
constexpr int most_turns = 2'000;

enum class Still : std::uint8_t { program_is_stopped, computer_sleeps };

struct FrozenCall {
  const char* name;
  const char* method;
  const char* params;
};

void PrintTo(const FrozenCall& call, std::ostream* stream) { *stream << call.name; }

/// A client, tmcld, and a module with three motors on a serial line.
class FrozenScene {
 public:
  FrozenScene() {
    wire_.bench().add(*tmcl::find_model("TMCM-3110"), tmcl::ModuleAddress{1});
    wire_.on_request = [this](const tmcl::Request& request) {
      for (std::uint8_t motor = 0; motor < 3; ++motor)
        if (Ledger::moves(request, motor)) ++moved_;
    };
    GatewayOptions options;
    options.open_link = [this](const BusConfig&) { return wire_.open(); };
    gateway_ = Gateway::create(context_.get_executor(), config(), std::move(options));
    gateway_->start();
    Session::Options session;
    session.share = std::make_shared<FrontShare>();
    session.share->clients_share_virtual_time = true;
    session.caller = [] {
      Caller caller;
      caller.lends = Role::configure;
      return caller;
    };
    relay_ = std::make_shared<RelaySession>(context_.get_executor(), gateway_, std::move(session));
    EXPECT_FALSE(relay_->speak_for({"anna", Role::configure}));
    time_.run_for(milliseconds(5'000));
    while (relay_->next_answer()) {
    }
  }
  ~FrozenScene() {
    relay_->close();
    gateway_->close();
    time_.run_for(milliseconds(5'000));
  }
  FrozenScene(const FrozenScene&) = delete;
  FrozenScene& operator=(const FrozenScene&) = delete;

  void call(const FrozenCall& call) {
    auto params = boost::json::parse(call.params).as_object();
    params["sent_at_ms"] =
        std::chrono::duration_cast<milliseconds>(time_.now().time_since_epoch()).count();
    relay_->say(call.method, params);
  }
  /// The next thing that it does, at once or when its time has come.
  void turn() {
    context_.restart();
    if (context_.poll_one() == 0) time_.step();
  }
  void stand_still(Still how) {
    if (how == Still::computer_sleeps) {
      boost::asio::use_service<VirtualSleep>(context_).slept += time_to_stand;
    } else {
      time_.freeze_for(time_to_stand);
    }
    moved_before_ = moved_;
    time_.run_for(milliseconds(8'000));
  }
  bool has_answered() { return !answer().empty(); }
  const std::string& answer() {
    if (answer_.empty()) answer_ = relay_->next_answer().value_or("");
    return answer_;
  }
  int moved() const { return moved_; }
  int moved_afterwards() const { return moved_ - moved_before_; }

 private:
  static Config config() {
    return parse_config(R"([daemon]
socket = "/none"
[[bus]]
name = "line"
link = "serial:/dev/none@115200"
[[axis]]
name = "x"
bus = "line"
address = 1
motor = 0
[[axis]]
name = "y"
bus = "line"
address = 1
motor = 1
)")
        .value();
  }

  boost::asio::io_context context_{1};
  tmcl::VirtualTime time_{context_};
  Trace trace_;
  Wire wire_{context_, "line", tmcl::Framing::serial, 1, {}, trace_};
  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<RelaySession> relay_;
  int moved_ = 0;
  int moved_before_ = 0;
  std::string answer_;
};

class FrozenWithACall : public testing::TestWithParam<std::tuple<Still, FrozenCall>> {};

TEST_P(FrozenWithACall, MovesNothingAfterwards) {
  const auto& [how, call] = GetParam();
  int turns = 0;
  for (; turns < most_turns; ++turns) {
    FrozenScene scene;
    scene.call(call);
    for (int turn = 0; turn < turns; ++turn) scene.turn();
    if (scene.has_answered()) {
      EXPECT_GT(scene.moved(), 0) << scene.answer();
      break;
    }
    scene.stand_still(how);
    ASSERT_EQ(scene.moved_afterwards(), 0)
        << "it stood still after " << turns << " turns; then: " << scene.answer();
  }
  ASSERT_LT(turns, most_turns);
}

constexpr FrozenCall frozen_calls[] = {
    {"MoveTo", "axis.move_to", R"({"axis":"x","position_microsteps":2000})"},
    {"MoveBy", "axis.move_by", R"({"axis":"x","distance_microsteps":2000})"},
    {"Rotate", "axis.rotate", R"({"axis":"x","velocity_internal":100,"unattended":true})"},
    {"Target", "parameter.set", R"({"axis":"x","parameter":"target_position","value":2000})"},
    {"Raw", "module.execute",
     R"({"bus":"line","address":1,"command":"MVP","type":0,"motor":0,"value":2000})"},
    {"Line", "line.move", R"({"axes":["x","y"],"positions_microsteps":[2000,3000]})"},
    {"Home", "axis.start_home", R"({"axis":"x"})"},
};

INSTANTIATE_TEST_SUITE_P(Calls, FrozenWithACall,
                         testing::Combine(testing::Values(Still::program_is_stopped,
                                                          Still::computer_sleeps),
                                          testing::ValuesIn(frozen_calls)),
                         [](const auto& one) {
                           const auto how = std::get<Still>(one.param);
                           return std::string(std::get<FrozenCall>(one.param).name) +
                                  (how == Still::computer_sleeps ? "AndTheComputerSleeps"
                                                                 : "AndTmcldStandsStill");
                         });

}  // namespace
}  // namespace tmcld::test
