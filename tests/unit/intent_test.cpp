// What a request can do: one table, and what everything else makes of it.
#include "tmcl/intent.hpp"

#include <gmock/gmock.h>

#include "engine/call_queue.hpp"
#include "tmcl/address.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/model.hpp"

namespace tmcl {
namespace {

using testing::IsEmpty;
using testing::IsSupersetOf;

constexpr ModuleAddress module{1};
constexpr std::uint8_t most_motors = 6;

Request request_of(Command command, std::uint8_t type, std::uint8_t motor, std::int32_t value = 1) {
  return {module, command, type, motor, value};
}

/// Commands that TMCL does not define, too.
template <class Checks>
void for_each_request(Checks checks) {
  for (unsigned command = 0; command < 256; ++command)
    for (unsigned type = 0; type < 256; ++type)
      for (const auto motor : {0, 1, 5, 0x83, 0xC1, 255})
        for (const auto value : {0, 1, -1})
          checks(request_of(static_cast<Command>(command), static_cast<std::uint8_t>(type),
                            static_cast<std::uint8_t>(motor), value));
}

std::string name_of_request(const Request& request) {
  return std::string(name_of(request.command)) + ' ' + std::to_string(request.type) + ' ' +
         std::to_string(request.motor) + ' ' + std::to_string(request.value);
}

TEST(IntentOf, ACommandThatTmclDoesNotDefineIsTheStrictest) {
  constexpr Intent strictest{
      Effect::moves, Motion::unforeseen, Subject::module, Setpoint::none, true, true};
  for (unsigned number = 0; number < 256; ++number) {
    const auto request = request_of(static_cast<Command>(number), 0, 3);
    if (find_command(static_cast<std::uint8_t>(number)) != nullptr) continue;
    EXPECT_EQ(intent_of(request), strictest) << number;
  }
}

TEST(IntentOf, WhatReadsOrStopsSetsNothing) {
  for_each_request([](const Request& request) {
    const auto intent = intent_of(request);
    if (intent.effect != Effect::reads && intent.effect != Effect::stops) return;
    EXPECT_EQ(intent.sets, Setpoint::none) << name_of_request(request);
    EXPECT_FALSE(intent.is_unseen) << name_of_request(request);
    EXPECT_TRUE(intent.motion == Motion::unchanged || intent.motion == Motion::stops)
        << name_of_request(request);
  });
}

TEST(IntentOf, OnlyWhatMovesLetsAMotorMoveOtherwise) {
  for_each_request([](const Request& request) {
    const auto intent = intent_of(request);
    const bool goes_on = intent.motion == Motion::unchanged || intent.motion == Motion::stops ||
                         intent.motion == Motion::ends_program || intent.motion == Motion::restarts;
    EXPECT_TRUE(goes_on || intent.effect == Effect::moves) << name_of_request(request);
  });
}

TEST(IntentOf, WhatCanMoveAMotorConcernsIt) {
  for_each_request([](const Request& request) {
    for (std::uint8_t motor = 0; motor < most_motors; ++motor) {
      const AxisAddress axis{module, motor};
      EXPECT_TRUE(concerns(request, axis) || !can_move(request, axis)) << name_of_request(request);
    }
  });
}

TEST(IntentOf, WhatTurnsAMotorCanMoveIt) {
  for (const auto* model : {static_cast<const Model*>(nullptr), find_model(1110), find_model(3110),
                            find_model(6110), find_model(1140), find_model(1311)})
    for_each_request([&](const Request& request) {
      for (const auto motor : motors_turned_by(request, model))
        EXPECT_TRUE(can_move(request, motor)) << name_of_request(request);
    });
}

TEST(IntentOf, AMotorThatIsNotNamedMayBeAny) {
  for (const auto command : {Command::UF2, Command::RST, Command::RUN_APPLICATION, Command::SAC,
                             Command::WRITE_MC, Command::SOFTWARE_RESET, Command{77}})
    for (std::uint8_t motor = 0; motor < most_motors; ++motor)
      EXPECT_TRUE(can_move(request_of(command, 0, 0), {module, motor})) << name_of(command);
}

TEST(IntentOf, AVelocityOfZeroStopsAndSetsNothingTurning) {
  EXPECT_EQ(intent_of(request_of(Command::ROR, 0, 0, 0)).motion, Motion::stops);
  EXPECT_EQ(intent_of(request_of(Command::ROL, 0, 0, -1)).motion, Motion::turns);
  EXPECT_EQ(intent_of(request_of(Command::SAP, 2, 0, 0)).motion, Motion::unchanged);
  EXPECT_EQ(intent_of(request_of(Command::SAP, 2, 0, 1)).motion, Motion::turns);
  EXPECT_EQ(intent_of(request_of(Command::RSAP, 2, 0, 0)).motion, Motion::turns);
  EXPECT_EQ(intent_of(request_of(Command::AAP, 138, 0, 0)).motion, Motion::turns);
}

TEST(IntentOf, ARampModeIsThatOfItsModel) {
  const auto sets = [](std::uint8_t type, const Model* model) {
    return intent_of(request_of(Command::SAP, type, 0), model).sets;
  };
  EXPECT_EQ(sets(138, find_model(3110)), Setpoint::mode);
  EXPECT_EQ(sets(128, find_model(3110)), Setpoint::none);
  EXPECT_EQ(sets(138, nullptr), Setpoint::mode);
  EXPECT_EQ(sets(128, nullptr), Setpoint::mode);
  EXPECT_EQ(sets(0, nullptr), Setpoint::position);
  EXPECT_EQ(sets(1, nullptr), Setpoint::here);
  EXPECT_EQ(sets(2, nullptr), Setpoint::velocity);
}

TEST(IntentOf, ARegisterIsThatOfAllMotorsOfItsChip) {
  const auto* three = find_model(3110);
  const auto register_of = [](std::uint8_t chip) { return request_of(Command::WRITE_MC, 9, chip); };
  for (std::uint8_t motor = 0; motor < 3; ++motor)
    EXPECT_TRUE(concerns(register_of(0), {module, motor}, three));
  EXPECT_FALSE(concerns(register_of(0), {module, 3}, find_model(6110)));
  EXPECT_TRUE(concerns(register_of(1), {module, 3}, find_model(6110)));
  EXPECT_THAT(motors_turned_by(register_of(1), three), IsEmpty());
  EXPECT_TRUE(concerns(request_of(Command::WRITE_DRV, 0, 1), {module, 0}, find_model(1110)));
}

TEST(IntentOf, AMaskNamesItsMotorsOnly) {
  const auto move = request_of(Command::MVP, move_type::coordinate, 0x85);
  EXPECT_EQ(motors_of(move), (std::set<AxisAddress>{{module, 0}, {module, 2}}));
  EXPECT_FALSE(can_move(move, {module, 1}));
  EXPECT_EQ(intent_of(request_of(Command::MVP, move_type::coordinate, 1)).subject, Subject::motor);
}

/// What a stop of a motor takes out of the queue is what could move the motor behind it.
TEST(IntentOf, AStopEndsWhatWaitsAndCanMoveItsMotor) {
  for_each_request([](const Request& request) {
    engine::Call call;
    call.request = request;
    call.effect = intent_of(request).effect;
    for (std::uint8_t motor = 0; motor < most_motors; ++motor) {
      const auto stop = request_of(Command::MST, 0, motor);
      EXPECT_EQ(is_ended_by(stop, call), can_move(request, {module, motor}))
          << name_of_request(request);
    }
  });
}

}  // namespace
}  // namespace tmcl
