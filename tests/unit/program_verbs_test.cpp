// Programs on their way into a module: whatever fails, whoever comes between, no command of others
// is recorded, no line is executed, and no half of a program could run.

#include <gmock/gmock.h>

#include "support/scripted_bus.hpp"
#include "tmcl/program_verbs.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using program::Program;
using test::Fault;
using test::ScriptedBus;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr ModuleAddress module{1};
const Program moving{{Command::MVP, 0, 1, 51200},
                     {Command::WAIT, 1, 1, 0},
                     {Command::MST, 0, 1, 0},
                     {Command::GAP, 1, 1, 0},
                     {Command::JA, 0, 0, 0}};

constexpr Request stop{module, Command::MST, 0, 2, 0};
constexpr Request end_download{module, Command::END_DOWNLOAD, 0, 0, 0};

Request start_download(std::int32_t address) {
  return {module, Command::START_DOWNLOAD, 0, 0, address};
}
Request line(std::size_t number) {
  const auto& command = moving[number];
  return {module, command.command, command.type, command.motor, command.value};
}

/// As the module would see it: trailing empty commands do not count.
Program held_by(ScriptedBus& bus) {
  auto program = bus.module(1).program();
  while (!program.empty() && program.back().command == Command{}) program.pop_back();
  return program;
}
bool could_run(ScriptedBus& bus) {
  const auto& program = bus.module(1).program();
  return !program.empty() && program[0].command != Command{};
}
std::size_t executed_lines(ScriptedBus& bus) {
  const auto& executed = bus.module(1).executed();
  return static_cast<std::size_t>(std::ranges::count_if(executed, [](const Request& request) {
    const auto is_it = [&](std::size_t number) { return request == line(number); };
    return is_it(0) || is_it(1) || is_it(2) || is_it(3) || is_it(4);
  }));
}

class Loading : public testing::TestWithParam<Framing> {
 protected:
  ScriptedBus make_bus() {
    ScriptedBus bus(GetParam());
    bus.add_module(1);
    return bus;
  }
};

TEST_P(Loading, TheFirstCommandComesLastAndEverythingIsCompared) {
  auto bus = make_bus();
  ASSERT_TRUE(bus.run(verbs::load_program(module, moving)));
  EXPECT_EQ(held_by(bus), moving);
  std::vector<Request> writes;
  for (const auto& request : bus.sent()) {
    if (effect_of(request.command, request.type) != Effect::reads ||
        request.command == Command::GAP)
      writes.push_back(request);
  }
  EXPECT_THAT(writes, ElementsAre(start_download(0), Request{module, Command{}, 0, 0, 0},
                                  end_download, start_download(1), line(1), line(2), line(3),
                                  line(4), end_download, start_download(0), line(0), end_download));
  EXPECT_EQ(std::ranges::count(bus.sent(), Command::READ_TMCL_MEMORY, &Request::command), 6);
}

TEST_P(Loading, ProgressCountsEveryCommandWrittenAndCompared) {
  auto bus = make_bus();
  std::vector<std::size_t> done;
  std::size_t of = 0;
  ASSERT_TRUE(bus.run(verbs::load_program(module, moving, {.progress = [&](const auto& progress) {
                                            done.push_back(progress.done);
                                            of = progress.of;
                                            return true;
                                          }})));
  EXPECT_EQ(of, 12U);
  EXPECT_EQ(done.size(), 12U);
  EXPECT_EQ(done.back(), 12U);
}

TEST_P(Loading, EveryDatagramMayFailInEveryWay) {
  auto healthy = make_bus();
  ASSERT_TRUE(healthy.run(verbs::load_program(module, moving)));
  for (std::size_t datagram = 0; datagram < healthy.sent().size(); ++datagram) {
    for (const auto fault : test::all_faults) {
      SCOPED_TRACE("datagram " + std::to_string(datagram) + ", " + test::name_of(fault));
      auto bus = make_bus();
      bus.fail(datagram, fault);
      const auto loaded = bus.run(verbs::load_program(module, moving));
      EXPECT_TRUE(loaded) << describe(loaded.error());
      bus.pass(100ms);
      EXPECT_EQ(held_by(bus), moving);
      EXPECT_FALSE(bus.module(1).downloading());
      EXPECT_EQ(executed_lines(bus), 0U);
      EXPECT_TRUE(bus.run(verbs::get({module, 0}, 4)));
    }
  }
}

TEST_P(Loading, AModuleThatFallsSilentSomewhereCannotRunAHalf) {
  auto healthy = make_bus();
  ASSERT_TRUE(healthy.run(verbs::load_program(module, moving)));
  for (std::size_t datagram = 0; datagram < healthy.sent().size(); ++datagram) {
    for (const auto fault : {Fault::lost_request, Fault::lost_reply}) {
      SCOPED_TRACE("from datagram " + std::to_string(datagram) + ", " + test::name_of(fault));
      auto bus = make_bus();
      bus.module(1).program() = {{Command::STOP, 0, 0, 0}};
      bus.chance = [&](std::size_t number) {
        return number >= datagram ? std::optional(fault) : std::nullopt;
      };
      const auto loaded = bus.run(verbs::load_program(module, moving));
      ASSERT_FALSE(loaded);
      const auto program = held_by(bus);
      const bool old = program == Program{{Command::STOP, 0, 0, 0}};
      EXPECT_TRUE(old || program == moving || !could_run(bus));
      EXPECT_EQ(executed_lines(bus), 0U);
      // It answers again: the first thing it is told is that the download ends.
      bus.pass(1s);
      bus.chance = {};
      EXPECT_TRUE(bus.run(verbs::get({module, 0}, 4)));
      EXPECT_FALSE(bus.module(1).downloading());
    }
  }
}

TEST_P(Loading, AStopAtAnyTimeIsExecutedAtOnceAndNeverRecorded) {
  auto healthy = make_bus();
  ASSERT_TRUE(healthy.run(verbs::load_program(module, moving)));
  for (std::size_t when = 0; when < healthy.sent().size(); ++when) {
    SCOPED_TRACE("before the answer to datagram " + std::to_string(when));
    auto bus = make_bus();
    std::optional<engine::Ticket> ticket;
    bus.chance = [&](std::size_t number) -> std::optional<Fault> {
      if (number == when) ticket = bus.submit(stop);
      return std::nullopt;
    };
    const auto loaded = bus.run(verbs::load_program(module, moving));
    bus.settle();
    ASSERT_TRUE(ticket);
    EXPECT_TRUE(bus.result(*ticket));
    EXPECT_EQ(std::ranges::count(bus.module(1).executed(), stop), 1);
    EXPECT_EQ(std::ranges::count(bus.module(1).recorded(), stop), 0);
    // Next comes the stop, or the end of the download and then the stop.
    auto next = bus.sent().begin() + static_cast<std::ptrdiff_t>(when) + 1;
    ASSERT_NE(next, bus.sent().end());
    if (*next == end_download && next + 1 != bus.sent().end()) ++next;
    EXPECT_EQ(*next, stop);
    EXPECT_FALSE(bus.module(1).downloading());
    EXPECT_EQ(executed_lines(bus), 0U);
    if (loaded) {
      EXPECT_EQ(held_by(bus), moving);
    } else {
      EXPECT_EQ(loaded.error().code, Errc::superseded_by_stop);
      EXPECT_TRUE(held_by(bus) == moving || !could_run(bus));
    }
  }
}

TEST_P(Loading, AStopComesThroughWhenTheEndOfTheDownloadGetsLost) {
  for (const auto fault : test::all_faults) {
    for (const std::size_t lost : {1U, 2U, 3U}) {
      SCOPED_TRACE(test::name_of(fault) + ", " + std::to_string(lost) + " times");
      auto bus = make_bus();
      std::optional<engine::Ticket> ticket;
      std::size_t ends = 0;
      bus.chance = [&](std::size_t number) -> std::optional<Fault> {
        if (bus.sent()[number] == line(1)) ticket = bus.submit(stop);
        const bool is_end = ticket && bus.sent()[number] == end_download;
        return is_end && ++ends <= lost ? std::optional(fault) : std::nullopt;
      };
      EXPECT_FALSE(bus.run(verbs::load_program(module, moving)));
      bus.settle();
      bus.pass(1s);
      if (lost < 3) {
        EXPECT_TRUE(bus.result(*ticket));
        EXPECT_GE(std::ranges::count(bus.module(1).executed(), stop), 1);
        EXPECT_FALSE(bus.module(1).downloading());
      }
      EXPECT_FALSE(could_run(bus));
    }
  }
}

TEST_P(Loading, CommandsOfOthersWaitUntilItHasEnded) {
  auto bus = make_bus();
  const Request foreign{module, Command::MVP, 0, 0, 777};
  const Request read{module, Command::GAP, 4, 0, 0};
  std::vector<engine::Ticket> tickets;
  bus.chance = [&](std::size_t) -> std::optional<Fault> {
    if (tickets.size() >= 40) return std::nullopt;
    tickets.push_back(bus.submit(foreign));
    tickets.push_back(bus.submit(read));
    return std::nullopt;
  };
  ASSERT_TRUE(bus.run(verbs::load_program(module, moving)));
  EXPECT_EQ(held_by(bus), moving);
  bus.settle();
  for (const auto ticket : tickets) EXPECT_TRUE(bus.result(ticket));
  EXPECT_EQ(std::ranges::count(bus.module(1).executed(), foreign), 20);
}

TEST_P(Loading, OtherModulesAreSpokenToMeanwhile) {
  auto bus = make_bus();
  bus.add_module(2);
  const Request read{ModuleAddress{2}, Command::GAP, 4, 0, 0};
  ASSERT_TRUE(bus.run(verbs::get({ModuleAddress{2}, 0}, 4)));
  std::size_t ended_meanwhile = 0;
  bus.chance = [&](std::size_t number) -> std::optional<Fault> {
    if (bus.sent()[number] == line(1)) bus.submit(read, {.attempts = 3});
    if (bus.sent()[number] == line(4)) {
      ended_meanwhile =
          static_cast<std::size_t>(std::ranges::count(bus.module(2).executed(), read));
    }
    return std::nullopt;
  };
  ASSERT_TRUE(bus.run(verbs::load_program(module, moving)));
  EXPECT_EQ(ended_meanwhile, 2U);
}

// A module on USB takes what is for any address.
TEST(LoadingOnASerialLine, ModulesThatNobodyHasHeardWait) {
  ScriptedBus bus;
  bus.add_module(1);
  std::optional<std::size_t> asked_at;
  bus.chance = [&](std::size_t number) -> std::optional<Fault> {
    if (bus.sent()[number] == line(1)) bus.submit({ModuleAddress{9}, Command::GAP, 4, 0, 0});
    if (bus.sent()[number].address == ModuleAddress{9} && !asked_at) asked_at = number;
    return std::nullopt;
  };
  ASSERT_TRUE(bus.run(verbs::load_program(module, moving)));
  bus.settle();
  ASSERT_TRUE(asked_at);
  const auto begin = bus.sent().begin();
  const auto since_start =
      std::find(begin, begin + static_cast<std::ptrdiff_t>(*asked_at), line(4));
  EXPECT_NE(since_start, begin + static_cast<std::ptrdiff_t>(*asked_at));
}

TEST(LoadingOnASerialLine, AStopForAModuleThatNobodyHasHeardEndsTheDownloadToo) {
  ScriptedBus bus;
  bus.add_module(1);
  const Request elsewhere{ModuleAddress{9}, Command::MST, 0, 0, 0};
  bus.chance = [&](std::size_t number) -> std::optional<Fault> {
    if (bus.sent()[number] == line(1)) bus.submit(elsewhere);
    return std::nullopt;
  };
  const auto loaded = bus.run(verbs::load_program(module, moving));
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, Errc::superseded_by_stop);
  const auto stop_at = std::ranges::find(bus.sent(), elsewhere);
  bus.settle();
  EXPECT_FALSE(bus.module(1).downloading());
  EXPECT_TRUE(stop_at == bus.sent().end() || *(stop_at - 1) == end_download);
}

TEST_P(Loading, WhenItsCallerGoesTheDownloadEnds) {
  for (int steps = 1; steps < 16; ++steps) {
    auto bus = make_bus();
    {
      auto script = verbs::load_program(module, moving);
      auto step = script.start(bus.clock().now());
      for (int i = 1; i < steps && step; ++i)
        step = script.resume(bus.perform(*step), bus.clock().now());
    }
    bus.pass(200ms);
    EXPECT_FALSE(bus.module(1).downloading()) << steps;
    EXPECT_FALSE(could_run(bus)) << steps;
    EXPECT_TRUE(bus.run(verbs::get({module, 0}, 4)));
  }
}

TEST_P(Loading, AHoldThatIsNotUsedEnds) {
  auto bus = make_bus();
  auto script = verbs::load_program(module, moving);
  auto step = script.start(bus.clock().now());
  while (step && std::get<step::Exchange>(*step).request != line(2))
    step = script.resume(bus.perform(*step), bus.clock().now());
  ASSERT_TRUE(step);
  bus.pass(hold_idle_limit + 200ms);
  EXPECT_FALSE(bus.module(1).downloading());
  while (step) step = script.resume(bus.perform(*step), bus.clock().now());
  const auto loaded = script.take();
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, Errc::deadline_passed);
  EXPECT_EQ(executed_lines(bus), 0U);
}

TEST_P(Loading, CanBeCancelled) {
  auto bus = make_bus();
  const auto loaded = bus.run(verbs::load_program(
      module, moving, {.progress = [](const auto& progress) { return progress.done < 4; }}));
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, Errc::download_broken);
  EXPECT_FALSE(bus.module(1).downloading());
  EXPECT_FALSE(could_run(bus));
}

TEST_P(Loading, GoesOverADownloadThatSomebodyElseHasLeftUnfinished) {
  auto bus = make_bus();
  bus.module(1).downloading() = true;
  const auto loaded = bus.run(verbs::load_program(module, moving));
  ASSERT_TRUE(loaded) << describe(loaded.error());
  EXPECT_EQ(held_by(bus), moving);
}

TEST_P(Loading, AResetModuleThatExecutesALineIsStopped) {
  auto bus = make_bus();
  bus.module(1).before = [](test::FakeModule& self, const Request& request) {
    if (request == line(0)) self.downloading() = false;
  };
  const auto loaded = bus.run(verbs::load_program(module, moving));
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, Errc::download_broken);
  const auto& executed = bus.module(1).executed();
  const auto moved = std::ranges::find(executed, line(0));
  ASSERT_NE(moved, executed.end());
  EXPECT_EQ(executed.back(), (Request{module, Command::MST, 0, 1, 0}));
}

INSTANTIATE_TEST_SUITE_P(Links, Loading, testing::Values(Framing::serial, Framing::can),
                         [](const auto& parameter) {
                           return parameter.param == Framing::serial ? "serial" : "can";
                         });

TEST(Programs, AModuleInDownloadModeIsNoticed) {
  ScriptedBus bus;
  bus.add_module(1).downloading() = true;
  const auto value = bus.run(verbs::get({module, 0}, 4));
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().status, Status::command_loaded);
  EXPECT_EQ(value.error().outcome, Outcome::refused);
  EXPECT_THAT(value.error().message, HasSubstr("recorded the command"));
}

TEST(Programs, AStopEndsEvenADownloadThatNobodyHereBegan) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    bus.add_module(1).downloading() = true;
    EXPECT_TRUE(bus.run(verbs::stop({module, 2})));
    EXPECT_THAT(bus.sent(), ElementsAre(stop, end_download, stop));
    EXPECT_THAT(bus.module(1).executed(), ElementsAre(end_download, stop));
  }
}

TEST(Programs, WhatCannotBeLoadedIsRefusedUnsent) {
  ScriptedBus bus;
  bus.add_module(1);
  const auto why = [&](Program program, std::uint16_t first = 0) {
    return bus.run(verbs::load_program(module, std::move(program), {.first_address = first}))
        .error()
        .message;
  };
  EXPECT_THAT(why({}), HasSubstr("empty"));
  EXPECT_THAT(why(Program(2049)), HasSubstr("do not fit"));
  EXPECT_THAT(why(moving, 2047), HasSubstr("do not fit"));
  EXPECT_THAT(why({{Command::END_DOWNLOAD, 0, 0, 0}}), HasSubstr("END_DOWNLOAD at address 0"));
  EXPECT_TRUE(bus.sent().empty());
}

TEST(Programs, ProtectionIsRespected) {
  for (const int protection : {1, 2, 3}) {
    ScriptedBus bus;
    bus.add_module(1).global(81) = protection;
    const auto loaded = bus.run(verbs::load_program(module, moving));
    ASSERT_FALSE(loaded);
    EXPECT_EQ(loaded.error().status, Status::write_protected);
    EXPECT_THAT(loaded.error().hint, HasSubstr("81"));
    const auto unread = bus.run(verbs::load_program(module, moving, {.compare = false}));
    EXPECT_EQ(unread.has_value(), protection == 1);
    const auto read = bus.run(verbs::read_program(module));
    EXPECT_EQ(read.has_value(), protection == 2);
  }
}

TEST(Programs, ARunningProgramIsNotWrittenOver) {
  ScriptedBus bus;
  bus.add_module(1).application_status = 1;
  const auto loaded = bus.run(verbs::load_program(module, moving));
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("running"));
  EXPECT_EQ(std::ranges::count(bus.sent(), Command::START_DOWNLOAD, &Request::command), 0);
}

// Older firmware may not have parameter 128.
TEST(Programs, NorWhereOnlyCommand135TellsThatItRuns) {
  for (const bool is_in_highest_byte : {true, false}) {
    ScriptedBus bus;
    auto& fake = bus.add_module(1);
    fake.application_status = 1;
    fake.status_is_in_highest_byte = is_in_highest_byte;
    fake.refuse = [](const Request& request) -> std::optional<Status> {
      const bool is_asked =
          request.command == Command::GGP && request.type == global_parameter::application_status;
      return is_asked ? std::optional(Status::wrong_type) : std::nullopt;
    };
    const auto loaded = bus.run(verbs::load_program(module, moving));
    ASSERT_FALSE(loaded) << is_in_highest_byte;
    EXPECT_THAT(loaded.error().message, HasSubstr("running"));
    fake.application_status = 0;
    EXPECT_TRUE(bus.run(verbs::load_program(module, moving))) << is_in_highest_byte;
  }
}

TEST(Programs, TheStateIsThatOfParameter128WhateverCommand135Says) {
  for (const bool is_in_highest_byte : {true, false}) {
    ScriptedBus bus;
    auto& fake = bus.add_module(1);
    fake.status_is_in_highest_byte = is_in_highest_byte;
    fake.application_status = 1;
    EXPECT_EQ(bus.run(verbs::program_status(module)).value().state, ProgramStatus::State::running);
    fake.application_status = 0;
    EXPECT_EQ(bus.run(verbs::program_status(module)).value().state, ProgramStatus::State::stopped);
    EXPECT_TRUE(bus.run(verbs::load_program(module, moving)));
  }
}

TEST(Programs, ReadingEndsAfterEnoughEmptyCommands) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    auto& fake = bus.add_module(1);
    fake.program() = moving;
    fake.program().resize(10);
    fake.program().push_back({Command::STOP, 0, 0, 0});
    EXPECT_EQ(bus.run(verbs::read_program(module)), fake.program());
    EXPECT_EQ(bus.run(verbs::read_program(module, {.length = 3})),
              (Program{moving.begin(), moving.begin() + 3}));
  }
}

TEST(Programs, ReadingEndsAtTheEndOfTheMemory) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.program() = Program(program::most_commands, {Command::STOP, 0, 0, 0});
  fake.refuse = [](const Request& request) {
    return request.command == Command::READ_TMCL_MEMORY && request.value >= 100
               ? std::optional(Status::maximum_exceeded)
               : std::nullopt;
  };
  const auto program = bus.run(verbs::read_program(module));
  ASSERT_TRUE(program);
  EXPECT_EQ(program->size(), 100U);
}

TEST(Programs, LinesThatLookLikeAnythingAreReadAsTheyAre) {
  // A status that TMCL does not define, one that means an error, another module's address.
  const Program odd{{Command{2}, 77, 9, 5}, {Command{1}, 4, 6, 0}, {Command{2}, 100, 6, 1}};
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    bus.add_module(1).program() = odd;
    bus.add_module(2);
    ASSERT_TRUE(bus.run(verbs::get({ModuleAddress{2}, 0}, 4)));
    EXPECT_EQ(bus.run(verbs::read_program(module, {.length = 3})), odd);
  }
}

// There a line of a program does not say which module it comes from.
TEST(Programs, OnCanNobodyElseIsAskedWhileALineIsRead) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1).program() = {{Command{2}, 100, 6, 1}};
  bus.add_module(2);
  const auto before = bus.submit({ModuleAddress{2}, Command::GAP, 4, 0, 0});
  const auto line = bus.submit({module, Command::READ_TMCL_MEMORY, 0, 0, 0});
  const auto after = bus.submit({ModuleAddress{2}, Command::GAP, 5, 0, 0});
  bus.settle();
  EXPECT_EQ(bus.result(before)->reply.value, bus.module(2).parameter(0, 4));
  EXPECT_EQ(program::line_of(bus.result(line)->reply).value, 1);
  EXPECT_EQ(bus.result(after)->reply.value, bus.module(2).parameter(0, 5));
}

TEST(Programs, ComparingNamesTheFirstDifference) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.program() = moving;
  EXPECT_TRUE(bus.run(verbs::compare_program(module, moving)));
  fake.program()[3].value = 9;
  const auto same = bus.run(verbs::compare_program(module, moving));
  ASSERT_FALSE(same);
  EXPECT_EQ(same.error().code, Errc::unexpected_value);
  EXPECT_THAT(same.error().message, HasSubstr("GAP 1, 1, 9 at address 3, and not GAP 1, 1, 0"));
}

}  // namespace
}  // namespace tmcl
