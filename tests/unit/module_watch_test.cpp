// What is made of a module that is not what it was, and of one that cannot tell.
#include <gmock/gmock.h>

#include "tmcl/version.hpp"
#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tmcl::Command;

class ModuleWatch : public testing::Test {
 protected:
  explicit ModuleWatch(const std::string& toml = two_axes()) : bench(toml) {
    bench.gateway().on_event([this](const GatewayEvent& event) {
      if (event.kind == GatewayEvent::Kind::module_replaced) replaced.push_back(event.text);
    });
  }
  static bool asks_timer(const tmcl::Request& request) {
    return request.command == Command::GGP && request.motor == 0 &&
           request.type == tmcl::global_parameter::tick_timer;
  }
  /// Its place is taken by a module with another firmware, whose timer answers so.
  void replace(const std::function<tmcl::Reply(tmcl::Reply)>& timer) {
    module().play = [timer](const tmcl::Request& request) -> std::optional<tmcl::Reply> {
      tmcl::Reply reply{tmcl::default_host_address, 1, tmcl::Status::ok, request.command, 0};
      if (asks_timer(request)) return timer(reply);
      if (request.command != Command::GET_FIRMWARE_VERSION) return std::nullopt;
      reply.value = to_value(tmcl::FirmwareVersion{3110, 1, 14});
      return reply;
    };
    be_silent_for(1s);
  }
  static tmcl::Reply refused(tmcl::Reply reply) {
    reply.status = tmcl::Status::wrong_type;
    return reply;
  }
  tmcl::Reply right(tmcl::Reply reply) const {
    const auto now = bench.time.now().time_since_epoch();
    reply.value = static_cast<std::int32_t>(
        std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
    return reply;
  }
  void be_silent_for(tmcl::Duration duration) {
    bench.wire.loses = [](const tmcl::Request&) { return true; };
    bench.call("axis.get_state", {{"axis", "x"}});
    bench.time.run_for(duration);
    bench.wire.loses = {};
    bench.time.run_for(5s);
  }
  FakeModule& module() { return bench.wire.modules.at(1); }
  std::string watched_by() {
    const auto list = bench.call("module.list", {});
    return std::string(list->at("modules").as_array().front().at("watched_by").as_string());
  }
  std::string name_of_move(const char* method = "axis.move_to",
                           json::object params = {{"position_microsteps", 5}}) {
    params["axis"] = "x";
    const auto result = bench.call(method, params);
    return result ? "none" : result.error().name;
  }

  VirtualGateway bench;
  std::vector<std::string> replaced;
};

TEST_F(ModuleWatch, ALatchIsOnEveryAxisOfAModuleThatWasReplaced) {
  EXPECT_EQ(name_of_move(), "none");
  replace(refused);
  ASSERT_EQ(replaced.size(), 1U);
  EXPECT_THAT(replaced.front(), testing::AllOf(HasSubstr("TMCM-3110, firmware 1.14"),
                                               HasSubstr("before that TMCM-3110, firmware 1.09")));
  EXPECT_EQ(name_of_move(), "latched");
  EXPECT_EQ(name_of_move("axis.rotate", {{"velocity_internal", 5}}), "latched");
  EXPECT_TRUE(bench.call("axis.stop", {{"axis", "x"}}));
  EXPECT_TRUE(bench.call("axis.recover", {{"axis", "x"}}));
  EXPECT_EQ(name_of_move(), "none");
}

TEST_F(ModuleWatch, TheSameModuleIsNotLatchedByItsSilence) {
  be_silent_for(1s);
  EXPECT_TRUE(replaced.empty());
  EXPECT_EQ(name_of_move(), "none");
}

TEST_F(ModuleWatch, AModuleWithoutATimerIsSaidToBeUnwatched) { EXPECT_EQ(watched_by(), "none"); }

TEST_F(ModuleWatch, ATimerThatGoesOnIsWatched) {
  replace([this](tmcl::Reply reply) { return right(reply); });
  EXPECT_EQ(watched_by(), "tick");
}

TEST_F(ModuleWatch, ATimerThatStandsTellsNothing) {
  replace([](tmcl::Reply reply) {
    reply.value = 4711;
    return reply;
  });
  EXPECT_EQ(watched_by(), "tick") << "one reading does not tell";
  bench.call("axis.recover", {{"axis", "x"}});
  bench.time.run_for(1s);
  EXPECT_EQ(name_of_move(), "none");
  EXPECT_EQ(watched_by(), "none");
}

TEST_F(ModuleWatch, OneRefusalOfTheTimerIsNoReasonNotToLook) {
  auto left = 1;
  replace([&](tmcl::Reply reply) { return left-- > 0 ? refused(reply) : right(reply); });
  EXPECT_EQ(watched_by(), "tick");
  EXPECT_LT(left, 0);
}

class Unreferenced : public ModuleWatch {
 protected:
  Unreferenced() : ModuleWatch(two_axes() + "reference = \"required\"\n") {}
  std::string name_of(const char* method, json::object params) {
    params["axis"] = "y";
    const auto result = bench.call(method, params);
    return result ? "none" : result.error().name;
  }
};

TEST_F(Unreferenced, AnAxisIsSentToNoPosition) {
  EXPECT_EQ(name_of("axis.move_to", {{"position_microsteps", 5}}), "latched");
  EXPECT_EQ(name_of("parameter.set", {{"parameter", "target_position"}, {"value", 5}}), "latched");
  EXPECT_EQ(name_of("axis.rotate", {{"velocity_internal", 5}}), "none");
  EXPECT_EQ(name_of("axis.move_by", {{"distance_microsteps", 5}}), "none");
  EXPECT_EQ(name_of_move(), "none") << "the other axis needs no reference";
}

TEST_F(Unreferenced, AnAxisThatWasToldWhereItIsMayGoAnywhere) {
  EXPECT_EQ(name_of("parameter.set", {{"parameter", "actual_position"}, {"value", 0}}), "none");
  EXPECT_EQ(name_of("axis.move_to", {{"position_microsteps", 5}}), "none");
}

TEST_F(Unreferenced, AnAxisIsSentToNoPositionByARawCommandEither) {
  const auto name_of_raw = [&](const char* command, int type, int motor) {
    const auto result = bench.call("module.execute", {{"bus", "bench"},
                                                      {"address", 1},
                                                      {"command", command},
                                                      {"type", type},
                                                      {"motor", motor},
                                                      {"value", 5}});
    return result ? "none" : result.error().name;
  };
  const auto sent = module().executed().size();
  constexpr int x_and_y = 0x43;
  for (const auto& [command, type, motor] : {std::tuple{"MVP", 0, 1},
                                             {"MVP", 2, 1},
                                             {"MVP", 2, x_and_y},
                                             {"MVPA", 0, 1},
                                             {"MVPA", 2, 1},
                                             {"MVPA", 2, x_and_y},
                                             {"SAP", 0, 1},
                                             {"AAP", 0, 1}})
    EXPECT_EQ(name_of_raw(command, type, motor), "latched") << command << ' ' << type;
  EXPECT_EQ(module().executed().size(), sent);
  EXPECT_EQ(name_of_raw("MVP", 0, 0), "none") << "the other axis needs no reference";
  EXPECT_EQ(name_of_raw("MVP", 1, 1), "none") << "it goes from where it is";
  EXPECT_EQ(name_of_raw("SAP", 4, 1), "none");
  EXPECT_EQ(name_of("parameter.set", {{"parameter", "actual_position"}, {"value", 0}}), "none");
  for (const auto& [command, type, motor] : {std::tuple{"MVP", 0, 1}, {"MVP", 2, x_and_y}})
    EXPECT_EQ(name_of_raw(command, type, motor), "none");
}

}  // namespace
}  // namespace tmcld::test
