/// Programs in modules: what clients load, and what the modules do by them. A program counts in its
/// module before it moves a motor, so that an observer sees whose movement it is, and after: a stop
/// may come between its count and its movement.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "sim/module/module.hpp"
#include "support/random.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/program.hpp"

namespace tmcld::test {

/// The user variable that counts what programs have done with the motors of their module. One for
/// all: a load that breaks off leaves lines of two programs, which may name different motors.
constexpr std::uint8_t program_counter = 20;
inline std::int32_t moves_by_program(const tmcl::sim::Module& module, std::uint8_t /*motor*/) {
  return module.globals().user_variable(program_counter);
}

/// Each client has its own place in the memory of a module: what runs is known by where it begins.
constexpr std::uint16_t program_place(int client) {
  return static_cast<std::uint16_t>(client * 64);
}

class ProgramText {
 public:
  explicit ProgramText(std::uint16_t place) : place_(place) {}

  ProgramText& moves(tmcl::Command command, std::uint8_t motor, std::int32_t value) {
    counts();
    lines_.push_back({command, tmcl::move_type::absolute, motor, value});
    return counts();
  }
  /// Ten milliseconds each.
  ProgramText& waits(std::int32_t ticks) {
    lines_.push_back({tmcl::Command::WAIT, 0, 0, ticks});
    return *this;
  }
  ProgramText& waits_until_there(std::uint8_t motor, std::int32_t at_most_ticks) {
    constexpr std::uint8_t position = 1;
    lines_.push_back({tmcl::Command::WAIT, position, motor, at_most_ticks});
    return *this;
  }
  tmcl::program::Program that_ends() {
    lines_.push_back({tmcl::Command::STOP, 0, 0, 0});
    return lines_;
  }
  tmcl::program::Program in_a_loop() {
    lines_.push_back({tmcl::Command::JA, 0, 0, place_});
    return lines_;
  }

 private:
  ProgramText& counts() {
    const auto next = static_cast<std::int32_t>(place_ + lines_.size() + 1);
    lines_.push_back({tmcl::Command::DJNZ, program_counter, 0, next});
    return *this;
  }

  std::uint16_t place_;
  tmcl::program::Program lines_;
};

/// `position` and `speed` are the client's own.
inline tmcl::program::Program any_program(tmcl::test::Random<>& random, std::uint16_t place,
                                          std::uint8_t motor, std::int32_t position,
                                          std::int32_t speed) {
  using tmcl::Command;
  constexpr std::int32_t patience = 300;
  const auto pause = static_cast<std::int32_t>(random.between(5, 150));
  ProgramText text(place);
  switch (random.between(0, 3)) {
    case 0: return text.moves(Command::ROR, motor, speed).that_ends();
    case 1:
      return text.moves(Command::ROR, motor, speed)
          .waits(pause)
          .moves(Command::MST, motor, 0)
          .that_ends();
    case 2:
      return text.moves(Command::MVP, motor, position)
          .waits_until_there(motor, patience)
          .moves(Command::MVP, motor, -position)
          .waits_until_there(motor, patience)
          .in_a_loop();
    default:
      return text.moves(Command::ROR, motor, speed)
          .waits(pause)
          .moves(Command::ROL, motor, speed)
          .waits(pause)
          .in_a_loop();
  }
}

inline tmcl::program::Instruction line_of(const tmcl::Request& request) {
  return {request.command, request.type, request.motor, request.value};
}
inline tmcl::Request request_of(const tmcl::program::Instruction& line,
                                tmcl::ModuleAddress module) {
  return {module, line.command, line.type, line.motor, line.value};
}

/// It runs a program, or a line of one.
inline bool starts_program(const tmcl::Request& request) {
  return request.command == tmcl::Command::RUN_APPLICATION ||
         request.command == tmcl::Command::STEP_APPLICATION;
}

/// Which modules record what they are sent.
class Downloads {
 public:
  /// What a module that hears is sent, and what it has answered: a line behind its beginning is
  /// recorded before that is answered.
  void note(const std::string& bus, const tmcl::Request& request) {
    if (request.command == tmcl::Command::START_DOWNLOAD) open_.insert({bus, request.address});
    if (request.command == tmcl::Command::END_DOWNLOAD) open_.erase({bus, request.address});
  }
  void on_restart(const std::string& bus, tmcl::ModuleAddress module) {
    open_.erase({bus, module});
  }
  bool records(const std::string& bus, const tmcl::Request& request) const {
    constexpr int first_that_is_executed = 128;
    return static_cast<int>(request.command) < first_that_is_executed &&
           open_.contains({bus, request.address});
  }

 private:
  std::set<std::pair<std::string, tmcl::ModuleAddress>> open_;
};

/// Modules whose programs a stop of everything has ended: they move no motor any more.
class EndedPrograms {
 public:
  using Place = std::pair<std::string, tmcl::ModuleAddress>;

  /// One is started, or the module starts again.
  void on_start(const Place& place, tmcl::TimePoint now) {
    started_[place] = now;
    counts_.erase(place);
  }
  /// A stop that was asked for then is done. `count`: of what programs have moved until now.
  void on_stop_of_all(const Place& place, tmcl::TimePoint called, std::int32_t count) {
    const auto started = started_.find(place);
    if (started == started_.end() || started->second < called) counts_[place] = count;
  }
  bool go_on(const Place& place, std::int32_t count) {
    const auto found = counts_.find(place);
    if (found == counts_.end() || found->second == count) return false;
    counts_.erase(found);
    return true;
  }

 private:
  std::map<Place, tmcl::TimePoint> started_;
  std::map<Place, std::int32_t> counts_;
};

}  // namespace tmcld::test
