// What the daemon refuses, over a real socket: each time the error says what is wrong, no byte
// reaches a module, and the connection and the other clients go on working.
#include <string>

#include <gmock/gmock.h>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

struct Refusal {
  std::string line;
  int code;
  std::string name;
  std::string param;    // empty: none
  std::string mention;  // in the message or the hint
};

std::string call(const std::string& method, const std::string& params) {
  return R"({"jsonrpc":"2.0","id":1,"method":")" + method + R"(","params":)" + params + "}";
}

std::string nested(int depth) {
  const auto open = std::string(static_cast<std::size_t>(depth), '[');
  return open + std::string(static_cast<std::size_t>(depth), ']');
}

const auto& refusals() {
  static const std::vector<Refusal> all{
      {"hello", -32700, "parse_error", "", "not JSON"},
      {"{\"jsonrpc\":\"2.0\",", -32700, "parse_error", "", "one JSON object a line"},
      {call("axis.list", "{}") + call("axis.list", "{}"), -32700, "parse_error", "", ""},
      {"{\"a\":\"\xFF\xFE\"}", -32700, "parse_error", "", "UTF-8"},
      {nested(17), -32700, "parse_error", "", "16 deep"},
      {nested(1000), -32700, "parse_error", "", "16 deep"},
      {std::string(70'000, 'x'), -32700, "line_too_long", "", "65536"},
      {"[]", -32600, "invalid_request", "", "no batches"},
      {"7", -32600, "invalid_request", "", "object"},
      {"null", -32600, "invalid_request", "", "object"},
      {"{}", -32600, "invalid_request", "", "jsonrpc"},
      {R"({"jsonrpc":"1.0","id":1,"method":"axis.list"})", -32600, "invalid_request", "",
       "jsonrpc"},
      {R"({"jsonrpc":"2.0","method":"axis.list"})", -32600, "invalid_request", "", "\"id\""},
      {R"({"jsonrpc":"2.0","id":null,"method":"axis.list"})", -32600, "invalid_request", "",
       "\"id\""},
      {R"({"jsonrpc":"2.0","id":1.5,"method":"axis.list"})", -32600, "invalid_request", "",
       "\"id\""},
      {R"({"jsonrpc":"2.0","id":1,"method":7})", -32600, "invalid_request", "", "method"},
      {R"({"jsonrpc":"2.0","id":1})", -32600, "invalid_request", "", "method"},
      {call("axis.stop", "[\"x\"]"), -32600, "invalid_request", "", "by name"},
      {R"({"jsonrpc":"2.0","id":1,"method":"axis.list","parms":{}})", -32600, "invalid_request", "",
       "Did you mean 'params'?"},
      {call("axis.move", "{}"), -32601, "method_not_found", "", "axis.move_"},
      {call("zzzzzzzzzzzz", "{}"), -32601, "method_not_found", "", "rpc.discover"},
      {call("axis.move_to", R"({"axis":"x"})"), -32602, "bad_argument", "position_microsteps",
       "is needed"},
      {call("axis.move_to", R"({"axis":"x","position":1})"), -32602, "bad_argument", "position",
       "has no unit of its own"},
      {call("axis.move_to", R"({"axis":"x","position_microstep":1})"), -32602, "bad_argument",
       "position_microstep", "Did you mean 'position_microsteps'?"},
      {call("axis.move_to", R"({"axis":"x","position_microsteps":"1"})"), -32602, "bad_argument",
       "position_microsteps", "integer"},
      {call("axis.move_to", R"({"axis":"x","position_microsteps":1.5})"), -32602, "bad_argument",
       "position_microsteps", "integer"},
      {call("axis.move_to", R"({"axis":7,"position_microsteps":1})"), -32602, "bad_argument",
       "axis", "string"},
      {call("axis.move_to", R"({"axis":"x","position_microsteps":2147483648})"), -32602,
       "out_of_range", "position_microsteps", "-2147483648..2147483647"},
      {call("axis.move_to", R"({"axis":"x","position_microsteps":-1e30})"), -32602, "out_of_range",
       "position_microsteps", ""},
      {call("axis.move_to", R"({"axis":"x","position_microsteps":18446744073709551615})"), -32602,
       "out_of_range", "position_microsteps", ""},
      {call("axis.move_to", R"({"axis":"x","position_microsteps":8388608})"), -32602,
       "out_of_range", "position_microsteps", "the range of target_position"},
      {call("axis.move_to", R"({"axis":"xx","position_microsteps":1})"), -32602, "unknown_axis",
       "axis", "Did you mean 'x'?"},
      {call("axis.rotate", R"({"axis":"x","velocity_internal":2048})"), -32602, "out_of_range",
       "velocity_internal", "-2047..2047"},
      {call("axis.stop", R"({"axis":"zebra"})"), -32602, "unknown_axis", "axis", "axis.list"},
      {call("parameter.get", R"({"axis":"x","parameter":"max_velocty"})"), -32602,
       "unknown_parameter", "parameter", "Did you mean 'max_velocity'?"},
      {call("parameter.get", R"({"axis":"x","parameter":256})"), -32602, "out_of_range",
       "parameter", "0..255"},
      {call("parameter.get", R"({"axis":"x","parameter":[]})"), -32602, "bad_argument", "parameter",
       "string or integer"},
      {call("parameter.set", R"({"axis":"x","parameter":"max_velocity","value":2048})"), -32602,
       "out_of_range", "value", "0..2047"},
      {call("parameter.set", R"({"axis":"x","parameter":4,"value":-1})"), -32602, "out_of_range",
       "value", "max_velocity"},
      {call("parameter.set", R"({"axis":"x","parameter":"actual_velocity","value":1})"), -32602,
       "read_only", "parameter", "only be read"},
      {call("module.execute", R"({"bus":"bensh","address":1,"command":6})"), -32602, "unknown_bus",
       "bus", "Did you mean 'bench'?"},
      {call("module.execute", R"({"bus":"bench","address":1,"command":"GAPP"})"), -32602,
       "unknown_command", "command", "Did you mean 'GAP'?"},
      {call("module.execute", R"({"bus":"bench","address":1,"command":"MVP","type":"SIDEWAYS"})"),
       -32602, "bad_argument", "type", "SIDEWAYS"},
      {call("module.execute", R"({"bus":"bench","address":2048,"command":6})"), -32602,
       "out_of_range", "address", ""},
      {call("bus.scan", R"({"first":9,"last":8})"), -32602, "out_of_range", "first", ""},
      {call("subscribe", R"({"axes":["x","q"]})"), -32602, "unknown_axis", "axes", ""},
      {call("subscribe", R"({"axes":"x"})"), -32602, "bad_argument", "axes", "array of strings"},
      {call("subscribe", R"({"interval_ms":4})"), -32602, "out_of_range", "interval_ms", ""},
      {call("unsubscribe", R"({"subscription":99})"), -32602, "unknown_subscription",
       "subscription", ""}};
  return all;
}

using DaemonApi = DaemonTest;

TEST_F(DaemonApi, RefusesWithoutTouchingAModule) {
  RpcClient other(daemon.socket());
  for (const auto& refusal : refusals()) {
    SCOPED_TRACE(refusal.line.substr(0, 120));
    const auto before = daemon.requests_seen();
    client.send_raw(refusal.line + "\n");
    const auto answer = client.read();
    ASSERT_TRUE(answer.is_object() && answer.as_object().contains("error"))
        << json::serialize(answer);
    const auto& error = answer.at("error");
    EXPECT_EQ(error.at("code"), refusal.code);
    const auto& data = error.at("data").as_object();
    EXPECT_EQ(text(data.at("name")), refusal.name);
    EXPECT_EQ(text(data.at("outcome")), "not_sent");
    EXPECT_EQ(data.contains("param") ? text(data.at("param")) : "", refusal.param);
    EXPECT_THAT(
        json::serialize(error),
        HasSubstr(
            json::serialize(json::string_view(refusal.mention)).substr(1, refusal.mention.size())));
    EXPECT_EQ(daemon.requests_seen(), before);
    EXPECT_EQ(client.result("axis.list").at("axes").as_array().size(), 2U);
    EXPECT_EQ(other.result("axis.list").at("axes").as_array().size(), 2U);
  }
}

TEST_F(DaemonApi, ListsTheCodesOfAParameterThatHasOthers) {
  const auto error = client.error(
      "global.set",
      {{"bus", "bench"}, {"address", 1}, {"parameter", "serial_baud_rate"}, {"value", 57'600}});
  EXPECT_EQ(text(error.at("data").at("name")), "out_of_range");
  EXPECT_THAT(text(error.at("data").at("hint")), HasSubstr("5 57600"));
}

TEST_F(DaemonApi, RefusesAMoveByThatEndsOutsideTheRange) {
  daemon.on_reactor([&] {
    daemon.wire().modules.at(1).parameter(0, 1) = 8'388'000;
    return 0;
  });
  const auto error = client.error("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 1000}});
  EXPECT_EQ(text(error.at("data").at("name")), "bad_argument");
  EXPECT_EQ(text(error.at("data").at("axis")), "x");
  EXPECT_EQ(daemon.requests_seen(tmcl::Command::MVP), 0U);
}

TEST_F(DaemonApi, SaysHelloFirst) {
  EXPECT_EQ(client.greeting().at("method"), "hello");
  EXPECT_EQ(client.greeting().at("params").at("protocol").at("major"), 1);
}

TEST_F(DaemonApi, MovesAndReads) {
  EXPECT_EQ(client.result("axis.move_to", {{"axis", "y"}, {"position_microsteps", -5}})
                .at("target_microsteps"),
            -5);
  EXPECT_EQ(client.result("axis.wait", {{"axis", "y"}}).at("position_microsteps"), -5);
  EXPECT_EQ(client.result("axis.move_by", {{"axis", "y"}, {"distance_microsteps", 15}})
                .at("target_microsteps"),
            10);
  const auto state = client.result("axis.get_state", {{"axis", "y"}});
  EXPECT_EQ(state.at("position_microsteps"), 10);
  EXPECT_EQ(state.at("moving"), false);
  EXPECT_EQ(
      client.result("parameter.set", {{"axis", "y"}, {"parameter", "MaxVelocity"}, {"value", 77}})
          .at("number"),
      4);
  EXPECT_EQ(client.result("parameter.get", {{"axis", "y"}, {"parameter", "4"}}).at("value"), 77);
  EXPECT_EQ(daemon.requests_seen(tmcl::Command::MVP), 2U);
}

TEST_F(DaemonApi, PassesParametersByNumberThatNoTableHas) {
  const auto result = client.result("parameter.get", {{"axis", "x"}, {"parameter", 250}});
  EXPECT_TRUE(result.at("parameter").is_null());
  EXPECT_EQ(result.at("value"), 1'010'250);
}

TEST_F(DaemonApi, TellsWhatTheModuleSaid) {
  const auto error = client.error(
      "module.execute", {{"bus", "bench"}, {"address", 1}, {"command", "GAP"}, {"motor", 9}});
  EXPECT_EQ(error.at("code"), -32000);
  const auto& data = error.at("data").as_object();
  EXPECT_EQ(text(data.at("name")), "refused_by_module");
  EXPECT_EQ(text(data.at("outcome")), "refused");
  EXPECT_EQ(data.at("status"), 4);
  EXPECT_EQ(text(data.at("status_name")), "invalid_value");
  EXPECT_EQ(text(data.at("bus")), "bench");
  EXPECT_EQ(data.at("address"), 1);
  EXPECT_THAT(text(data.at("command")), HasSubstr("GAP 0 0 for motor 9 of module 1"));
}

TEST_F(DaemonApi, RefusesWhatCannotGoOutInTime) {
  const auto error =
      client.error("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}, {"deadline_ms", 0}});
  EXPECT_EQ(text(error.at("data").at("name")), "deadline_passed");
  EXPECT_EQ(text(error.at("data").at("outcome")), "not_sent");
  EXPECT_EQ(daemon.requests_seen(tmcl::Command::MVP), 0U);
}

TEST_F(DaemonApi, AnswersEachRequestWithItsId) {
  daemon.on_reactor([&] { return daemon.wire().holds = true; });
  client.send_raw(R"({"jsonrpc":"2.0","id":"slow","method":"axis.get_state","params":{"axis":"x"}})"
                  "\n");
  // Answered by the daemon alone, while the other one waits for its module.
  client.send_raw(R"({"jsonrpc":"2.0","id":18446744073709551615,"method":"axis.list"})"
                  "\n");
  EXPECT_EQ(client.read().at("id"), UINT64_MAX);
  daemon.on_reactor([&] { return daemon.wire().release(), 0; });
  EXPECT_EQ(client.read().at("id"), "slow");
}

TEST_F(DaemonApi, AnswersAfterTheClientHasEndedItsInput) {
  daemon.on_reactor([&] { return daemon.wire().holds = true; });
  client.send("axis.get_state", {{"axis", "x"}});
  client.end_input();
  EXPECT_TRUE(daemon.eventually([&] { return !daemon.wire().held.empty(); }));
  daemon.on_reactor([&] { return daemon.wire().release(), 0; });
  EXPECT_TRUE(client.read().at("result").is_object());
  EXPECT_TRUE(client.is_cut_off());
}

TEST_F(DaemonApi, DiscoverDescribesEveryMethod) {
  const auto methods = client.result("rpc.discover").at("methods").as_array();
  ASSERT_EQ(methods.size(), method_table().size());
  for (std::size_t i = 0; i < methods.size(); ++i) {
    EXPECT_EQ(text(methods[i].at("name")), method_table()[i].name);
    EXPECT_EQ(methods[i].at("params").as_array().size(), method_table()[i].params.size());
  }
}

}  // namespace
}  // namespace tmcld::test
