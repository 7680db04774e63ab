// The client that sets an axis turning owns that, whatever is written meanwhile and by which way:
// when it has gone, the axis stands. The simulated motor says whether it does.
#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <unistd.h>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/parameter_number.hpp"
#include "unit/port_fixture.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;

constexpr std::array<std::string_view, 4> one_of_each_family{"TMCM-3110", "TMCM-6212", "TMCM-142",
                                                             "TMCM-3351"};

/// What a client can do to an axis, by a method or by a raw command.
struct Write {
  std::string name;
  std::function<void(CableBench&)> by_method;
  std::optional<Request> raw{};
};

Write set(std::uint8_t parameter, std::int32_t value) {
  return {
      "set " + std::to_string(parameter) + " " + std::to_string(value),
      [=](CableBench& bench) {
        bench.call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
      },
      request_of(Command::SAP, parameter, 0, value)};
}
Write raw(Command command, std::uint8_t type, std::int32_t value) {
  const auto request = request_of(command, type, 0, value);
  return {"raw " + std::string(tmcl::name_of(command)) + " " + std::to_string(type) + " " +
              std::to_string(value),
          [=](CableBench& bench) {
            bench.call("module.execute", {{"bus", "bench"},
                                          {"address", 1},
                                          {"command", static_cast<int>(command)},
                                          {"type", type},
                                          {"motor", 0},
                                          {"value", value}});
          },
          request};
}
Write call(const std::string& method, json::object params) {
  params["axis"] = "x";
  return {method + " " + json::serialize(params),
          [=](CableBench& bench) { bench.call(method, params); }};
}

class Scene : public CableBench {
 public:
  explicit Scene(std::string_view model) : CableBench(cable_config, model) {
    const auto table = tmcl::axis_parameters(*tmcl::find_model(model));
    if (const auto mode = tmcl::mode_parameter(table)) ramp_mode = mode->number;
    // Positions are reached soon.
    for (const auto parameter : {ap::max_velocity, ap::max_acceleration}) {
      const auto greatest = find_parameter(table, parameter)->maximum;
      call("parameter.set",
           {{"axis", "x"}, {"parameter", parameter}, {"value", std::min(greatest, 200'000)}});
    }
    speed = find_parameter(table, ap::max_velocity)->maximum > 10'000 ? 20'000 : 500;
  }
  /// Whether it comes to stand, and stays so.
  bool stands() {
    for (int looks = 0; looks < 120; ++looks) {
      time.run_for(500ms);
      if (get(0, ap::actual_velocity) != 0) continue;
      time.run_for(200ms);
      if (get(0, ap::actual_velocity) == 0) return true;
    }
    return false;
  }
  std::string state(const char* field) {
    const auto state = call("axis.get_state", {{"axis", "x"}});
    return json::serialize(state.value().at(field));
  }
  std::int32_t speed = 0;
  /// Where a model has none, it refuses this one.
  std::uint8_t ramp_mode = tmcl::number_of(tmcl::Family::tmc429, "ramp_mode");
};

class TurningOf : public testing::TestWithParam<std::string_view> {
 protected:
  Scene scene{GetParam()};
};

std::vector<std::vector<Write>> ways_to_turn(std::int32_t speed, std::uint8_t ramp_mode) {
  const auto rotate = call("axis.rotate", {{"velocity_internal", speed}});
  return {
      {rotate},
      {rotate, set(ap::target_position, 79)},
      {rotate, raw(Command::SAP, ap::target_position, 79)},
      {rotate, set(ap::actual_position, 128), set(ap::target_position, 79)},
      {rotate, set(ap::target_velocity, speed / 2)},
      {call("axis.stop", {}), set(ap::target_velocity, speed)},
      {raw(Command::ROR, 0, speed)},
      {raw(Command::ROL, 0, speed)},
      {raw(Command::MST, 0, 0), raw(Command::SAP, ap::target_velocity, speed)},
      {call("axis.move_to", {{"position_microsteps", 500'000}}), set(ramp_mode, 2)},
      {call("axis.move_to", {{"position_microsteps", 500'000}}), raw(Command::SAP, ramp_mode, 2)}};
}

std::string said(const std::vector<Write>& writes) {
  std::string text;
  for (const auto& write : writes) text += write.name + "; ";
  return text;
}

TEST_P(TurningOf, AClientEndsWithItInEveryWay) {
  for (const auto& writes : ways_to_turn(scene.speed, scene.ramp_mode)) {
    scene.be_another_client();
    for (const auto& write : writes) {
      write.by_method(scene);
      scene.time.run_for(500ms);
    }
    scene.client_leaves();
    EXPECT_TRUE(scene.stands()) << said(writes);
  }
}

TEST_P(TurningOf, AHostAtAPortEndsWithItInEveryWay) {
  for (const auto& writes : ways_to_turn(scene.speed, scene.ramp_mode)) {
    if (!std::ranges::all_of(writes, [](const auto& write) { return write.raw.has_value(); }))
      continue;
    PortHost host(scene, "a", Role::operate);
    for (const auto& write : writes) host.ask(*write.raw);
    for (const auto& write : {set(ap::actual_position, 128), set(ap::target_position, 79)})
      host.ask(*write.raw);
    scene.time.run_for(500ms);
    host.go();
    EXPECT_TRUE(scene.stands()) << said(writes);
  }
}

Write any_write(tmcl::test::Random<>& random, std::int32_t speed, std::uint8_t ramp_mode) {
  const auto velocity = static_cast<std::int32_t>(random.either_way(random.between(1, speed)));
  const auto position = static_cast<std::int32_t>(random.between(-20'000, 20'000));
  const auto faster = std::abs(velocity);
  switch (random.between(0, 19)) {
    case 0: return call("axis.rotate", {{"velocity_internal", velocity}});
    case 1: return call("axis.rotate", {{"velocity_internal", 0}});
    case 2: return set(ap::target_velocity, velocity);
    case 3: return set(ap::target_velocity, 0);
    case 4: return set(ap::target_position, position);
    case 5: return set(ap::actual_position, position);
    case 6: return set(ramp_mode, static_cast<std::int32_t>(random.between(0, 2)));
    case 7: return raw(Command::ROR, 0, faster);
    case 8: return raw(Command::ROL, 0, faster);
    case 9: return raw(Command::SAP, ap::target_velocity, velocity);
    case 10: return raw(Command::SAP, ramp_mode, static_cast<std::int32_t>(random.between(0, 2)));
    case 11: return raw(Command::SAP, ap::target_position, position);
    case 12: return raw(Command::MVP, 0, position);
    case 13: return raw(Command::RSAP, ap::target_velocity, 0);
    case 14: return raw(Command::AAP, random.one_in(2) ? ap::target_velocity : ramp_mode, 0);
    case 15: return raw(Command::RFS, 1, 0);
    case 16: return call("axis.move_to", {{"position_microsteps", position}, {"predict", false}});
    case 17: return call("axis.stop", {});
    case 18: return raw(Command::MST, 0, 0);
    default: return raw(Command::ROR, 0, 0);
  }
}

TEST_P(TurningOf, WhateverIsWrittenItStandsWhenAllHaveGone) {
  const auto rounds = tmcl::test::rounds(60);
  for (int round = 0; round < rounds; ++round) {
    tmcl::test::Random<> random(tmcl::test::seed() + static_cast<std::uint64_t>(round));
    scene.be_another_client();
    PortHost host(scene, "a", Role::configure);
    std::string story;
    for (auto writes = random.between(1, 7); writes > 0; --writes) {
      const auto write = any_write(random, scene.speed, scene.ramp_mode);
      const bool by_port = write.raw && random.one_in(3);
      story += (by_port ? "port: " : "") + write.name + "; ";
      if (by_port) {
        host.ask(*write.raw);
      } else {
        write.by_method(scene);
      }
      if (random.one_in(3)) scene.call("axis.get_state", {{"axis", "x"}});
      scene.time.run_for(std::chrono::milliseconds(random.between(0, 800)));
    }
    scene.client_leaves();
    host.go();
    ASSERT_TRUE(scene.stands()) << "round " << round << ": " << story;
  }
}

INSTANTIATE_TEST_SUITE_P(Families, TurningOf, testing::ValuesIn(one_of_each_family),
                         [](const auto& family) {
                           std::string name(family.param);
                           std::erase(name, '-');
                           return name;
                         });

// ---- whom it belongs to ------------------------------------------------------------------------

class Turning : public testing::Test {
 protected:
  std::string name_of(const char* method, json::object params) {
    params["axis"] = "x";
    return scene.name_of_error(scene.call(method, std::move(params)));
  }
  Scene scene{"TMCM-3110"};
};

TEST_F(Turning, IsOfItsOwnerUntilItIsSeenToStand) {
  scene.call("axis.stop", {{"axis", "x"}});
  scene.call("parameter.set", {{"axis", "x"}, {"parameter", 2}, {"value", 500}});
  EXPECT_EQ(scene.state("owner"), "\"client\"");
  EXPECT_EQ(scene.state("unattended"), "false");
  scene.call("parameter.set", {{"axis", "x"}, {"parameter", 0}, {"value", 79}});
  EXPECT_EQ(scene.state("owner"), "\"client\"") << "it turns on";
  scene.be_another_client();
  EXPECT_EQ(name_of("axis.move_to", {{"position_microsteps", 9}}), "leased");
  EXPECT_EQ(name_of("parameter.set", {{"parameter", 4}, {"value", 100}}), "leased");
}

TEST_F(Turning, ThatHasEndedUnseenHindersNobody) {
  scene.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 500}});
  scene.call("parameter.set", {{"axis", "x"}, {"parameter", 2}, {"value", 0}});
  scene.time.run_for(5s);
  scene.be_another_client();
  EXPECT_EQ(name_of("axis.move_to", {{"position_microsteps", 9}}), "none");
}

TEST_F(Turning, OfAReleasedLeaseIsOfItsHolder) {
  const auto lease = scene.call("lease.acquire", {{"axes", json::array{"x"}}}).value();
  scene.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 500}});
  scene.call("lease.release",
             {{"lease", lease.at("lease")}, {"epoch", lease.at("epoch")}, {"stop", false}});
  EXPECT_EQ(scene.state("owner"), "\"client\"");
  scene.client_leaves();
  EXPECT_TRUE(scene.stands());
}

TEST_F(Turning, ThatNoClientHasBegunIsUnattended) {
  scene.other_master(request_of(Command::ROR, 0, 0, 500));
  scene.time.run_for(1s);
  EXPECT_EQ(scene.state("unattended"), "true");
  EXPECT_EQ(scene.state("owner"), "null");
  EXPECT_THAT(scene.audited, Contains(HasSubstr("axis=x turns unattended")));
  scene.call("axis.stop", {{"axis", "x"}});
  scene.time.run_for(5s);
  EXPECT_EQ(scene.state("unattended"), "false");
}

TEST_F(Turning, OfAProgramIsUnattendedAndTheCallerIsTold) {
  const json::object module{{"bus", "bench"}, {"address", 1}};
  const auto run = scene.call("program.run", module);
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->at("unattended"), true);
  EXPECT_THAT(scene.audited.back(), testing::EndsWith("outcome=done unattended"));
  auto raw_run = module;
  raw_run["command"] = "RUN_APPLICATION";
  const auto raw_answer = scene.call("module.execute", raw_run);
  ASSERT_TRUE(raw_answer) << raw_answer.error().message;
  EXPECT_THAT(json::serialize(raw_answer->at("warnings")), HasSubstr("unattended"));
}

TEST_F(Turning, ByARawCommandIsWarnedOf) {
  const auto answer = scene.call(
      "module.execute",
      {{"bus", "bench"}, {"address", 1}, {"command", "ROR"}, {"motor", 2}, {"value", 500}});
  ASSERT_TRUE(answer);
  EXPECT_THAT(json::serialize(answer->at("warnings")), HasSubstr("stopped when that ends"));
  scene.client_leaves();
  scene.time.run_for(5s);
  EXPECT_EQ(scene.get(2, ap::actual_velocity), 0) << "a motor that no axis names";
}

// ---- the daemon is killed ----------------------------------------------------------------------

TEST(KilledWhileItTurns, EveryOwnedAxisIsStoppedByTheNextRun) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("tmcl-turning-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::string journal = folder / "journal";
  for (const auto& writes : ways_to_turn(500, tmcl::number_of(tmcl::Family::tmc429, "ramp_mode"))) {
    Scene scene("TMCM-3110");
    scene.end_gateway();
    scene.start_gateway(journal);
    for (const auto& write : writes) {
      write.by_method(scene);
      scene.time.run_for(500ms);
    }
    std::ostringstream left;
    left << std::ifstream(journal).rdbuf();
    scene.end_gateway();
    std::ofstream(journal) << left.str();
    scene.time.run_for(1s);
    EXPECT_NE(scene.get(0, ap::actual_velocity), 0) << said(writes);
    scene.start_gateway(journal);
    EXPECT_TRUE(scene.stands()) << said(writes);
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace tmcld::test
