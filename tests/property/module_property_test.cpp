// A simulated module is given commands that make sense, and commands that make none, at any time:
// it answers with what exists, reading changes nothing, and no parameter leaves its range.
#include <gtest/gtest.h>

#include <sstream>

#include "sim/bench.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/command.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

constexpr int commands_per_module = 3000;
constexpr std::uint8_t error_flags = 207;
constexpr std::uint8_t suppress_reply = 255;
constexpr Duration longest_pause = std::chrono::milliseconds(400);

class NoEvents final : public EventSink {
 public:
  void target_reached(const Module& module, std::int32_t motors) override {
    EXPECT_GT(motors, 0);
    EXPECT_EQ(motors >> module.model().axes, 0);
  }
};

class Script {
 public:
  Script(const Model& model, std::uint64_t seed)
      : model_(&model), random_(seed), module_(model, ModuleAddress{1}, clock_) {}

  void step() {
    pass();
    const auto request = random_.one_in(8) ? senseless() : sensible();
    if (Application::is_control(request.command)) return;  // programs are tried elsewhere
    SCOPED_TRACE(describe(request));
    const bool reads = effect_of(request.command, request.type) == Effect::reads;
    const auto before = reads ? state() : std::string();
    const auto answer = module_.execute(request, Medium::serial, events_);
    check(request, answer, reads);
    const bool answered = answer.form != Answer::Form::none;
    if (reads && answered && !clears(request)) {
      EXPECT_EQ(state(), before);
    }
  }

  void check_ranges() const {
    for (std::size_t motor = 0; motor < model_->axes; ++motor) {
      for (const auto& row : axis_parameters(*model_)) {
        if (row.scale != Scale::fixed) continue;
        const auto value = module_.axis(motor).get(row.number);
        ASSERT_TRUE(value);
        EXPECT_GE(*value, row.minimum) << row.name;
        EXPECT_LE(*value, row.maximum) << row.name;
      }
    }
    for (const auto& row : global_parameters(*model_)) {
      EXPECT_GE(module_.globals().value(row.number), row.minimum) << row.name;
      EXPECT_LE(module_.globals().value(row.number), row.maximum) << row.name;
    }
  }

 private:
  void pass() {
    if (random_.one_in(3)) clock_.advance(Duration(random_.any_size(longest_pause.count())));
    if (random_.one_in(50)) module_.set_input(0, random_.one_in(2));
    module_.run_due();
  }

  Request senseless() {
    return {ModuleAddress{1}, static_cast<Command>(random_.between(0, 255)), byte(), byte(),
            static_cast<std::int32_t>(random_.between(INT32_MIN, INT32_MAX))};
  }

  Request sensible() {
    const auto commands = command_table();
    const auto command = commands[index(commands.size())].command;
    return {ModuleAddress{1}, command, type_for(command),
            static_cast<std::uint8_t>(random_.between(0, model_->axes)), any_value()};
  }

  std::uint8_t type_for(Command command) {
    switch (command) {
      case Command::SAP:
      case Command::GAP:
      case Command::STAP:
      case Command::RSAP:
      case Command::GET_AP_MIN: return number_in(axis_parameters(*model_));
      case Command::SGP:
      case Command::GGP:
      case Command::STGP:
      case Command::RSGP: return number_in(global_parameters(*model_));
      default: return static_cast<std::uint8_t>(random_.between(0, 3));
    }
  }

  std::int32_t any_value() {
    if (random_.one_in(20)) return 1234;
    return static_cast<std::int32_t>(random_.either_way(random_.any_size(INT32_MAX)));
  }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_.between(0, 255)); }
  std::size_t index(std::size_t size) {
    return static_cast<std::size_t>(random_.between(0, static_cast<std::int64_t>(size) - 1));
  }
  std::uint8_t number_in(std::span<const ParameterInfo> table) {
    return table[index(table.size())].number;
  }

  // GAP of the error flags clears them, and GCO for all motors loads from the EEPROM.
  static bool clears(const Request& request) {
    return (request.command == Command::GAP && request.type == error_flags) ||
           (request.command == Command::GCO && request.motor == 255);
  }

  void check(const Request& request, const Answer& answer, bool reads) {
    if (answer.form == Answer::Form::none) {
      EXPECT_EQ(answer, no_answer);
      EXPECT_TRUE(!reads || deaf(request));
      return;
    }
    if (answer.form != Answer::Form::reply) return;
    ASSERT_NE(find_status(answer.status), nullptr) << static_cast<int>(answer.status);
    EXPECT_NE(answer.status, Status::wrong_checksum);
    const bool refused = !is_success(answer.status);
    if (refused && answer.value != 0) {
      EXPECT_EQ(answer.value, request.value);
    }
    EXPECT_TRUE(reads || module_.globals().value(suppress_reply) == 0);
  }

  // A module that does not answer a reading is starting, and answers it when that is over.
  bool deaf(const Request& request) {
    clock_.advance(Module::boot_time);
    return module_.execute(request, Medium::serial, events_).form != Answer::Form::none;
  }

  std::string state() {
    std::ostringstream out;
    for (std::size_t motor = 0; motor < model_->axes; ++motor) {
      for (const auto& row : axis_parameters(*model_)) {
        out << *module_.axis(motor).get(row.number) << ' ';
      }
    }
    for (int number = 0; number < 256; ++number) {
      const auto n = static_cast<std::uint8_t>(number);
      out << module_.globals().value(n) << ' ' << module_.globals().user_variable(n) << ' '
          << module_.globals().interrupt_setting(n) << ' ';
    }
    out << module_.io().outputs() << ' ' << module_.eeprom().writes();
    return out.str();
  }

  static std::string describe(const Request& request) {
    std::ostringstream out;
    out << name_of(request.command) << ' ' << int{request.type} << ", " << int{request.motor}
        << ", " << request.value;
    return out.str();
  }

  const Model* model_;
  test::Random<> random_;
  VirtualClock clock_;
  Module module_;
  NoEvents events_;
};

TEST(ModuleProperty, AnswersWhateverItIsTold) {
  for (const auto& model : models()) {
    SCOPED_TRACE(model.name);
    Script script(model, test::seed() + model.number);
    for (int i = 0; i < commands_per_module && !testing::Test::HasFailure(); ++i) script.step();
    script.check_ranges();
  }
}

}  // namespace
}  // namespace tmcl::sim
