/// The firmware of one module: executes commands, runs its motors, watches for a silent host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sim/module/answer.hpp"
#include "sim/module/axis.hpp"
#include "sim/module/bootloader.hpp"
#include "sim/module/coordinates.hpp"
#include "sim/module/data_logger.hpp"
#include "sim/module/eeprom.hpp"
#include "sim/module/event_sink.hpp"
#include "sim/module/globals.hpp"
#include "sim/module/heartbeat.hpp"
#include "sim/module/io.hpp"
#include "sim/module/module_settings.hpp"
#include "sim/module/target_events.hpp"
#include "sim/program/application.hpp"
#include "sim/stage/stage.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/model.hpp"
#include "tmcl/version.hpp"

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
class Module final : private ProgramHost {
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

  const ModuleSettings& settings() const { return settings_; }

  /// Executes a command that was addressed to this module. `from` is where a later event goes.
  Answer execute(const Request& request, Medium medium, EventSink& from);
  /// Its supply fails now, and is back at once.
  void power_cycle();
  /// Its supply fails until power_cycle(): it is deaf, and no motor moves.
  void power_off();
  /// It is on, and has started.
  bool hears() const { return clock_->now() >= deaf_until_; }
  /// No more events to this sink.
  void forget(const EventSink& sink) { events_.forget(sink); }

  /// When run_due() has something to do, if no command comes before.
  TimePoint next_due() const;
  void run_due();

  const Model& model() const { return *model_; }
  const Globals& globals() const { return globals_; }
  Eeprom& eeprom() { return eeprom_; }
  const Io& io() const { return io_; }
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
  const Axis& axis(std::size_t motor) const { return axes_.at(motor); }
  const Stage& stage(std::size_t motor) const { return stages_.at(motor); }
  /// Gives a motor something to drive.
  void mount(std::size_t motor, const StageSettings& settings);
  /// An action on the stage of a motor, now.
  void at_stage(std::size_t motor, const std::function<void(Stage&)>& change);
  /// Whether its serial interface speaks ASCII, after command 139 or a start with bit 0 of global
  /// parameter 67.
  bool in_ascii_mode() const { return in_ascii_mode_; }
  void leave_ascii_mode() { in_ascii_mode_ = false; }
  /// Of its firmware or, while it is in there, of its bootloader.
  FirmwareVersion version() const { return in_bootloader_ ? bootloader_.version() : firmware_; }

 private:
  /// Commands that only a host gives.
  Answer execute_direct(const Request& request, EventSink& from);
  /// Commands that a stand-alone program gives as well.
  Answer perform(const Request& request) override;

  // motion_commands.cpp
  Answer rotate(const Request& request, std::int32_t sign);
  Answer stop(const Request& request);
  Answer move(const Request& request);
  Answer search(const Request& request);
  /// The motors that an MVP of this one moves: bit n for motor n.
  std::uint32_t companions(std::size_t motor) const;
  bool answers_with_target() const;

  // parameter_commands.cpp
  Answer set_axis_parameter(const Request& request);
  Answer get_axis_parameter(const Request& request);
  Answer store_axis_parameter(const Request& request);
  Answer restore_axis_parameter(const Request& request);
  void restore_axis(std::size_t motor);
  Answer set_global_parameter(const Request& request);
  /// As the global parameters say that are about all motors.
  void wire_axes();
  Answer get_global_parameter(const Request& request);
  Answer store_global_parameter(const Request& request);
  Answer restore_global_parameter(const Request& request);

  // register_commands.cpp
  Answer access_controller(const Request& request);
  Answer access_driver(const Request& request);
  struct ChipRegister {
    std::size_t motor;
    std::uint8_t address;
  };
  std::optional<ChipRegister> controller_register(const Request& request) const;

  // data_logger_commands.cpp
  bool has_data_logger() const;
  Answer access_data_logger(const Request& request);
  DataLogger::Probe data_logger_probe();
  std::uint32_t read_channel(const DataLogger::Channel& channel);
  std::uint32_t stacked_register(std::uint32_t select);

  // io_commands.cpp
  Answer set_output(const Request& request);
  Answer get_input(const Request& request) const;

  // coordinate_commands.cpp
  Answer set_coordinate(const Request& request);
  Answer get_coordinate(const Request& request);
  Answer capture_coordinate(const Request& request);
  Answer move_to_coordinate(const Request& request);
  struct MotorGroup {
    std::uint32_t motors;  ///< Bit n for motor n.
    bool together;         ///< They shall arrive together.
  };
  std::optional<MotorGroup> group_of(std::uint8_t field) const;
  void arrive_together(std::uint32_t motors);
  Status capture(std::uint8_t motor, std::uint8_t number);
  Status capture_all(std::uint8_t number);
  Answer keep_coordinates(const Request& request);
  bool keeps_coordinates() const;
  Status put_coordinate(std::uint8_t motor, std::uint8_t number, std::int32_t position);

  // program_commands.cpp
  void start_application();
  bool has_letter() const;
  Answer control_application(const Request& request);
  void keep_program();
  bool has_state_in_low_byte() const;
  void protect_program(std::int32_t before, std::int32_t after);
  /// What a global parameter of bank 0 tells about the program; nothing if it is about other
  /// things.
  std::optional<std::int32_t> application_parameter(std::uint8_t number) const;
  std::int32_t user_variable(std::uint8_t number) const override {
    return globals_.user_variable(number);
  }
  void set_user_variable(std::uint8_t number, std::int32_t value) override {
    globals_.set_user_variable(number, value);
  }
  std::int32_t interrupt_setting(std::uint8_t number) const override {
    return globals_.interrupt_setting(number);
  }
  std::int32_t code_protection() const override;
  std::size_t motors() const override { return axes_.size(); }
  MotorConditions motor(std::size_t number) const override;
  std::size_t inputs() const override { return io_.inputs(); }
  bool input(std::size_t number) const override { return io_.input(number); }
  Alarms alarms() const override;
  TimePoint next_event() const override;

  // system_commands.cpp
  Answer tell_version(const Request& request) const;
  Answer arm_event(const Request& request, EventSink& from);
  Answer restart_after_reply(const Request& request);
  Answer reset_to_factory_settings(const Request& request);
  Answer tell_info(const Request& request) const;
  Answer tell_limit(const Request& request) const;
  Answer tell_measured_speed(const Request& request) const;
  Answer reset_board(const Request& request);

  /// What a wrong code is answered by, where the manual's firmware refuses it so.
  Status wrong_code(Status refusal) const {
    return settings_.behaviour == Behaviour::lite ? Status::ok : refusal;
  }

  // mode_commands.cpp
  Answer enter_ascii_mode(const Request& request);
  Answer enter_bootloader(const Request& request);
  Answer execute_in_bootloader(const Request& request);

  /// What happens when the power comes on.
  void power_up();
  void restart();
  void build_axes();

  bool has_motor(const Request& request) const { return request.motor < axes_.size(); }
  void stop_motor(std::size_t motor);
  void stop_all_motors();
  /// Lets the stand-alone program run; a shutdown has the last word.
  void run_application();
  bool shut_down() const;
  void put_supply(std::int32_t supply);
  void end_brown_out();

  Heartbeat& heartbeat(Medium medium) { return medium == Medium::serial ? serial_ : can_; }
  TimePoint serial_due() const;
  TimePoint can_due() const;
  void stop_if_silent();
  bool ignores_silence() const;

  void bring_to(TimePoint time);
  void run_what_is_due_now();

  /// Of the firmware that it came with.
  FirmwareVersion delivered_version() const;

  const Model* model_;
  const Clock* clock_;
  ModuleSettings settings_;
  TimePoint now_;  ///< How far the module has come: never later than the clock.
  TimePoint deaf_until_;
  Eeprom eeprom_;
  Globals globals_;
  Io io_;
  Coordinates coordinates_;
  std::vector<Stage> stages_;  // what is bolted on stays, whatever happens to the module
  std::vector<Axis> axes_;
  TargetEvents events_;
  DataLogger logger_;
  Application application_{*this};
  std::optional<bool> shutdown_input_;  // nothing connected: it does not act
  TimePoint supply_returns_ = never;
  std::int32_t supply_before_ = 0;  // the brown-out
  Heartbeat serial_;
  Heartbeat can_;
  Bootloader bootloader_;
  FirmwareVersion firmware_;
  bool in_bootloader_ = false;
  bool in_ascii_mode_ = false;
  bool bootloader_wanted_ = false;  ///< At the next start.
  bool restarts_ = false;           ///< As soon as the present command is answered.
};

}  // namespace tmcl::sim
