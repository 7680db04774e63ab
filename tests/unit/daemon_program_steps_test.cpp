// A program on a simulated module, command by command through the daemon.
#include <gmock/gmock.h>

#include "support/program_host.hpp"
#include "tmcl/program.hpp"
#include "unit/simulated_modules.hpp"

namespace tmcld::test {
namespace {

using tmcl::Command;

constexpr std::uint16_t address = 1;

class DaemonProgramSteps : public testing::Test {
 protected:
  DaemonProgramSteps() {
    modules_.add(daemon.wire(), "TMCM-3110", address);
    daemon.start();
    client = std::make_unique<RpcClient>(daemon.socket());
  }

  static json::object here(json::object params = {}) {
    params["bus"] = "bench";
    params["address"] = address;
    return params;
  }
  json::object call(std::string_view method, json::object params = {}) {
    return client->answer_to(client->send(method, here(std::move(params))));
  }
  void load(const std::string& text) {
    const auto program = tmcl::program::to_hex(tmcl::sim::assembled(text));
    ASSERT_TRUE(call("program.load", {{"program", program}}).contains("result"));
    ASSERT_TRUE(call("program.reset").contains("result"));
  }
  json::object step_to(json::object params = {}) {
    const auto answer = call("program.step_to", std::move(params));
    EXPECT_TRUE(answer.contains("result")) << json::serialize(answer);
    return answer.contains("result") ? answer.at("result").as_object() : json::object{};
  }
  std::int32_t value(std::uint8_t parameter, std::uint8_t motor = 0) {
    return daemon.on_reactor([&] { return modules_.get(address, parameter, motor); });
  }
  std::int32_t state() {
    return daemon.on_reactor([&] {
      const tmcl::Request request{tmcl::ModuleAddress{address}, Command::GGP,
                                  tmcl::global_parameter::application_status, 0, 0};
      return modules_.carry_out(request).value;
    });
  }

 private:
  std::shared_ptr<VirtualReactor> reactor_ = std::make_shared<VirtualReactor>();
  SimulatedModules modules_{reactor_->clock};

 protected:
  TestDaemon daemon{two_axes(), reactor_};
  std::unique_ptr<RpcClient> client;
};

const std::string loop =
    "CALCV LOAD, 3, 3\nLoop: MVP ABS, 0, 2000\nWAIT POS, 0, 0\nMVP ABS, 0, 0\nWAIT POS, 0, 0\n"
    "DJNZ 3, Loop\nSTOP\n";

TEST_F(DaemonProgramSteps, GoesToTheBreakpointsAndToTheEnd) {
  load(loop);
  auto stepped = step_to();
  EXPECT_EQ(stepped.at("steps"), 1);
  EXPECT_EQ(stepped.at("next_address"), 1);
  stepped = step_to({{"until", json::array{3, 6}}});
  EXPECT_EQ(stepped.at("reason"), "address");
  EXPECT_EQ(stepped.at("next_address"), 3);
  EXPECT_EQ(value(tmcl::axis_parameter::actual_position), 2000) << "the WAIT took its time";
  stepped = step_to({{"until", json::array{6}}});
  EXPECT_EQ(stepped.at("next_address"), 6);
  stepped = step_to({{"until", json::array{6}}});
  EXPECT_EQ(stepped.at("reason"), "ended");
  EXPECT_EQ(stepped.at("last_error"), 0);
}

TEST_F(DaemonProgramSteps, AStopOfAMotorEndsItAndNoMoreCommandsAreExecuted) {
  load("Loop: CALCV ADD, 3, 1\nJA Loop\n");
  const auto stepping = client->send("program.step_to", here({{"most_steps", 100'000}}));
  daemon.run_for(std::chrono::seconds(1));
  RpcClient other(daemon.socket());
  EXPECT_TRUE(other.answer_to(other.send("axis.stop", {{"axis", "y"}})).contains("result"));
  const auto answer = client->answer_to(stepping);
  EXPECT_EQ(text(answer.at("error").at("data").at("name")), "superseded_by_stop");
}

TEST_F(DaemonProgramSteps, AStopOfTheProgramEndsIt) {
  load("Loop: WAIT TICKS, 0, 100\nJA Loop\n");
  const auto stepping = client->send("program.step_to", here({{"most_steps", 1000}}));
  daemon.run_for(std::chrono::milliseconds(500));
  RpcClient other(daemon.socket());
  EXPECT_TRUE(other.answer_to(other.send("program.stop", here())).contains("result"));
  const auto answer = client->answer_to(stepping);
  EXPECT_EQ(answer.at("result").at("reason"), "ended") << json::serialize(answer);
}

TEST_F(DaemonProgramSteps, AClientThatGoesLeavesNothingMoving) {
  load("ROR 0, 500\nROR 2, 500\nLoop: WAIT TICKS, 0, 10\nJA Loop\n");
  client->send("program.step_to", here({{"most_steps", 1000}}));
  ASSERT_TRUE(
      daemon.eventually([&] { return value(tmcl::axis_parameter::actual_velocity, 2) > 0; }));
  client.reset();
  EXPECT_TRUE(daemon.eventually([&] {
    return value(tmcl::axis_parameter::actual_velocity, 0) == 0 &&
           value(tmcl::axis_parameter::actual_velocity, 2) == 0 && state() == 0;
  }));
  daemon.run_for(std::chrono::seconds(5));
  EXPECT_EQ(value(tmcl::axis_parameter::actual_velocity, 2), 0);
}

TEST_F(DaemonProgramSteps, AWaitIsCutShortAndGoesOn) {
  load("WAIT TICKS, 0, 500\nSTOP\n");
  auto stepped = step_to({{"wait_ms", 100}});
  EXPECT_EQ(stepped.at("reason"), "waits");
  EXPECT_EQ(stepped.at("next_address"), 0);
  daemon.run_for(std::chrono::seconds(6));
  EXPECT_EQ(call("program.status").at("result").at("next_address"), 1);
}

TEST_F(DaemonProgramSteps, ARunningProgramIsLeftAlone) {
  load("Loop: JA Loop\n");
  ASSERT_TRUE(call("program.run").contains("result"));
  const auto answer = call("program.step_to");
  EXPECT_EQ(text(answer.at("error").at("data").at("name")), "refused_by_module");
  EXPECT_EQ(state(), 1);
}

TEST_F(DaemonProgramSteps, AnAxisThatAnotherHasLeasedIsNotMoved) {
  load(loop);
  RpcClient other(daemon.socket());
  ASSERT_TRUE(other.answer_to(other.send("lease.acquire", {{"axes", json::array{"x"}}}))
                  .contains("result"));
  const auto answer = call("program.step_to");
  EXPECT_EQ(text(answer.at("error").at("data").at("name")), "leased");
}

}  // namespace
}  // namespace tmcld::test
