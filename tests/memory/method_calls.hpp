/// For each method of tmcld a call that it carries out on the bench of these tests.
#pragma once

#include <string_view>
#include <vector>

namespace tmcld::test {

struct MethodCall {
  std::string_view method;
  /// "$NAME" is what the last call before it has given as NAME.
  std::string_view params = "{}";
  /// Made by the same client before it.
  std::vector<MethodCall> before{};
  /// Motors that it may move: 0 is x, 1 y, 2 z.
  std::vector<std::size_t> moves{};
  /// As a call before another one: its answer is not waited for.
  bool goes_on = false;
  /// It leaves a module that does not do what it did before.
  bool is_last = false;
  /// It does not get what it waits for.
  bool ends_by_error = false;
};

namespace calls {

inline const MethodCall long_path{
    "path.run", R"({"axes":["y"],"text":"G91\nG1 X100 F600\n","deviation":90})", {}, {1}, true};
inline const MethodCall capture{"capture.start",
                                R"({"axis":"x","channels":["actual_position"],"samples":10})"};
constexpr std::string_view y = R"({"axis":"y"})";
constexpr std::string_view module_2 = R"({"bus":"bench","address":2})";
constexpr std::string_view program = R"({"bus":"bench","address":2,"program":"1c0000000000001c"})";
inline const std::vector<MethodCall> all{
    {"rpc.discover"},
    {"bus.list"},
    {"bus.trace", R"({"bus":"bench"})"},
    {"bus.scan", R"({"bus":"bench","last":3})"},
    {"module.list"},
    {"module.execute", R"({"bus":"bench","address":2,"command":"GAP","type":4,"motor":1})"},
    {"module.execute", R"({"bus":"bench","address":2,"command":"MST","motor":1})"},
    {"axis.list"},
    {"axis.move_to", R"({"axis":"x","position_microsteps":5120})", {}, {0}},
    {"axis.move_by", R"({"axis":"x","distance_microsteps":-120})", {}, {0}},
    {"axis.rotate", R"({"axis":"y","velocity_internal":-300})", {}, {1}},
    {"axis.jog",
     R"({"axis":"y","velocity_internal":300,"hold_ms":200})",
     {{"lease.acquire", R"({"axes":["y"],"ttl_ms":60000})"}},
     {1}},
    {"axis.resonance",
     R"({"axis":"x","distance_microsteps":500,"listen_ms":60})",
     {},
     {0},
     false,
     false,
     true},
    {"axis.stop", y},
    {"axis.wait", R"({"axis":"y","timeout_ms":5000})"},
    {"lease.acquire", R"({"axes":["y","z"],"ttl_ms":60000})"},
    {"lease.renew",
     R"({"lease":"$lease","epoch":"$epoch"})",
     {{"lease.acquire", R"({"axes":["y"],"ttl_ms":60000})"}}},
    {"lease.release",
     R"({"lease":"$lease","epoch":"$epoch"})",
     {{"lease.acquire", R"({"axes":["y"],"ttl_ms":60000})"}}},
    {"lease.list"},
    {"lease.break", y, {{"lease.acquire", R"({"axes":["y"],"ttl_ms":60000})"}}},
    {"token.add", R"({"role":"operate","name":"bench"})"},
    {"token.list"},
    {"token.invite", R"({"name":"$name"})", {{"token.add", R"({"role":"operate"})"}}},
    {"token.revoke",
     R"({"name":"other"})",
     {{"token.add", R"({"role":"operate","name":"other"})"}}},
    {"client.list"},
    {"audit.tail", R"({"lines":3,"after":0})", {{"axis.stop", y}}},
    {"page.find"},
    {"configuration.get"},
    {"configuration.set", R"({"toml":"[path]\ng55 = {x = 120}\n"})", {}, {}, false, false, true},
    {"speak_for", R"({"user":"anna","role":"observe"})", {}, {}, false, false, true},
    {"line.move", R"({"axes":["y","z"],"positions_microsteps":[2000,-500]})", {}, {1, 2}},
    {"path.stage", R"({"offset":0,"data":"4731205831"})"},
    {"path.plan", R"({"axes":["x","y"],"text":"G1 X10 F1200\nG1 Y5\n","points":3})"},
    {"path.run", R"({"axes":["x","y"],"text":"G91\nG1 X1 F1200\nG1 Y1\n","points":9})", {}, {0, 1}},
    {"path.pause", R"({"axes":["y"]})", {long_path}, {1}},
    {"path.resume", R"({"axes":["y"]})", {long_path}, {1}},
    {"path.status", R"({"axes":["y"]})", {long_path}, {1}},
    {"path.feed", R"({"axes":["y"],"factor":0.5})", {long_path}, {1}},
    {"path.stop", R"({"axes":["y"]})", {long_path}, {1}},
    {"mint.run",
     R"({"axes":["y"],"text":"SPEED = 9000\nACCEL = 90000\nMOVEA = 5000\nGO\n"})",
     {},
     {1}},
    {"axis.get_ramp", y},
    {"axis.plan_ramp", R"({"axis":"y","velocity":"50000pps","acceleration":"200000pps/s"})"},
    {"axis.set_ramp", R"({"axis":"y","velocity":"50000pps","acceleration":"200000pps/s"})"},
    {"doctor.examine"},
    {"settings.read", module_2},
    {"settings.compare",
     R"({"bus":"bench","address":2,"toml":"model = \"TMCM-3110\"\n[motor.0]\nmax_current = 9\n"})"},
    {"settings.load",
     R"({"bus":"bench","address":2,"toml":"model = \"TMCM-3110\"\n[motor.0]\nmax_current = 9\n"})"},
    {"settings.store", y},
    {"ramp.compare",
     R"({"axis":"y","velocity":"50000pps","acceleration":"200000pps/s","distance_microsteps":9000,)"
     R"("resonance_hz":12})"},
    {"ramp.find", R"({"axis":"y","distance_microsteps":9000,"time_s":1})"},
    {"profile.simulate",
     R"({"model":"TMCM-142","distance_microsteps":9000,"points":5,"resonance_hz":12})"},
    {"profile.solve", R"({"distance":200,"total_time":1,"speed":250,"assumption":"symmetric"})"},
    {"axis.home", R"({"axis":"x","mode":1,"timeout_ms":300})", {}, {0}, false, false, true},
    {"axis.start_home", R"({"axis":"x","mode":1})", {}, {0}},
    {"axis.stop_home", R"({"axis":"x"})", {{"axis.start_home", R"({"axis":"x"})"}}, {0}},
    {"axis.recover", y},
    {"axis.set_deadman", R"({"axis":"y","ms":5000})"},
    {"axis.test_deadman", R"({"axis":"x"})", {}, {0}},
    {"axis.tune",
     R"({"axis":"x","max_current":100,"from_microsteps":0,"to_microsteps":20000})",
     {},
     {0},
     false,
     false,
     true},
    {"axis.verify", R"({"axis":"x","from_microsteps":0,"to_microsteps":1})", {}, {0}},
    {"capture.start", R"({"axis":"x","channels":["actual_position"],"samples":10})"},
    {"capture.state", R"({"axis":"x","capture":"$capture"})", {capture}},
    {"capture.read", R"({"axis":"x","capture":"$capture","first":0,"count":4})", {capture}},
    {"capture.end", R"({"axis":"x"})", {capture}},
    {"axis.get_state", y},
    {"axis.get_errors", y},
    {"axis.get_units", y},
    {"parameter.get", R"({"axis":"y","parameter":"max_velocity"})"},
    {"parameter.set", R"({"axis":"y","parameter":4,"value":1200})"},
    {"parameter.store", R"({"axis":"y","parameter":"max_velocity"})"},
    {"parameter.restore", R"({"axis":"y","parameter":"max_velocity"})"},
    {"parameter.list", y},
    {"coordinate.get", R"({"axis":"y","number":3})"},
    {"coordinate.set", R"({"axis":"y","number":3,"position_microsteps":-700})"},
    {"coordinate.capture", R"({"axis":"y","number":3})"},
    {"coordinate.move",
     R"({"axis":"y","number":3})",
     {{"coordinate.set", R"({"axis":"y","number":3,"position_microsteps":-700})"}},
     {1}},
    {"coordinate.start",
     R"({"bus":"bench","address":2,"number":3,"motors":[0,1]})",
     {{"coordinate.set", R"({"axis":"y","number":3,"position_microsteps":-700})"}},
     {1, 2}},
    {"coordinate.store", R"({"axis":"y","number":3})"},
    {"coordinate.load", R"({"axis":"y","number":3})"},
    {"global.get", R"({"bus":"bench","address":2,"parameter":66})"},
    {"global.set", R"({"bus":"bench","address":2,"parameter":5,"bank":2,"value":4711})"},
    {"global.store", R"({"bus":"bench","address":2,"parameter":5,"bank":2})"},
    {"global.restore", R"({"bus":"bench","address":2,"parameter":5,"bank":2})"},
    {"io.get", R"({"bus":"bench","address":2,"port":0})"},
    {"io.set", R"({"bus":"bench","address":2,"port":0,"value":0})"},
    {"module.info", module_2},
    {"module.report_arrivals", R"({"bus":"bench","address":2,"motors":[0],"every":true})"},
    {"module.reset", module_2, {}, {}, false, true},
    {"module.factory_reset", module_2, {}, {}, false, true},
    {"program.assemble", R"({"text":"Loop: WAIT TICKS, 0, 10\nJA Loop\n"})"},
    {"program.load", program},
    {"program.compare", program, {{"program.load", program}}},
    {"program.read", R"({"bus":"bench","address":2,"length":8})"},
    {"program.run",
     R"({"bus":"bench","address":2,"first_address":0})",
     {{"program.load", program}}},
    {"program.stop", module_2},
    {"program.step", module_2, {{"program.load", program}}},
    {"program.step_to", R"({"bus":"bench","address":2,"until":[1]})", {{"program.load", program}}},
    {"program.reset", module_2},
    {"program.status", module_2},
    {"program.set_breakpoint", R"({"bus":"bench","address":2,"at":1})"},
    {"program.clear_breakpoint", R"({"bus":"bench","address":2,"at":1})"},
    {"program.clear_breakpoints", module_2},
    {"firmware.status", R"({"bus":"bench","address":1})"},
    {"firmware.stage", R"({"offset":0,"data":"3131313056313432"})"},
    {"firmware.upload",
     R"({"bus":"bench","address":1,"start":16384,"bytes":8})",
     {{"firmware.stage", R"({"offset":0,"data":"3131313056313432"})"}},
     {},
     false,
     true},
    {"system.stop_all"},
    {"subscribe", R"({"axes":["x"],"interval_ms":20,"parameters":["load_value"]})"},
    {"unsubscribe",
     R"({"subscription":"$subscription"})",
     {{"subscribe", R"({"axes":["x"],"interval_ms":20})"}}},
};

}  // namespace calls

inline const std::vector<MethodCall>& method_calls() { return calls::all; }

}  // namespace tmcld::test
