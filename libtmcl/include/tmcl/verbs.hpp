/// What can be asked of an axis and of a module, as scripts.
///
/// Programs normally use Axis (tmcl/bus.hpp) or blocking::Axis (tmcl/blocking.hpp), which run
/// these.
///
/// Outcome: every verb ends with a value, or with an Error whose `outcome` says whether the module
/// may have acted. No verb sends a movement twice, and none sends a relative one.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/coordinates.hpp"
#include "tmcl/homing.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/module_verbs.hpp"
#include "tmcl/program_verbs.hpp"
#include "tmcl/script.hpp"
#include "tmcl/units.hpp"

namespace tmcl {

/// One look at an axis. The readings are taken one after the other, some milliseconds apart: first
/// position_reached, last the position.
struct AxisState {
  Microsteps position;
  InternalVelocity velocity;
  Microsteps target;
  bool position_reached =
      false;  ///< Axis parameter 8: position equals target, in any mode and even while passing.
};

/// What a module lets an axis parameter be.
struct ParameterRange {
  std::int32_t least = 0;
  std::int32_t greatest = 0;
};

struct WaitOptions {
  Duration poll_interval = std::chrono::milliseconds(20);
  /// Gives up with Errc::deadline_passed; zero: waits as long as the axis moves. By the clock: what
  /// has not been asked by then is not asked any more, so it is late by one exchange at most.
  Duration timeout{};
  /// How long the move is expected to take from now on: until shortly before that the axis is
  /// looked at once a second only, so that an interruption is noticed all the same. Zero: not
  /// known.
  Duration expected{};
  /// An axis that has not moved for so long without having arrived counts as interrupted.
  Duration standstill_limit = std::chrono::seconds(1);
  /// Where it is to stand: an axis that is on its way to somewhere else, or turns by velocity,
  /// counts as interrupted. Nothing: wherever its target is then.
  std::optional<Microsteps> goal{};
  /// With a goal: asked twice a second whether the axis turns by velocity. Nothing: not asked.
  std::optional<ModeParameter> mode{};
  /// For so long it must be seen to stand at its target, at every look: an axis that swings about
  /// it stands there now and then. Zero: two looks, one right after the other.
  Duration steady{};
};

struct FoundModule {
  ModuleAddress address;
  /// Of the bootloader, and said so, where no firmware runs.
  FirmwareVersion version;
  std::string_view model;  ///< "TMCM-3110"; empty for a model that is not known.
  std::uint8_t axes = 0;
  bool duplicate_suspected = false;
};

struct ScanOptions {
  std::uint16_t first = 1;
  std::uint16_t last = 255;  ///< At most 255 on a serial line, 2047 on CAN.
  /// Serial: how long one address gets to answer, on top of what the wire needs.
  Duration reply_timeout = std::chrono::milliseconds(25);
  /// Told after each group of addresses how many have been asked.
  std::function<void(std::size_t asked, std::size_t of)> progress{};
  /// Told of each module at once.
  std::function<void(const FoundModule&)> found{};
};

namespace verbs {

/// Any command, exactly as given.
Script<Result<Answer>> command(Request request, CallOptions options = {});

/// Reads an axis parameter, 0..255 (GAP).
Script<Result<std::int32_t>> get(AxisAddress axis, std::uint8_t parameter);
/// Reads several at once, proven together by one exchange that follows: for what a movement or
/// its units are computed from. The first error ends it.
Script<Result<std::vector<std::int32_t>>> get_all(AxisAddress axis,
                                                  std::vector<std::uint8_t> parameters,
                                                  CallOptions options = {});
/// Sets an axis parameter (SAP). When the answer is lost and the parameter does not move the motor,
/// reading it back settles whether it was set.
Script<Result<void>> set(AxisAddress axis, std::uint8_t parameter, std::int32_t value);
/// Copies an axis parameter to the EEPROM (STAP). Outcome::unknown when the answer is lost: it may
/// be stored.
Script<Result<void>> store(AxisAddress axis, std::uint8_t parameter);
/// And back (RSAP); what it restores can move the motor.
Script<Result<void>> restore(AxisAddress axis, std::uint8_t parameter);
/// Asks the module itself (GET_AP_MIN, GET_AP_MAX), which not every firmware can tell.
Script<Result<ParameterRange>> parameter_range(AxisAddress axis, std::uint8_t parameter);
/// Reads a global parameter (GGP).
Script<Result<std::int32_t>> get_global(ModuleAddress module, std::uint8_t bank,
                                        std::uint8_t parameter);
/// Sets a global parameter (SGP). Parameters 64 to 127 of bank 0 go straight to the EEPROM. An
/// identifier on CAN that the module listens to must not be that of its replies (70, and 71 or 83):
/// the module is asked for the other one first, and Errc::bad_argument is the answer.
Script<Result<void>> set_global(ModuleAddress module, std::uint8_t bank, std::uint8_t parameter,
                                std::int32_t value);

/// Starts a positioning move (MVP ABS) and gives back its target.
Script<Result<Microsteps>> move_to(AxisAddress axis, Microsteps target);
/// Reads where the axis is, twice, adds, and starts a move to there; gives back the target. A sum
/// outside int32 is an error.
Script<Result<Microsteps>> move_by(AxisAddress axis, Microsteps distance);
/// Turns without end; ROR for a positive velocity, ROL for a negative one.
Script<Result<void>> rotate(AxisAddress axis, InternalVelocity velocity);
/// Ramps down to standstill (MST).
Script<Result<void>> stop(AxisAddress axis);

Script<Result<Microsteps>> position(AxisAddress axis);
Script<Result<InternalVelocity>> velocity(AxisAddress axis);
Script<Result<AxisState>> state(AxisAddress axis);

/// Polls until the axis stands at its target, and gives back the position.
/// Errors: Errc::move_interrupted when the axis was stopped, sent elsewhere by velocity, or stands
/// still short of the target; Errc::deadline_passed after the timeout.
Script<Result<Microsteps>> wait_until_reached(AxisAddress axis, WaitOptions options = {});

/// Model and firmware of one module, or its bootloader. `axes` comes from the table of models or,
/// for an unknown one, by asking.
Script<Result<FoundModule>> identify(ModuleAddress module);
/// Every module that answers, ascending by address. Silence is no error; a broken link is.
Script<Result<std::vector<FoundModule>>> scan(ScanOptions options = {});

}  // namespace verbs

/// Why a module that is in its bootloader does nothing.
Error no_firmware(ModuleAddress module);

/// The verbs bound to one axis of one bus. A cheap value; the bus must outlive it.
///
/// Each verb gives what Bus::run makes of a Script<T>: an awaitable of T on Asio, plainly T on a
/// blocking bus.
template <class Bus>
class BasicAxis {
 public:
  BasicAxis(Bus& bus, AxisAddress address) : bus_(&bus), address_(address) {}

  AxisAddress address() const { return address_; }

  auto move_to(Microsteps target) { return bus_->run(verbs::move_to(address_, target)); }
  auto move_by(Microsteps distance) { return bus_->run(verbs::move_by(address_, distance)); }
  auto rotate(InternalVelocity velocity) { return bus_->run(verbs::rotate(address_, velocity)); }
  auto stop() { return bus_->run(verbs::stop(address_)); }
  auto position() { return bus_->run(verbs::position(address_)); }
  auto velocity() { return bus_->run(verbs::velocity(address_)); }
  auto state() { return bus_->run(verbs::state(address_)); }
  auto wait_until_reached(WaitOptions options = {}) {
    return bus_->run(verbs::wait_until_reached(address_, options));
  }
  auto get(std::uint8_t parameter) { return bus_->run(verbs::get(address_, parameter)); }
  auto set(std::uint8_t parameter, std::int32_t value) {
    return bus_->run(verbs::set(address_, parameter, value));
  }
  auto store(std::uint8_t parameter) { return bus_->run(verbs::store(address_, parameter)); }
  auto restore(std::uint8_t parameter) { return bus_->run(verbs::restore(address_, parameter)); }
  auto parameter_range(std::uint8_t parameter) {
    return bus_->run(verbs::parameter_range(address_, parameter));
  }

  auto home(HomeOptions options = {}) { return bus_->run(verbs::home(address_, options)); }
  auto start_reference_search(std::optional<std::int32_t> mode = {}) {
    return bus_->run(verbs::start_reference_search(address_, mode));
  }
  auto stop_reference_search() { return bus_->run(verbs::stop_reference_search(address_)); }
  auto reference_search_status() { return bus_->run(verbs::reference_search_status(address_)); }

  auto set_coordinate(std::uint8_t number, Microsteps position) {
    return bus_->run(verbs::set_coordinate(address_, number, position));
  }
  auto coordinate(std::uint8_t number) { return bus_->run(verbs::coordinate(address_, number)); }
  auto capture_coordinate(std::uint8_t number) {
    return bus_->run(verbs::capture_coordinate(address_, number));
  }
  auto move_to_coordinate(std::uint8_t number) {
    return bus_->run(verbs::move_to_coordinate(address_, number));
  }

 private:
  Bus* bus_;
  AxisAddress address_;
};

/// The verbs bound to one module of one bus. A cheap value; the bus must outlive it.
template <class Bus>
class BasicModule {
 public:
  BasicModule(Bus& bus, ModuleAddress address) : bus_(&bus), address_(address) {}

  ModuleAddress address() const { return address_; }
  BasicAxis<Bus> axis(std::uint8_t motor) { return {*bus_, {address_, motor}}; }

  auto identify() { return bus_->run(verbs::identify(address_)); }
  auto get_global(std::uint8_t bank, std::uint8_t parameter) {
    return bus_->run(verbs::get_global(address_, bank, parameter));
  }
  auto set_global(std::uint8_t bank, std::uint8_t parameter, std::int32_t value) {
    return bus_->run(verbs::set_global(address_, bank, parameter, value));
  }
  auto store_global(std::uint8_t bank, std::uint8_t parameter) {
    return bus_->run(verbs::store_global(address_, bank, parameter));
  }
  auto restore_global(std::uint8_t bank, std::uint8_t parameter) {
    return bus_->run(verbs::restore_global(address_, bank, parameter));
  }
  auto get_io(IoBank bank, std::uint8_t port) {
    return bus_->run(verbs::get_io(address_, bank, port));
  }
  auto set_output(std::uint8_t port, std::int32_t value) {
    return bus_->run(verbs::set_output(address_, port, value));
  }
  auto firmware_info() { return bus_->run(verbs::firmware_info(address_)); }
  auto request_arrival_events(ArrivalEvents events, std::int32_t motors) {
    return bus_->run(verbs::request_arrival_events(address_, events, motors));
  }
  auto store_coordinates(std::optional<std::uint8_t> number = {}) {
    return bus_->run(verbs::store_coordinates(address_, number));
  }
  auto load_coordinates(std::optional<std::uint8_t> number = {}) {
    return bus_->run(verbs::load_coordinates(address_, number));
  }
  auto move_motors_to_coordinate(MotorMask motors, Together together, std::uint8_t number) {
    return bus_->run(verbs::move_motors_to_coordinate(address_, motors, together, number));
  }

  auto load_program(program::Program program, LoadOptions options = {}) {
    return bus_->run(verbs::load_program(address_, std::move(program), std::move(options)));
  }
  auto read_program(ReadOptions options = {}) {
    return bus_->run(verbs::read_program(address_, std::move(options)));
  }
  auto compare_program(program::Program program, LoadOptions options = {}) {
    return bus_->run(verbs::compare_program(address_, std::move(program), std::move(options)));
  }
  auto run_program(std::optional<std::uint16_t> address = std::nullopt) {
    return bus_->run(verbs::run_program(address_, address));
  }
  auto stop_program() { return bus_->run(verbs::stop_program(address_)); }
  auto step_program() { return bus_->run(verbs::step_program(address_)); }
  auto reset_program() { return bus_->run(verbs::reset_program(address_)); }
  auto program_status() { return bus_->run(verbs::program_status(address_)); }
  auto add_breakpoint(std::uint16_t address) {
    return bus_->run(verbs::add_breakpoint(address_, address));
  }
  auto delete_breakpoint(std::uint16_t address) {
    return bus_->run(verbs::delete_breakpoint(address_, address));
  }
  auto delete_all_breakpoints() { return bus_->run(verbs::delete_all_breakpoints(address_)); }
  auto most_breakpoints() { return bus_->run(verbs::most_breakpoints(address_)); }

  auto reset() { return bus_->run(verbs::reset_module(address_)); }
  auto factory_reset() { return bus_->run(verbs::factory_reset(address_)); }

 private:
  Bus* bus_;
  ModuleAddress address_;
};

}  // namespace tmcl
