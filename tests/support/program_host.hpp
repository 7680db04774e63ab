/// A module for stand-alone programs that consists of what a test says it does.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "sim/module/due.hpp"
#include "sim/program/host.hpp"
#include "tmcl/assembler.hpp"
#include "tmcl/program.hpp"

namespace tmcl::sim {

/// A program from its text; a failure if there is something wrong with it.
inline program::Program assembled(const std::string& text) {
  using Text = tl::expected<std::string, std::string>;
  const auto assembly =
      program::assemble("test.tmc", [&](const std::string&) { return Text(text); });
  if (assembly) return assembly->program;
  ADD_FAILURE() << describe(assembly.error().front());
  return {};
}

/// Two motors, four inputs. Everything stays as a test sets it, or will set it in `future`.
class FakeHost final : public ProgramHost {
 public:
  Answer perform(const Request& request) override {
    performed.push_back(request);
    performed_at.push_back(now);
    if (on_perform) on_perform(request);
    const auto found = answers.find(request.command);
    return found == answers.end() ? echo(request) : found->second;
  }
  std::int32_t user_variable(std::uint8_t number) const override { return variables[number]; }
  void set_user_variable(std::uint8_t number, std::int32_t value) override {
    variables[number] = value;
  }
  std::int32_t interrupt_setting(std::uint8_t number) const override { return settings[number]; }
  std::int32_t code_protection() const override { return protection; }
  std::size_t motors() const override { return motor_conditions.size(); }
  MotorConditions motor(std::size_t number) const override { return motor_conditions.at(number); }
  std::size_t inputs() const override { return input_levels.size(); }
  bool input(std::size_t number) const override { return input_levels.at(number); }
  Alarms alarms() const override { return present_alarms; }
  TimePoint next_event() const override {
    return unforeseen || future.empty() ? sim::never : future.begin()->first;
  }

  /// Lets happen what is due.
  void advance_to(TimePoint time) {
    now = time;
    while (!future.empty() && future.begin()->first <= now) {
      future.begin()->second();
      future.erase(future.begin());
    }
  }

  TimePoint now{};
  std::vector<Request> performed;
  std::vector<TimePoint> performed_at;
  std::function<void(const Request&)> on_perform;
  std::map<Command, Answer> answers;  // where it is not the echo
  std::array<std::int32_t, 256> variables{};
  std::array<std::int32_t, 256> settings{};
  std::int32_t protection = 0;
  std::array<MotorConditions, 2> motor_conditions{};
  std::array<bool, 4> input_levels{};
  Alarms present_alarms;
  std::map<TimePoint, std::function<void()>> future;
  bool unforeseen = false;
};

}  // namespace tmcl::sim
