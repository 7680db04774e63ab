// The client that sets an axis turning owns that, whatever is written meanwhile and by which way:
// when it has gone, the axis stands. The simulated motor says whether it does.
#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <unistd.h>

#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "world/turning.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// What a firmware does whose target is set while it turns by velocity, no document says for all.
class TurningOf
    : public testing::TestWithParam<std::tuple<std::string_view, tmcl::VelocityTarget>> {
 protected:
  Scene scene{std::get<0>(GetParam()), std::get<1>(GetParam())};
};

std::vector<std::vector<Write>> ways_to_turn(std::int32_t speed, std::uint8_t ramp_mode) {
  const auto rotate = call_of_x("axis.rotate", {{"velocity_internal", speed}});
  return {{rotate},
          {rotate, set(ap::target_position, 79)},
          {rotate, raw(Command::SAP, ap::target_position, 79)},
          {rotate, set(ap::actual_position, 128), set(ap::target_position, 79)},
          {rotate, set(ap::target_velocity, speed / 2)},
          {call_of_x("axis.stop", {}), set(ap::target_velocity, speed)},
          {raw(Command::ROR, 0, speed)},
          {raw(Command::ROL, 0, speed)},
          {raw(Command::MST, 0, 0), raw(Command::SAP, ap::target_velocity, speed)},
          {call_of_x("axis.move_to", {{"position_microsteps", 500'000}}), set(ramp_mode, 2)},
          {call_of_x("axis.move_to", {{"position_microsteps", 500'000}}),
           raw(Command::SAP, ramp_mode, 2)}};
}

TEST_P(TurningOf, AClientEndsWithItInEveryWay) {
  for (const auto& writes : ways_to_turn(scene.speed, scene.ramp_mode)) {
    scene.be_another_client();
    for (const auto& write : writes) {
      scene.carry_out(write);
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

// ---- all that can be written, by all doors -----------------------------------------------------

class AnyWrite {
 public:
  AnyWrite(tmcl::test::Random<>& random, const Scene& scene) : random_(random), scene_(scene) {}

  Write any() {
    switch (random_.between(0, 7)) {
      case 0: return of_axis();
      case 1: return parameter();
      case 2: return motion();
      case 3: return stop();
      case 4: return indirect();
      case 5: return chip_register();
      case 6: return coordinate();
      default: return storage();
    }
  }
  Write of_program() {
    switch (random_.between(0, 7)) {
      case 0: return call_of("program.run", {{"bus", "bench"}, {"address", 1}});
      case 1: return call_of("program.step", {{"bus", "bench"}, {"address", 1}});
      case 2: return raw(Command::RUN_APPLICATION, 0, 0);
      case 3: return raw(Command::STEP_APPLICATION, 0, 0);
      case 4: return raw(Command::UF0, 0, velocity(), motor());
      case 5: return raw(Command::STOP_APPLICATION, 0, 0);
      case 6: return raw(Command::RESET_APPLICATION, 0, 0);
      default: return raw(Command::RST, 0, 0);
    }
  }

 private:
  std::int32_t velocity() {
    return static_cast<std::int32_t>(random_.either_way(random_.between(1, scene_.speed)));
  }
  std::int32_t position() { return static_cast<std::int32_t>(random_.between(-20'000, 20'000)); }
  std::int32_t mode() { return static_cast<std::int32_t>(random_.between(0, 3)); }
  std::uint8_t motor() {
    return random_.one_in(3) ? static_cast<std::uint8_t>(random_.between(0, 2)) : std::uint8_t{0};
  }
  std::uint8_t number() { return static_cast<std::uint8_t>(random_.between(0, 3)); }

  Write of_axis() {
    switch (random_.between(0, 5)) {
      case 0: return call_of_x("axis.rotate", {{"velocity_internal", velocity()}});
      case 1: return call_of_x("axis.rotate", {{"velocity_internal", 0}});
      case 2:
        return call_of_x("axis.move_to", {{"position_microsteps", position()}, {"predict", false}});
      case 3:
        return call_of_x("axis.move_by", {{"distance_microsteps", position()}, {"predict", false}});
      case 4: return call_of_x("coordinate.move", {{"number", number()}});
      default:
        return call_of_x("parameter.restore",
                         {{"parameter", random_.one_in(2) ? scene_.ramp_mode : ap::max_velocity}});
    }
  }
  Write parameter() {
    const auto command = random_.one_in(2);
    const auto write = [&](std::uint8_t number, std::int32_t value) {
      return command ? set(number, value) : raw(Command::SAP, number, value, motor());
    };
    switch (random_.between(0, 4)) {
      case 0: return write(ap::target_velocity, velocity());
      case 1: return write(ap::target_velocity, 0);
      case 2: return write(ap::target_position, position());
      case 3: return write(ap::actual_position, position());
      default: return write(scene_.ramp_mode, mode());
    }
  }
  Write motion() {
    switch (random_.between(0, 5)) {
      case 0: return raw(Command::ROR, 0, velocity(), motor());
      case 1: return raw(Command::ROL, 0, velocity(), motor());
      case 2: return raw(Command::ROR, 0, 0, motor());
      case 3: return raw(Command::MVP, 0, position(), motor());
      case 4: return raw(Command::MVP, 1, position(), motor());
      default:
        return raw(Command::RFS, static_cast<std::uint8_t>(random_.between(0, 2)), 0, motor());
    }
  }
  Write stop() {
    if (random_.one_in(2)) return call_of_x("axis.stop", {});
    return raw(Command::MST, 0, 0, motor());
  }
  /// By what is in the accumulator.
  Write indirect() {
    switch (random_.between(0, 6)) {
      case 0: return raw(Command::CALC, 9, random_.one_in(2) ? velocity() : mode());
      case 1: return raw(Command::AAP, ap::target_velocity, 0, motor());
      case 2: return raw(Command::AAP, scene_.ramp_mode, 0, motor());
      case 3: return raw(Command::AAP, ap::target_position, 0, motor());
      case 4: return raw(Command::RORA, 0, 0, motor());
      case 5: return raw(Command::ROLA, 0, 0, motor());
      default: return raw(Command::MVPA, number(), 0, motor());
    }
  }
  Write chip_register() {
    const auto command = random_.one_in(4) ? Command::WRITE_DRV : Command::WRITE_MC;
    const auto which = random_.between(0, 3);
    const auto value = which == 0 ? mode() : which == 1 ? position() : velocity();
    // Mode, target, speed, actual speed.
    constexpr std::array<std::uint8_t, 4> of_tmc429{0x14, 0x00, 0x08, 0x0A};
    constexpr std::array<std::uint8_t, 4> of_tmc457{0x00, 0x09, 0x04, 0x04};
    constexpr std::array<std::uint8_t, 4> of_sixpoint{0x20, 0x2D, 0x27, 0x27};
    const auto index = static_cast<std::size_t>(which);
    switch (scene_.model().family) {
      case tmcl::Family::tmc429: {
        const auto bank = static_cast<std::uint8_t>(motor() << 5U);
        return raw(command, static_cast<std::uint8_t>(of_tmc429[index] | bank), value);
      }
      case tmcl::Family::tmc457: return raw(command, of_tmc457[index], value);
      default:
        return raw(command, of_sixpoint[index], which > 1 ? std::abs(value) : value, motor());
    }
  }
  Write coordinate() {
    constexpr std::uint8_t all_motors = 255;
    constexpr std::uint8_t x_and_y_together = 0x43;
    switch (random_.between(0, 5)) {
      case 0: return raw(Command::SCO, number(), position(), motor());
      case 1: return raw(Command::CCO, number(), 0, motor());
      case 2: return raw(Command::GCO, number(), 0, random_.one_in(2) ? all_motors : motor());
      case 3: return raw(Command::ACO, number(), 0, motor());
      case 4: return raw(Command::MVP, 2, number(), motor());
      default: return raw(Command::MVP, 2, number(), x_and_y_together);
    }
  }
  Write storage() {
    constexpr std::uint8_t user_bank = 2;
    switch (random_.between(0, 6)) {
      case 0: return raw(Command::STAP, scene_.ramp_mode, 0, motor());
      case 1: return raw(Command::RSAP, scene_.ramp_mode, 0, motor());
      case 2: return raw(Command::STAP, ap::target_velocity, 0, motor());
      case 3: return raw(Command::RSAP, ap::target_velocity, 0, motor());
      case 4: return raw(Command::SGP, number(), velocity(), user_bank);
      case 5: return raw(Command::AGP, number(), 0, user_bank);
      default: return raw(Command::GAP, ap::actual_velocity, 0, motor());
    }
  }

  tmcl::test::Random<>& random_;
  const Scene& scene_;
};

/// A search ends at its switch, of which there is none here: what searches says so, and is stopped.
void end_searches(Scene& scene) {
  for (std::uint8_t motor = 0; motor < scene.model().axes; ++motor) {
    if (scene.module.axis(motor).search_step() == 0) continue;
    const auto axis = scene.gateway().find_axis(*scene.gateway().buses().front(),
                                                {tmcl::ModuleAddress{1}, motor});
    EXPECT_TRUE(axis && axis->claim_kind() == ClaimKind::search) << int{motor};
    scene.other_master(request_of(Command::RFS, 1, motor));
  }
}

std::string random_story(Scene& scene, tmcl::test::Random<>& random, bool with_programs) {
  Doors doors(scene);
  std::string story;
  for (auto writes = random.between(1, 8); writes > 0; --writes) {
    AnyWrite write(random, scene);
    story += doors.carry_out(with_programs && random.one_in(3) ? write.of_program() : write.any(),
                             random);
    if (random.one_in(3)) scene.call("axis.get_state", {{"axis", "x"}});
    scene.time.run_for(std::chrono::milliseconds(random.one_in(2) ? random.between(0, 800)
                                                                  : random.between(0, 5)));
  }
  return story;
}

TEST_P(TurningOf, WhateverIsWrittenItStandsWhenAllHaveGone) {
  const auto rounds = tmcl::test::rounds(100);
  for (int round = 0; round < rounds; ++round) {
    scene.begin_anew();
    tmcl::test::Random<> random(tmcl::test::seed() + static_cast<std::uint64_t>(round));
    const auto story = random_story(scene, random, false);
    SCOPED_TRACE("round " + std::to_string(round) + ": " + story);
    scene.time.run_for(2s);
    end_searches(scene);
    ASSERT_TRUE(scene.stands());
  }
}

TEST_P(TurningOf, WhatAProgramTurnsIsSaidToBeUnattended) {
  const json::object module{{"bus", "bench"}, {"address", 1}};
  auto load = module;
  load["program"] = tmcl::program::to_hex(
      tmcl::program::Program{{Command::ROR, 0, 0, scene.speed / 2}, {Command::STOP, 0, 0, 0}});
  const auto rounds = tmcl::test::rounds(60);
  for (int round = 0; round < rounds; ++round) {
    scene.begin_anew();
    scene.be_another_client();
    const auto loaded = scene.call("program.load", load);
    ASSERT_TRUE(loaded) << loaded.error().message;
    tmcl::test::Random<> random(tmcl::test::seed() + static_cast<std::uint64_t>(round));
    const auto story = random_story(scene, random, true);
    SCOPED_TRACE("round " + std::to_string(round) + ": " + story);
    scene.time.run_for(2s);
    end_searches(scene);
    scene.time.run_for(1min);
    scene.be_another_client();
    EXPECT_TRUE(scene.state("unattended") == "true" || scene.stands());
    scene.call("system.stop_all", {});
    ASSERT_TRUE(scene.stands());
  }
}

INSTANTIATE_TEST_SUITE_P(Families, TurningOf,
                         testing::Combine(testing::ValuesIn(one_of_each_family),
                                          testing::Values(tmcl::VelocityTarget::turns_on,
                                                          tmcl::VelocityTarget::goes_there)),
                         [](const auto& one) {
                           std::string name(std::get<0>(one.param));
                           std::erase(name, '-');
                           const bool goes_there =
                               std::get<1>(one.param) == tmcl::VelocityTarget::goes_there;
                           return name + (goes_there ? "ThatGoesToItsTarget" : "ThatTurnsOn");
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

TEST_F(Turning, IsToldWhenItsOwnerHasGone) {
  scene.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 500}, {"unattended", true}});
  scene.client_leaves();
  scene.time.run_for(1s);
  EXPECT_THAT(scene.events, Not(Contains("owner_lost"))) << "it turns on";
  scene.be_another_client();
  scene.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 400}});
  scene.client_leaves();
  EXPECT_TRUE(scene.stands());
  EXPECT_EQ(std::ranges::count(scene.events, "owner_lost"), 1);
  EXPECT_THAT(scene.audited, Contains(HasSubstr("axis=x owner_lost owner=\"client\"")));
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

/// A client has sent the motor to a position before the program set it turning, and has not looked.
TEST_F(Turning, OfAProgramIsUnattendedWhenThatHasBeenStopped) {
  json::object load{{"bus", "bench"}, {"address", 1}};
  load["program"] = tmcl::program::to_hex(tmcl::program::Program{
      {Command::WAIT, 0, 0, 50}, {Command::ROR, 0, 0, scene.speed}, {Command::STOP, 0, 0, 0}});
  ASSERT_TRUE(scene.call("program.load", load));
  for (const auto ends : {Command::STOP_APPLICATION, Command::RESET_APPLICATION}) {
    scene.begin_anew();
    scene.carry_out(raw(Command::RUN_APPLICATION, 1, 0));
    scene.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 20}, {"predict", false}});
    scene.time.run_for(2s);
    ASSERT_TRUE(scene.turns(0));
    scene.carry_out(raw(ends, 0, 0));
    EXPECT_EQ(scene.state("unattended"), "true") << static_cast<int>(ends);
    scene.client_leaves();
    scene.be_another_client();
    EXPECT_EQ(scene.state("unattended"), "true") << static_cast<int>(ends);
    scene.call("axis.stop", {{"axis", "x"}});
    EXPECT_TRUE(scene.stands());
    EXPECT_EQ(scene.state("unattended"), "false") << static_cast<int>(ends);
  }
}

/// In this firmware a target that is written does not end it.
TEST_F(Turning, OfAProgramIsUnattendedWhenATargetIsWrittenThen) {
  json::object load{{"bus", "bench"}, {"address", 1}};
  load["program"] = tmcl::program::to_hex(
      tmcl::program::Program{{Command::ROR, 0, 0, scene.speed}, {Command::STOP, 0, 0, 0}});
  ASSERT_TRUE(scene.call("program.load", load));
  for (const auto& target : {set(ap::target_position, 79), raw(Command::SAP, 0, 79),
                             raw(Command::AAP, ap::target_position, 0)}) {
    scene.begin_anew();
    scene.be_another_client();
    scene.carry_out(raw(Command::RUN_APPLICATION, 1, 0));
    scene.time.run_for(1s);
    scene.carry_out(raw(Command::STOP_APPLICATION, 0, 0));
    scene.carry_out(target);
    ASSERT_TRUE(scene.turns(0)) << said(target);
    EXPECT_EQ(scene.state("unattended"), "true") << said(target);
    scene.call("axis.stop", {{"axis", "x"}});
    EXPECT_TRUE(scene.stands());
    scene.carry_out(target);
    EXPECT_EQ(scene.state("unattended"), "false") << said(target);
  }
}

/// The module only records the lines: none of them has ended anything, or moved it.
TEST_F(Turning, IsOfItsOwnerWhileAProgramIsLoadedThatStopsTheAxis) {
  scene.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", scene.speed}});
  for (const auto& line :
       {tmcl::program::Instruction{Command::MST, 0, 0, 0}, {Command::MVP, 0, 0, 79}}) {
    json::object load{{"bus", "bench"}, {"address", 1}};
    load["program"] =
        tmcl::program::to_hex(tmcl::program::Program{line, line, {Command::STOP, 0, 0, 0}});
    ASSERT_TRUE(scene.call("program.load", load));
    EXPECT_EQ(scene.state("owner"), "\"client\"") << static_cast<int>(line.command);
  }
  scene.client_leaves();
  EXPECT_TRUE(scene.stands());
}

TEST_F(Turning, ByARawCommandIsWarnedOf) {
  const auto answer = scene.call(
      "module.execute",
      {{"bus", "bench"}, {"address", 1}, {"command", "ROR"}, {"motor", 2}, {"value", 500}});
  ASSERT_TRUE(answer);
  EXPECT_THAT(json::serialize(answer->at("warnings")), HasSubstr("stopped when that ends"));
  EXPECT_THAT(json::serialize(answer->at("warnings")), HasSubstr("rotate 1/2 SPEED --unattended"));
  const auto registers = scene.carry_out(raw(Command::WRITE_MC, 0x48, 500));
  ASSERT_TRUE(registers);
  EXPECT_THAT(json::serialize(registers->at("warnings")),
              HasSubstr("axis '1/2' may turn for this connection, and is stopped"));
  scene.client_leaves();
  scene.time.run_for(5s);
  EXPECT_EQ(scene.get(2, ap::actual_velocity), 0) << "a motor that no axis names";
}

/// No switch ends it here: it is stopped when the link is back, as that of an axis is.
TEST_F(Turning, ASearchByARawCommandIsKnownOfAMotorThatNoAxisNames) {
  ASSERT_TRUE(scene.carry_out(raw(Command::RFS, 0, 0, 2)));
  scene.time.run_for(1s);
  ASSERT_NE(scene.module.axis(2).search_step(), 0);
  const auto axis =
      scene.gateway().find_axis(*scene.gateway().buses().front(), {tmcl::ModuleAddress{1}, 2});
  ASSERT_TRUE(axis);
  EXPECT_EQ(axis->claim_kind(), ClaimKind::search);
  scene.wire.unplug();
  EXPECT_TRUE(scene.stands());
  EXPECT_EQ(scene.module.axis(2).search_step(), 0);
}

TEST_F(Turning, ARawSearchOfAMotorThatTheModuleLacksMakesNoAxis) {
  EXPECT_FALSE(scene.carry_out(raw(Command::RFS, 0, 0, 3)));
  EXPECT_FALSE(
      scene.gateway().find_axis(*scene.gateway().buses().front(), {tmcl::ModuleAddress{1}, 3}));
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
      scene.carry_out(write);
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
