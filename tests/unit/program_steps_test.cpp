// Programs, command by command: where it ends, what it waits for, and that no step is made twice.
#include <gmock/gmock.h>

#include "support/scripted_bus.hpp"
#include "tmcl/program_verbs.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using program::Program;
using test::Fault;
using test::ScriptedBus;
using testing::HasSubstr;
using Reason = SteppedProgram::Reason;

constexpr ModuleAddress module{1};

/// 0 MVP, 1 WAIT POS, 2 SGP, 3 JA 1, 4 STOP.
const Program waiting{{Command::MVP, 0, 1, 51200},
                      {Command::WAIT, 1, 1, 0},
                      {Command::SGP, 3, 2, 1},
                      {Command::JA, 0, 0, 1},
                      {Command::STOP, 0, 0, 0}};

/// A module that goes from command to command and does nothing else; a WAIT takes its time.
struct PlayedProgram {
  PlayedProgram() {
    bus.add_module(1).program() = waiting;
    bus.module(1).play = [this](const Request& request) { return play(request); };
  }

  std::optional<Reply> play(const Request& request) {
    if (waits_until && bus.clock().now() >= *waits_until) {
      waits_until.reset();
      ++counter;
    }
    Reply reply{default_host_address, 1, Status::ok, request.command, request.value};
    if (request.command == Command::STEP_APPLICATION) {
      step();
      return reply;
    }
    if (request.command != Command::GGP || request.motor != 0) return std::nullopt;
    if (request.type == global_parameter::application_status) reply.value = state;
    if (request.type == global_parameter::program_counter) reply.value = counter;
    if (request.type == global_parameter::tmcl_error) reply.value = last_error;
    if (request.type == global_parameter::program_counter && !tells_counter)
      reply.status = Status::wrong_type;
    return reply;
  }

  void step() {
    ++steps;
    state = state_between_steps;
    const auto line = bus.module(1).program().at(static_cast<std::size_t>(counter));
    if (fails_at == counter) {
      state = 0;
      last_error = 4;
    } else if (line.command == Command::WAIT) {
      waits_until = bus.clock().now() + wait;
    } else if (line.command == Command::JA) {
      counter = line.value;
    } else {
      if (line.command == Command::STOP) state = 0;
      ++counter;
    }
  }

  Result<SteppedProgram> run(StepOptions options) {
    return bus.run(verbs::step_program_to(module, std::move(options)));
  }

  ScriptedBus bus;
  std::int32_t counter = 0;
  std::int32_t state = 0;
  std::int32_t state_between_steps = 2;
  std::int32_t last_error = 0;
  std::int32_t fails_at = -1;
  bool tells_counter = true;
  Duration wait = 2s;
  std::optional<TimePoint> waits_until;
  int steps = 0;
};

class StepsOfProgram : public testing::Test, public PlayedProgram {};

TEST_F(StepsOfProgram, OneStepIsOneCommand) {
  const auto stepped = run({});
  ASSERT_TRUE(stepped) << describe(stepped.error());
  EXPECT_EQ(stepped->reason, Reason::steps);
  EXPECT_EQ(stepped->steps, 1U);
  EXPECT_EQ(stepped->status.next_address, 1);
  EXPECT_EQ(steps, 1);
}

TEST_F(StepsOfProgram, EndsBeforeAnAddressAndWaitsForWhatTakesTime) {
  const auto begin = bus.clock().now();
  const auto stepped = run({.until = {9, 3}, .most_steps = 100});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->reason, Reason::at_address);
  EXPECT_EQ(stepped->steps, 3U);
  EXPECT_EQ(stepped->status.next_address, 3);
  EXPECT_GE(bus.clock().now() - begin, 2s);
  EXPECT_LE(bus.clock().now() - begin, 3s);
}

TEST_F(StepsOfProgram, WhereItStandsAlreadyItGoesOnceAround) {
  counter = 3;
  const auto stepped = run({.until = {3}, .most_steps = 100});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->steps, 3U);
  EXPECT_EQ(stepped->status.next_address, 3);
}

TEST_F(StepsOfProgram, EndsWithTheProgram) {
  counter = 4;
  const auto stepped = run({.most_steps = 100});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->reason, Reason::ended);
  EXPECT_EQ(stepped->steps, 1U);
  EXPECT_EQ(stepped->status.state, ProgramStatus::State::stopped);
}

TEST_F(StepsOfProgram, EndsWhereACommandFails) {
  fails_at = 2;
  const auto stepped = run({.most_steps = 100});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->reason, Reason::ended);
  EXPECT_EQ(stepped->steps, 3U);
  EXPECT_EQ(stepped->status.next_address, 2);
  EXPECT_EQ(stepped->status.last_error, 4);
}

TEST_F(StepsOfProgram, AModuleMaySayThatItIsStoppedBetweenSteps) {
  state_between_steps = 0;
  const auto stepped = run({.most_steps = 10});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->reason, Reason::steps);
  EXPECT_EQ(stepped->steps, 10U);
  counter = 4;
  EXPECT_EQ(run({.most_steps = 10})->reason, Reason::ended);
}

TEST_F(StepsOfProgram, AStopFromElsewhereEndsIt) {
  StepOptions options{.most_steps = 100};
  bus.module(1).before = [this](test::FakeModule&, const Request& request) {
    if (request.command == Command::GGP && steps == 2) state = state_between_steps = 0;
  };
  const auto stepped = run(std::move(options));
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->reason, Reason::ended);
  EXPECT_EQ(steps, 2);
}

TEST_F(StepsOfProgram, AWaitThatTakesTooLongIsTold) {
  wait = 1h;
  const auto begin = bus.clock().now();
  const auto stepped = run({.most_steps = 100, .longest_wait = 5s});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->reason, Reason::waits);
  EXPECT_EQ(stepped->steps, 2U);
  EXPECT_LE(bus.clock().now() - begin, 6s);
}

TEST_F(StepsOfProgram, ProgressIsToldAndEndsIt) {
  wait = 1h;
  std::vector<std::uint32_t> told;
  const auto progress = [&](std::uint32_t done) {
    told.push_back(done);
    return told.size() < 6;
  };
  const auto stepped = run({.most_steps = 100, .progress = progress});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->reason, Reason::cancelled);
  // Also while the second command waits.
  EXPECT_EQ(told, (std::vector<std::uint32_t>{0, 1, 2, 2, 2, 2}));
  EXPECT_EQ(steps, 2);
}

TEST_F(StepsOfProgram, AJumpToItselfIsAStep) {
  bus.module(1).program()[0] = {Command::JA, 0, 0, 0};
  const auto stepped = run({.most_steps = 7});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->reason, Reason::steps);
  EXPECT_EQ(stepped->steps, 7U);
}

TEST_F(StepsOfProgram, ARunningProgramIsLeftAlone) {
  state = 1;
  const auto stepped = run({});
  ASSERT_FALSE(stepped);
  EXPECT_EQ(stepped.error().outcome, Outcome::refused);
  EXPECT_THAT(stepped.error().message, HasSubstr("a program is running on module 1"));
  EXPECT_EQ(steps, 0);
}

TEST_F(StepsOfProgram, AModuleThatDoesNotTellWhereItIsIsNotStepped) {
  tells_counter = false;
  const auto stepped = run({});
  ASSERT_FALSE(stepped);
  EXPECT_THAT(stepped.error().message, HasSubstr("does not tell at which command"));
  EXPECT_EQ(steps, 0);
}

TEST_F(StepsOfProgram, NoDatagramThatFailsMakesASecondStep) {
  const StepOptions options{.until = {3}, .most_steps = 100};
  wait = 50ms;
  run(options);
  const auto datagrams = bus.sent().size();
  for (std::size_t datagram = 0; datagram < datagrams; ++datagram) {
    for (const auto fault : test::all_faults) {
      SCOPED_TRACE("datagram " + std::to_string(datagram) + ", " + test::name_of(fault));
      PlayedProgram played;
      played.wait = 50ms;
      played.bus.fail(datagram, fault);
      const auto stepped = played.run(options);
      EXPECT_LE(played.steps, 3);
      if (!stepped) continue;
      EXPECT_EQ(stepped->reason, Reason::at_address);
      EXPECT_EQ(stepped->steps, 3U);
      EXPECT_EQ(played.steps, 3);
    }
  }
}

}  // namespace
}  // namespace tmcl
