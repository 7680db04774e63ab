// Programs, homing and what concerns modules as a whole, through the daemon: what clients are
// told, and what happens when one of them stops an axis or goes.
#include <gmock/gmock.h>

#include "tmcl/program.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using tmcl::Command;
using tmcl::Request;
using tmcl::program::Program;

constexpr tmcl::ModuleAddress module{1};
constexpr Request end_download{module, Command::END_DOWNLOAD, 0, 0, 0};

std::string name_in(const json::object& answer) {
  return text(answer.at("error").at("data").at("name"));
}

Program long_program() {
  Program program;
  for (int i = 0; i < 50; ++i) program.push_back({Command::MVP, 0, 1, i});
  return program;
}

class DaemonProgram : public DaemonTest {
 protected:
  json::object here(json::object params = {}) {
    params["bus"] = "bench";
    params["address"] = 1;
    return params;
  }
  json::object load_params(const Program& program) {
    return here({{"program", tmcl::program::to_hex(program)}});
  }
  json::object result_of(std::string_view method, json::object params) {
    const auto answer = client.answer_to(client.send(method, std::move(params)));
    EXPECT_TRUE(answer.contains("result")) << json::serialize(answer);
    return answer.contains("result") ? answer.at("result").as_object() : json::object{};
  }
  FakeModule& fake() { return daemon.wire().modules.at(1); }
  /// Called on the daemon's thread before this command of the program is recorded.
  void when_recording(std::int32_t value, std::function<void()> act) {
    daemon.on_reactor([&] {
      fake().before = [value, act = std::move(act)](FakeModule& self, const Request& request) {
        if (self.downloading() && request.command == Command::MVP && request.value == value) act();
      };
      return 0;
    });
  }
  bool is_out_of_download_mode() {
    return daemon.eventually(
        [&] { return !fake().downloading() && daemon.wire().seen.back() == end_download; });
  }
};

TEST_F(DaemonProgram, IsMadeOfAText) {
  const auto made = result_of("program.assemble", {{"text",
                                                    "Far = 7\nLoop:\n  MVP ABS, 0, Far\n"
                                                    "  JA Loop\n"}});
  const Program expected{{Command::MVP, 0, 0, 7}, {Command::JA, 0, 0, 0}};
  EXPECT_EQ(text(made.at("program")), tmcl::program::to_hex(expected));
  EXPECT_EQ(made.at("commands"), 2);
  EXPECT_EQ(made.at("lines"), (json::array{3, 4}));
  EXPECT_EQ(made.at("labels"), (json::array{{{"name", "Loop"}, {"address", 0}}}));
}

TEST_F(DaemonProgram, OfATextHasAllProblemsWithTheirPlaces) {
  const auto answer = client.answer_to(
      client.send("program.assemble", {{"text", "MVP ABS, 0\nSTOP\n  JA Nowhere\n"}}));
  EXPECT_EQ(name_in(answer), "bad_program");
  const auto& problems = answer.at("error").at("data").at("problems").as_array();
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].at("line"), 1);
  EXPECT_EQ(problems[1].at("line"), 3);
  EXPECT_EQ(problems[1].at("column"), 6);
}

TEST_F(DaemonProgram, OfATextKnowsTheParametersOfAModel) {
  const auto made = result_of("program.assemble", {{"text",
                                                    "#include TMCLParam.tmc\nSAP "
                                                    "MaxCurrent, 0, 9\n"},
                                                   {"model", "TMCM-1110"}});
  EXPECT_EQ(made.at("commands"), 1);
  const auto unknown =
      client.answer_to(client.send("program.assemble", {{"text", "STOP\n"}, {"model", "TMCM-9"}}));
  EXPECT_EQ(name_in(unknown), "unknown_model");
}

TEST_F(DaemonProgram, OfATextReadsNoFile) {
  for (const auto* path : {"/etc/passwd", "speeds.tmc", "../tmcld.toml"}) {
    const auto answer = client.answer_to(client.send(
        "program.assemble", {{"text", "#include \"" + std::string(path) + "\"\nSTOP\n"}}));
    EXPECT_EQ(name_in(answer), "bad_program");
    EXPECT_THAT(text(answer.at("error").at("data").at("problems").at(0).at("message")),
                testing::HasSubstr("tmcld reads no files"));
  }
}

TEST_F(DaemonProgram, IsLoadedComparedAndReadBack) {
  const auto program = long_program();
  EXPECT_EQ(result_of("program.load", load_params(program)).at("commands"), 50);
  EXPECT_EQ(result_of("program.compare", load_params(program)).at("commands"), 50);
  const auto read = result_of("program.read", here());
  EXPECT_EQ(text(read.at("program")), tmcl::program::to_hex(program));
  auto other = program;
  other[7].value = -1;
  const auto differs = client.answer_to(client.send("program.compare", load_params(other)));
  EXPECT_EQ(name_in(differs), "unexpected_value");
}

TEST_F(DaemonProgram, WhatIsNoProgramIsRefused) {
  for (const auto* wrong : {"", "1", "zz", "1c00", "1c00000000000000"}) {
    const auto answer = client.answer_to(client.send("program.load", here({{"program", wrong}})));
    EXPECT_EQ(name_in(answer), "bad_argument") << wrong;
  }
  EXPECT_EQ(daemon.requests_seen(Command::START_DOWNLOAD), 0U);
}

TEST_F(DaemonProgram, OthersWaitWhileItIsLoaded) {
  RpcClient other(daemon.socket());
  std::atomic<int> asked = -1;
  when_recording(30, [&] {
    asked = other.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 777}});
  });
  result_of("program.load", load_params(long_program()));
  ASSERT_GE(asked, 0);
  EXPECT_TRUE(other.answer_to(asked).contains("result"));
  daemon.on_reactor([&] {
    for (const auto& request : fake().recorded()) EXPECT_NE(request.value, 777);
    EXPECT_EQ(std::ranges::count(fake().executed(), 777, &Request::value), 1);
    return 0;
  });
}

TEST_F(DaemonProgram, AStopEndsIt) {
  RpcClient other(daemon.socket());
  std::atomic<int> asked = -1;
  when_recording(30, [&] { asked = other.send("axis.stop", {{"axis", "y"}}); });
  const auto loaded = client.answer_to(client.send("program.load", load_params(long_program())));
  EXPECT_EQ(name_in(loaded), "superseded_by_stop");
  EXPECT_TRUE(other.answer_to(asked).contains("result"));
  daemon.on_reactor([&] {
    EXPECT_FALSE(fake().downloading());
    const Request stop{module, Command::MST, 0, 1, 0};
    EXPECT_EQ(std::ranges::count(fake().recorded(), stop), 0);
    EXPECT_EQ(std::ranges::count(fake().executed(), stop), 1);
    EXPECT_EQ(fake().program()[0].command, Command{});
    return 0;
  });
}

TEST_F(DaemonProgram, EndsWhenItsClientGoes) {
  auto gone = std::make_unique<RpcClient>(daemon.socket());
  std::atomic<bool> is_recording = false;
  when_recording(5, [&] { is_recording = true; });
  gone->send("program.load", load_params(Program(2000, {Command::MVP, 0, 1, 5})));
  ASSERT_TRUE(daemon.eventually([&] { return is_recording.load(); }));
  gone.reset();
  EXPECT_TRUE(is_out_of_download_mode());
}

TEST_F(DaemonProgram, EndsWithTheDaemon) {
  when_recording(5, [&] { daemon.daemon().stop(); });
  client.send("program.load", load_params(Program(2000, {Command::MVP, 0, 1, 5})));
  daemon.end();
  EXPECT_FALSE(fake().downloading());
  EXPECT_TRUE(fake().program().empty() || fake().program()[0].command == Command{});
}

TEST_F(DaemonProgram, HomingTellsItsSteps) {
  const auto id = client.send("axis.home", {{"axis", "x"}, {"mode", 5}});
  const auto result = client.answer_to(id).at("result").as_object();
  EXPECT_EQ(result.at("correction_microsteps"), fake().parameter(0, 197));
  EXPECT_EQ(fake().parameter(0, 193), 5);
}

TEST_F(DaemonProgram, AModeThatTheModelHasNotIsNotWritten) {
  for (const auto* method : {"axis.home", "axis.start_home"}) {
    const auto id = client.send(method, {{"axis", "x"}, {"mode", 137}});
    EXPECT_EQ(name_in(client.answer_to(id)), "out_of_range");
  }
  EXPECT_EQ(daemon.on_reactor([&] { return daemon.wire().count(Command::SAP); }), 0U);
}

TEST_F(DaemonProgram, AStopEndsTheSearchToo) {
  daemon.on_reactor([&] {
    fake().before = [](FakeModule& self, const Request& request) {
      if (request.command == Command::RFS && request.type == 2)
        self.execute_quietly({module, Command::RFS, 0, 0, 0});
    };
    return 0;
  });
  const auto search = client.send("axis.home", {{"axis", "x"}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.wire().count(Command::RFS) > 2; }));
  RpcClient other(daemon.socket());
  EXPECT_TRUE(other.answer_to(other.send("axis.stop", {{"axis", "x"}})).contains("result"));
  EXPECT_EQ(name_in(client.answer_to(search)), "superseded_by_stop");
  daemon.on_reactor([&] {
    const Request end{module, Command::RFS, 1, 0, 0};
    EXPECT_EQ(std::ranges::count(fake().executed(), end), 1);
    return 0;
  });
}

TEST_F(DaemonProgram, GlobalParametersPortsAndCoordinatesGoThrough) {
  EXPECT_EQ(result_of("global.get", here({{"parameter", 66}})).at("value"), 2'000'066);
  EXPECT_EQ(result_of("global.get", here({{"parameter", "66"}})).at("value"), 2'000'066);
  EXPECT_EQ(result_of("global.get", here({{"parameter", "5"}, {"bank", 2}})).at("bank"), 2);
  EXPECT_EQ(result_of("io.set", here({{"port", 3}, {"value", 1}})).at("value"), 1);
  EXPECT_EQ(result_of("io.get", here({{"port", 3}, {"bank", 2}})).at("value"), 1);
  result_of("coordinate.set", {{"axis", "x"}, {"number", 4}, {"position_microsteps", -9}});
  EXPECT_EQ(result_of("coordinate.get", {{"axis", "x"}, {"number", 4}}).at("position_microsteps"),
            -9);
  EXPECT_EQ(
      result_of("parameter.store", {{"axis", "x"}, {"parameter", "max_velocity"}}).at("number"), 4);
  EXPECT_EQ(result_of("module.info", here()).at("module_id"), 4'000'000);
  const auto unknown =
      client.answer_to(client.send("global.get", here({{"parameter", "nonsense"}})));
  EXPECT_EQ(name_in(unknown), "unknown_parameter");
}

TEST_F(DaemonProgram, SeveralMotorsStartTogether) {
  result_of("coordinate.start", here({{"number", 3}, {"motors", json::array{0, 2}}}));
  result_of("coordinate.start",
            here({{"number", 3}, {"motors", json::array{1, 1.0}}, {"interpolated", true}}));
  result_of("module.report_arrivals", here({{"motors", json::array{0, 2}}, {"every", true}}));
  result_of("module.report_arrivals", here({{"motors", json::array{}}}));
  daemon.on_reactor([&] {
    const auto& seen = daemon.wire().seen;
    EXPECT_EQ(std::ranges::count(seen, Request{module, Command::MVP, 2, 0x85, 3}), 1);
    EXPECT_EQ(std::ranges::count(seen, Request{module, Command::MVP, 2, 0x42, 3}), 1);
    EXPECT_EQ(std::ranges::count(seen, Request{module, Command::TARGET_REACHED_EVENT, 1, 0, 5}), 1);
    EXPECT_EQ(std::ranges::count(seen, Request{module, Command::TARGET_REACHED_EVENT, 0, 0, 0}), 1);
    return 0;
  });
  for (const auto& motors : {json::array{6}, json::array{-1}, json::array{"0"}, json::array{0.5},
                             json::array{}, json::array{0, 1'000'000'000'000}}) {
    const auto answer = client.answer_to(
        client.send("coordinate.start", here({{"number", 3}, {"motors", motors}})));
    EXPECT_THAT(name_in(answer), testing::AnyOf("out_of_range", "bad_argument"));
  }
}

}  // namespace
}  // namespace tmcld::test
