// While a verb that moves an axis waits for an answer of the module, somebody stops the axis or
// claims it, or the daemon ends, or stands still for a while: at every exchange of every such verb.
// Behind that nothing of the verb goes out that can move a motor, and its error says what came in
// between.
#include <gmock/gmock.h>

#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using tmcl::Command;
using tmcl::Request;

const tmcl::AxisAddress motor_of_x{tmcl::ModuleAddress{1}, 0};

struct Verb {
  std::string name;
  std::string method;
  json::object params;
  bool within_limits = true;  ///< An axis with soft limits may do it, too.
};
const std::vector<Verb> verbs{
    {"move_to", "axis.move_to", {{"position_microsteps", 51'200}}},
    {"move_to_in_unit", "axis.move_to", {{"position", 5}, {"predict", false}}},
    {"move_by", "axis.move_by", {{"distance_microsteps", 51'200}}},
    {"move_by_in_unit", "axis.move_by", {{"distance", 5}, {"predict", false}}},
    {"rotate", "axis.rotate", {{"velocity_internal", example_velocity}}, false},
    {"rotate_in_unit", "axis.rotate", {{"velocity", 3}}, false},
    {"set_target", "parameter.set", {{"parameter", 0}, {"value", 51'200}}},
    {"set_target_in_unit", "parameter.set", {{"parameter", 0}, {"value_in_unit", 5}}},
    {"set_position", "parameter.set", {{"parameter", 1}, {"value", 51'200}}},
    {"set_velocity", "parameter.set", {{"parameter", 2}, {"value", example_velocity}}, false},
    {"restore", "parameter.restore", {{"parameter", 5}}},
    {"coordinate", "coordinate.move", {{"number", 1}}},
    {"home", "axis.home", {}},
    {"home_in_mode", "axis.home", {{"mode", 1}}},
    {"start_home", "axis.start_home", {}},
    {"start_home_in_mode", "axis.start_home", {{"mode", 1}}},
};

struct Intervention {
  std::string name;
  std::string error;
};
const std::vector<Intervention> interventions{{"stop", "superseded_by_stop"},
                                              {"claim", "axis_claimed"},
                                              {"ending", "daemon_ending"},
                                              {"gap", "stale_request"}};

/// A call whose answers come one by one.
class Race {
 public:
  explicit Race(Limits limits) : bench_(true, limits) {}
  ~Race() {
    bench_.daemon.on_reactor([&] { return claim_.reset(), 0; });
    let_go();
  }

  void hold() {
    bench_.daemon.on_reactor([&] {
      seen_before_ = wire().seen.size();
      return wire().holds = true, 0;
    });
  }
  int send(const std::string& method, json::object params) {
    params["axis"] = "x";
    return bench_.client->send(method, std::move(params));
  }
  /// Waits for the next exchange of the call; false if it has ended before.
  bool waits_for_answer() {
    bool waits = false;
    return bench_.daemon.eventually([&] {
      waits = !wire().held.empty();
      return waits || has_ended();
    }) && waits;
  }
  void answer_one() {
    bench_.daemon.on_reactor([&] {
      wire().release();
      return wire().holds = true, 0;
    });
  }
  void intervene(const Intervention& what) {
    bench_.daemon.on_reactor([&] {
      if (what.name == "stop") x().revoke_movements();
      if (what.name == "claim") claim_ = x().claim({ClaimKind::path, gateway().admit()});
      if (what.name == "ending") gateway().refuse_new_calls();
      seen_then_ = wire().seen.size();
      holds_move_ = can_move_x(wire().seen.back());
      return 0;
    });
    if (what.name == "gap") bench_.daemon.freeze_for(std::chrono::seconds(2));
  }
  bool can_be_claimed() {
    return bench_.daemon.on_reactor([&] { return x().claim_kind() == ClaimKind::none; });
  }
  void let_go() {
    bench_.daemon.on_reactor([&] { return wire().release(), 0; });
  }
  json::object answer_to(int id) { return answer_ ? *answer_ : bench_.client->answer_to(id); }

  bool moved_before() { return count(seen_before_, seen_then_, can_move_x) > 0; }
  bool holds_move() const { return holds_move_; }
  bool acted_before() { return count(seen_before_, seen_then_, is_no_question) > 0; }
  bool acts_afterwards() { return count(seen_then_, std::size_t(-1), is_no_question) > 0; }
  bool moves_afterwards() { return count(seen_then_, std::size_t(-1), can_move_x) > 0; }
  /// The parameter as the module has it.
  std::int32_t held(std::uint8_t parameter) {
    return static_cast<std::int32_t>(
        other_.result("parameter.get", {{"axis", "x"}, {"parameter", parameter}})
            .at("value")
            .as_int64());
  }
  RpcClient& other() { return other_; }
  std::size_t requests_seen(Command command) { return bench_.daemon.requests_seen(command); }

 private:
  static bool can_move_x(const Request& request) { return can_move(request, motor_of_x); }
  static bool is_no_question(const Request& request) {
    return effect_of(request.command, request.type) != tmcl::Effect::reads;
  }
  std::ptrdiff_t count(std::size_t from, std::size_t to, bool (*which)(const Request&)) {
    return bench_.daemon.on_reactor([&] {
      const auto& seen = wire().seen;
      const auto at = [&](std::size_t i) {
        return seen.begin() + static_cast<std::ptrdiff_t>(std::min(i, seen.size()));
      };
      return std::count_if(at(from), at(to), which);
    });
  }
  bool has_ended() {
    if (!answer_) {
      const auto message = bench_.client->read(0);
      const bool is_answer = message.is_object() && message.as_object().contains("id");
      if (is_answer) answer_ = message.as_object();
    }
    return answer_.has_value();
  }
  FakeWire& wire() { return bench_.daemon.wire(); }
  Gateway& gateway() { return bench_.daemon.daemon().gateway(); }
  GatewayAxis& x() { return *gateway().axes()[0]; }

  MovesBench bench_;
  RpcClient other_{bench_.daemon.socket()};
  std::optional<json::object> answer_;
  std::optional<Claim> claim_;
  std::size_t seen_before_ = 0;
  std::size_t seen_then_ = 0;
  bool holds_move_ = false;
};

class DaemonRace : public testing::TestWithParam<Limits> {
 protected:
  /// False if the verb has fewer exchanges before the axis is on its way, or if nobody could claim
  /// the axis any more.
  bool play(const Verb& verb, const Intervention& intervention, int exchange) {
    Race race(GetParam());
    race.hold();
    const int id = race.send(verb.method, verb.params);
    for (int i = 0; i < exchange && race.waits_for_answer(); ++i) race.answer_one();
    if (!race.waits_for_answer()) return false;
    if (intervention.name == "claim" && !race.can_be_claimed()) return false;
    race.intervene(intervention);
    race.let_go();
    judge(race, intervention, race.answer_to(id));
    return !race.moved_before() || race.holds_move();
  }
  static void judge(Race& race, const Intervention& intervention, const json::object& answer) {
    EXPECT_FALSE(race.moves_afterwards());
    if (answer.contains("result")) {
      EXPECT_TRUE(race.moved_before());
      return;
    }
    const auto& data = answer.at("error").at("data");
    EXPECT_EQ(text(data.at("name")), intervention.error);
    // Who has stood still goes on with what moves nothing.
    const bool acted =
        race.acted_before() || (intervention.name == "gap" && race.acts_afterwards());
    EXPECT_EQ(text(data.at("outcome")), acted ? "unknown" : "not_sent");
  }
};
INSTANTIATE_TEST_SUITE_P(With, DaemonRace, testing::Values(Limits::none, Limits::wide),
                         [](const auto& one) {
                           return one.param == Limits::none ? "no_limits" : "soft_limits";
                         });

TEST_P(DaemonRace, NothingMovesBehindWhatComesBetweenTwoExchanges) {
  for (const auto& verb : verbs) {
    if (GetParam() == Limits::wide && !verb.within_limits) continue;
    for (const auto& intervention : interventions) {
      for (int exchange = 0; exchange < 40; ++exchange) {
        SCOPED_TRACE(verb.name + ", " + intervention.name + " at exchange " +
                     std::to_string(exchange));
        if (!play(verb, intervention, exchange)) {
          // A search that is its first exchange has claimed the axis.
          EXPECT_TRUE(exchange > 0 || intervention.name == "claim") << "it asked nothing";
          break;
        }
      }
    }
  }
}

// A search in a mode writes the mode first.
TEST(DaemonSearchRace, AStopBeforeTheSearchLeavesTheModeAsItWas) {
  constexpr std::uint8_t search_mode = 193;
  for (const auto* method : {"axis.home", "axis.start_home"}) {
    Race race(Limits::none);
    const auto before = race.held(search_mode);
    race.hold();
    const int id = race.send(method, {{"mode", before == 1 ? 2 : 1}});
    while (race.waits_for_answer() && race.requests_seen(Command::SAP) == 0) race.answer_one();
    race.intervene(interventions.front());
    race.let_go();
    EXPECT_TRUE(race.answer_to(id).contains("error"));
    EXPECT_EQ(race.held(search_mode), before) << method;
  }
}

// With other microsteps the same target is another place.
TEST(DaemonScaleRace, NewMicrostepsMoveTheSoftLimitsOfAMoveThatHasBegun) {
  for (int exchange = 0; exchange < 40; ++exchange) {
    SCOPED_TRACE("at exchange " + std::to_string(exchange));
    Race race(Limits::wide);
    race.hold();
    const int id = race.send("axis.move_to", {{"position_microsteps", 5'000'000}});
    for (int i = 0; i < exchange && race.waits_for_answer(); ++i) race.answer_one();
    if (!race.waits_for_answer()) break;
    const bool moved = race.requests_seen(Command::MVP) > 0;
    const int coarser = race.other().send(
        "parameter.set", {{"axis", "x"}, {"parameter", "microstep_resolution"}, {"value", 0}});
    race.other().result("axis.list");  // that has come in, too
    race.let_go();
    race.other().answer_to(coarser);
    const auto answer = race.answer_to(id);
    EXPECT_EQ(answer.contains("result"), moved) << json::serialize(answer);
    if (moved || answer.contains("result")) continue;
    EXPECT_EQ(text(answer.at("error").at("data").at("name")), "beyond_soft_limit");
  }
}

TEST(DaemonRaw, ARelativeMoveIsSentAsAnAbsoluteOne) {
  MovesBench bench;
  bench.client->result("parameter.set", {{"axis", "x"}, {"parameter", 1}, {"value", 1000}});
  const auto reply = bench.client->result("module.execute", {{"bus", "bench"},
                                                             {"address", 1},
                                                             {"command", "MVP"},
                                                             {"type", "REL"},
                                                             {"motor", 0},
                                                             {"value", 500}});
  EXPECT_EQ(reply.at("value"), 1500);
  const auto& seen = bench.daemon.wire().seen;
  const auto move = std::ranges::find(seen, tmcl::Command::MVP, &tmcl::Request::command);
  ASSERT_NE(move, seen.end());
  EXPECT_EQ(move->type, 0);
  EXPECT_EQ(move->value, 1500);
}

}  // namespace
}  // namespace tmcld::test
