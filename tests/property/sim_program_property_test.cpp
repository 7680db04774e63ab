// Stand-alone programs of all kinds: none harms the simulator, whatever it and its host do, and
// those that compute something compute it.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "sim/program/application.hpp"
#include "support/program_host.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmcl::sim {
namespace {

using program::Instruction;
using program::Program;
using std::chrono::milliseconds;
using Random = test::Random<>;

/// Programs that run for a while: wrong commands, types and values are there, but seldom.
class ProgramScript {
 public:
  explicit ProgramScript(std::uint64_t seed) : random_(seed) {}

  Instruction instruction() {
    if (random_.one_in(150)) return {static_cast<Command>(byte()), byte(), byte(), any_value()};
    const auto command = this->command();
    return {command, type(command), motor(), value()};
  }
  Program program() {
    Program lines(static_cast<std::size_t>(random_.between(1, longest)));
    for (auto& line : lines) line = instruction();
    lines.push_back({Command::JA});
    return lines;
  }
  std::int32_t value() {
    return random_.one_in(100) ? any_value() : static_cast<std::int32_t>(random_.between(1, 20));
  }
  Random& random() { return random_; }

 private:
  static constexpr int longest = 40;

  Command command() {
    while (true) {
      const auto number = static_cast<std::uint8_t>(random_.between(1, 80));
      const auto* row = find_command(number);
      if (row == nullptr || !row->operands) continue;
      const bool ends = row->command == Command::STOP || row->command == Command::RSUB ||
                        row->command == Command::RETI || row->command == Command::RST;
      if (!ends || random_.one_in(4)) return row->command;
    }
  }
  std::uint8_t type(Command command) {
    static constexpr std::uint8_t interrupts[] = {0,  1,  2,  3,  4,  15, 16,
                                                  21, 27, 29, 39, 40, 42, 255};
    const bool interrupts_only =
        command == Command::EI || command == Command::DI || command == Command::VECT;
    if (interrupts_only) return interrupts[index(std::size(interrupts))];
    std::vector<std::uint8_t> types;
    for (const auto& row : subtype_table()) {
      if (row.command == command) types.push_back(row.type);
    }
    return types.empty() ? byte() : types[index(types.size())];
  }
  std::uint8_t motor() { return static_cast<std::uint8_t>(random_.between(0, 1)); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_.between(0, 255)); }
  std::int32_t any_value() {
    return static_cast<std::int32_t>(random_.between(INT32_MIN, INT32_MAX));
  }
  std::size_t index(std::size_t size) {
    return static_cast<std::size_t>(random_.between(0, static_cast<std::int64_t>(size) - 1));
  }

  Random random_;
};

class ProgramTrial {
 public:
  explicit ProgramTrial(std::uint64_t seed) : script_(seed) {
    for (auto& setting : host_.settings)
      setting = static_cast<std::int32_t>(random().between(-1, 5));
    host_.on_perform = [this](const Request& request) { react(request); };
    application_.load(script_.program());
  }

  void run() {
    for (int i = 0; i < 40 && !testing::Test::HasFailure(); ++i) {
      act();
      pass(milliseconds(random().any_size(100)));
    }
  }
  /// How often the program asked for attention.
  std::size_t looks() const { return looks_; }

 private:
  Random& random() { return script_.random(); }

  // A module may do anything, even to the program that asked for it.
  void react(const Request& request) {
    ASSERT_TRUE(is_direct(request.command)) << static_cast<int>(request.command);
    if (random().one_in(200)) {
      host_.answers[request.command] = {Answer::Form::reply, Status::invalid_value, 0};
    } else {
      host_.answers[request.command] = reading(script_.value());
    }
    if (random().one_in(5000)) application_.change_protection(1, 0);
  }

  void act() {
    switch (random().between(0, 9)) {
      case 0: flip(host_.input_levels.at(index(4))); break;
      case 1: flip(motor().at_target); break;
      case 2: flip(motor().left_switch); break;
      case 3: flip(motor().stalled); break;
      case 4: flip(motor().deviated); break;
      case 5: flip(host_.present_alarms.external); break;
      case 6: foresee(); break;
      default: control(); break;
    }
    application_.run_due(host_.now);
  }
  void foresee() {
    auto& reached = motor().at_target;
    host_.future[host_.now + milliseconds(random().positive(50))] = [&reached] { flip(reached); };
  }
  void control() {
    static constexpr Command commands[] = {
        Command::RUN_APPLICATION,  Command::RUN_APPLICATION,        Command::RUN_APPLICATION,
        Command::STOP_APPLICATION, Command::STEP_APPLICATION,       Command::RESET_APPLICATION,
        Command::START_DOWNLOAD,   Command::END_DOWNLOAD,           Command::END_DOWNLOAD,
        Command::READ_TMCL_MEMORY, Command::GET_APPLICATION_STATUS, Command::BREAKPOINT};
    const auto command = commands[index(std::size(commands))];
    const Request request{ModuleAddress{1}, command,
                          static_cast<std::uint8_t>(random().between(0, 2)), 0, script_.value()};
    application_.execute(request, host_.now);
    if (!application_.in_download()) return;
    for (auto lines = random().between(0, 10); lines > 0; --lines) {
      const auto line = script_.instruction();
      application_.record({ModuleAddress{1}, line.command, line.type, line.motor, line.value});
    }
  }

  void pass(Duration duration) {
    const auto until = host_.now + duration;
    for (auto due = application_.next_due(); due <= until; due = application_.next_due()) {
      host_.advance_to(std::max(due, host_.now));
      const auto performed = host_.performed.size();
      ++looks_;
      application_.run_due(host_.now);
      ASSERT_GT(application_.next_due(), host_.now) << "needs attention without end";
      ASSERT_LE(host_.performed.size(), performed + 1);
      check();
    }
    host_.advance_to(until);
  }
  void check() {
    ASSERT_LE(application_.program_counter(), 2048);
    ASSERT_TRUE(application_.status() >= 0 && application_.status() <= 3);
    const auto error = application_.last_error();
    if (error == 0) return;
    ASSERT_NE(find_status(static_cast<Status>(error)), nullptr);
    ASSERT_FALSE(is_success(static_cast<Status>(error)));
    ASSERT_NE(application_.status(), 1);
  }

  static void flip(bool& value) { value = !value; }
  std::size_t index(std::size_t size) {
    return static_cast<std::size_t>(random().between(0, static_cast<std::int64_t>(size) - 1));
  }
  MotorConditions& motor() { return host_.motor_conditions.at(index(2)); }

  std::size_t looks_ = 0;
  ProgramScript script_;
  FakeHost host_;
  Application application_{host_};
};

TEST(SimProgramProperty, NoProgramDoesHarm) {
  std::size_t looks = 0;
  for (auto seed = test::seed(); seed < test::seed() + 5000 && !testing::Test::HasFailure();
       ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    ProgramTrial trial(seed);
    trial.run();
    looks += trial.looks();
  }
  EXPECT_GT(looks, 300'000U);  // otherwise this tests little
}

/// Runs a program to its end on these variables.
void compute(const Program& lines, std::array<std::int32_t, 256>& variables) {
  FakeHost host;
  host.variables = variables;
  Application application(host);
  application.load(lines);
  application.power_on(true, host.now);
  for (int commands = 0; application.status() == 1; ++commands) {
    ASSERT_LT(commands, 100'000);
    host.advance_to(application.next_due());
    application.run_due(host.now);
  }
  ASSERT_EQ(application.last_error(), 0);
  variables = host.variables;
}

TEST(SimProgramProperty, TheGreatestCommonDivisor) {
  const auto lines = assembled(R"(
    Loop: CALCV COMP, 1, 0
          JC EQ, End
          CALCVV MOD, 0, 1
          CALCVV SWAP, 0, 1
          JA Loop
    End:  STOP)");
  Random random(test::seed());
  for (int i = 0; i < 200; ++i) {
    std::array<std::int32_t, 256> variables{};
    const auto a = variables[0] = static_cast<std::int32_t>(random.any_size(INT32_MAX));
    const auto b = variables[1] = static_cast<std::int32_t>(random.any_size(INT32_MAX));
    compute(lines, variables);
    ASSERT_EQ(variables[0], std::gcd(a, b)) << a << ", " << b;
  }
}

// By the indexed commands, with a subroutine for each pair. Variable 200 is the length.
TEST(SimProgramProperty, Sorting) {
  const auto lines = assembled(R"(
    Length = 200
    Index  = 201
    Left   = 202
    Pass:   CALCV LOAD, Index, 0
            CALCVV LOAD, 203, Length
    Pairs:  CSUB Order
            CALCV ADD, Index, 1
            DJNZ 203, Pairs
            DJNZ Length, Pass
            STOP
    Order:  CALCXV LOAD, Index
            GIV
            CALCVA LOAD, Left
            CALCV ADD, Index, 1
            CALCXV LOAD, Index
            CALCV SUB, Index, 1
            GIV
            CALCVA COMP, Left               // the left one with the right one
            JC LE, Ordered
            CALCVA LOAD, 204
            CALCAV LOAD, Left
            AIV
            CALCXV LOAD, Index
            CALCAV LOAD, 204
            AIV
    Ordered: RSUB)");
  Random random(test::seed());
  for (int i = 0; i < 50; ++i) {
    std::array<std::int32_t, 256> variables{};
    const auto length = static_cast<std::ptrdiff_t>(random.between(2, 30));
    variables[200] = static_cast<std::int32_t>(length - 1);
    for (std::ptrdiff_t k = 0; k < length; ++k)
      variables[static_cast<std::size_t>(k)] =
          static_cast<std::int32_t>(random.between(INT32_MIN, INT32_MAX));
    auto expected = variables;
    std::sort(expected.begin(), expected.begin() + length);
    compute(lines, variables);
    ASSERT_TRUE(std::equal(variables.begin(), variables.begin() + length, expected.begin()));
  }
}

}  // namespace
}  // namespace tmcl::sim
