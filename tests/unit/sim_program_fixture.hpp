/// A stand-alone program in virtual time, on a module that consists of what a test says it does.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "sim/program/application.hpp"
#include "support/program_host.hpp"

namespace tmcl::sim {

using std::chrono::microseconds;
using std::chrono::milliseconds;

class ProgramTest : public testing::Test {
 protected:
  static Request request(Command command, std::uint8_t type = 0, std::int32_t value = 0) {
    return {ModuleAddress{1}, command, type, 0, value};
  }
  Answer control(Command command, std::uint8_t type = 0, std::int32_t value = 0) {
    return application.execute(request(command, type, value), host.now);
  }
  Status status_of(Command command, std::uint8_t type = 0, std::int32_t value = 0) {
    return control(command, type, value).status;
  }

  /// Lets time pass. Nobody looks at the program but when it asks for it.
  void pass(Duration duration) {
    const auto until = host.now + duration;
    for (auto due = application.next_due(); due <= until; due = application.next_due()) {
      ASSERT_GE(due, host.now);
      host.advance_to(due);
      application.run_due(host.now);
    }
    host.advance_to(until);
  }

  void load(const std::string& text) { application.load(assembled(text)); }
  /// Runs a program from its start, for as long as it needs or ten seconds.
  void run(const std::string& text) {
    load(text);
    control(Command::RUN_APPLICATION, 1, 0);
    pass(std::chrono::seconds(10));
  }

  bool running() const { return application.status() == 1; }
  std::int32_t variable(std::uint8_t number) const { return host.variables[number]; }

  FakeHost host;
  Application application{host};
};

}  // namespace tmcl::sim
