/// The firmware of one module: executes commands, runs its motors, watches for a silent host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "sim/module/command_groups.hpp"
#include "sim/module/module_state.hpp"
#include "sim/module/supply.hpp"

namespace tmcl::sim {

/// Which kind of wire a command came by; each has its own heartbeat.
enum class Medium : std::uint8_t { serial, can };

/// Does no I/O. Time is that of the clock it was built with; whatever happens in the module happens
/// at its own instant, to the tick, however late it is looked at.
///
/// Errors come in the order checksum (found by the receiver), command, type, motor or bank, value.
/// Except for what a command reads, a reply's value repeats the request's; only a relative movement
/// of a sixPoint module tells its target.
///
/// After a restart (commands 255 and 137, power_cycle()) it is deaf for `boot_time`. Its motors
/// stand at 0 then, and it knows what is in its EEPROM; what is outside the module, the inputs and
/// whatever the motors drive, is as before.
///
/// In its bootloader it is after command 242, and for as long as it has no firmware that could run.
/// It knows other commands there, and no motor moves.
class Module final {
 public:
  /// Real modules take about a second. This is long enough to be noticed, and short enough for
  /// programs that wait too little.
  static constexpr Duration boot_time = std::chrono::milliseconds(100);

  /// A module as delivered, except for its address on serial lines and CAN alike. The clock must
  /// outlive the module.
  Module(const Model& model, ModuleAddress address, const Clock& clock,
         const ModuleSettings& settings = {});
  /// One with this memory.
  Module(const Model& model, Eeprom eeprom, const Clock& clock,
         const ModuleSettings& settings = {});
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  const ModuleSettings& settings() const { return state_.settings; }

  /// Executes a command that was addressed to this module. `from` is where a later event goes.
  Answer execute(const Request& request, Medium medium, EventSink& from);
  /// Its supply fails now, and is back at once.
  void power_cycle();
  /// Its supply fails until power_cycle(): it is deaf, and no motor moves.
  void power_off();
  /// It is on, and has started.
  bool hears() const { return state_.clock->now() >= state_.deaf_until; }
  /// No more events to this sink.
  void forget(const EventSink& sink) { state_.events.forget(sink); }

  /// When run_due() has something to do, if no command comes before.
  TimePoint next_due() const;
  void run_due();

  const Model& model() const { return *state_.model; }
  const Globals& globals() const { return state_.globals; }
  Eeprom& eeprom() { return state_.eeprom; }
  /// Of its stand-alone program, what no command tells.
  Processor::Inside program_inside() const { return programs_.application().inside(); }
  const Io& io() const { return state_.io; }
  /// The world outside drives an input now. False for a port or value that does not exist.
  bool set_input(std::uint8_t port, bool high);
  bool set_analog(std::uint8_t port, std::int32_t value);
  /// The supply of the motors, in tenths of a volt; the module goes on, as by USB. Below 7 V their
  /// drivers are off.
  void set_supply(std::int32_t supply);
  /// Too little of it for so long.
  void brown_out(Duration duration);
  /// The same for its shutdown input, for global parameter 80; false for a model without.
  bool set_shutdown_input(bool high);
  /// As it was when run_due() or execute() last ran.
  const Axis& axis(std::size_t motor) const { return state_.axes.at(motor); }
  const Stage& stage(std::size_t motor) const { return state_.stages.at(motor); }
  /// Gives a motor something to drive.
  void mount(std::size_t motor, const StageSettings& settings);
  /// An action on the stage of a motor, now.
  void at_stage(std::size_t motor, const std::function<void(Stage&)>& change);
  /// Whether its serial interface speaks ASCII, after command 139 or a start with bit 0 of global
  /// parameter 67.
  bool in_ascii_mode() const { return state_.in_ascii_mode; }
  void leave_ascii_mode() { state_.in_ascii_mode = false; }
  /// Of its firmware or, while it is in there, of its bootloader.
  FirmwareVersion version() const { return state_.version(); }

 private:
  /// Commands that only a host gives.
  Answer execute_direct(const Request& request, EventSink& from);
  /// Commands that a stand-alone program gives as well.
  Answer perform(const Request& request);

  /// What happens when the power comes on.
  void power_up();
  void restart();
  /// Lets the stand-alone program run; a shutdown has the last word.
  void run_application();

  Heartbeat& heartbeat(Medium medium) {
    return medium == Medium::serial ? state_.serial : state_.can;
  }
  TimePoint serial_due() const;
  TimePoint can_due() const;
  void stop_if_silent();
  bool ignores_silence() const;

  void bring_to(TimePoint time);
  void run_what_is_due_now();

  ModuleState state_;
  Supply supply_{state_};
  MotionCommands motion_{state_};
  CoordinateCommands coordinates_{state_};
  ProgramCommands programs_{state_, [this](const Request& request) { return perform(request); }};
  AxisParameterCommands axis_parameters_{state_};
  GlobalParameterCommands global_parameters_{state_, programs_};
  RegisterCommands registers_{state_};
  DataLoggerCommands logger_{state_, axis_parameters_, global_parameters_, registers_};
  SystemCommands system_{state_};
};

}  // namespace tmcl::sim
