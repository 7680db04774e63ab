/// What carries out the commands of a module: a class for each group of them.
#pragma once

#include <functional>

#include "sim/module/event_sink.hpp"
#include "sim/module/module_state.hpp"
#include "sim/program/application.hpp"

namespace tmcl::sim {

/// ROR, ROL, MST, MVP ABS and REL, RFS.
class MotionCommands {
 public:
  explicit MotionCommands(ModuleState& module) : module_(module) {}
  Answer rotate(const Request& request, std::int32_t sign);
  Answer stop(const Request& request);
  Answer move(const Request& request);
  Answer search(const Request& request);

 private:
  bool answers_with_target() const;

  ModuleState& module_;
};

/// SCO, GCO, CCO, MVP COORD.
class CoordinateCommands {
 public:
  explicit CoordinateCommands(ModuleState& module) : module_(module) {}
  Answer set(const Request& request);
  Answer get(const Request& request);
  Answer capture(const Request& request);
  Answer move(const Request& request);

 private:
  struct MotorGroup {
    std::uint32_t motors;  ///< Bit n for motor n.
    bool together;         ///< They shall arrive together.
  };
  std::optional<MotorGroup> group_of(std::uint8_t field) const;
  void arrive_together(std::uint32_t motors);
  Status capture(std::uint8_t motor, std::uint8_t number);
  Status capture_all(std::uint8_t number);
  Answer keep(const Request& request);
  Status put(std::uint8_t motor, std::uint8_t number, std::int32_t position);

  ModuleState& module_;
};

/// The control functions of stand-alone programs, and what a program sees of the module.
class ProgramCommands final : public ProgramHost {
 public:
  /// `perform`: a command that a program gives.
  ProgramCommands(ModuleState& module, std::function<Answer(const Request&)> perform)
      : module_(module), perform_(std::move(perform)) {}
  ProgramCommands(const ProgramCommands&) = delete;
  ProgramCommands& operator=(const ProgramCommands&) = delete;

  /// As the module starts.
  void start();
  Answer control(const Request& request);
  Application& application() { return application_; }
  const Application& application() const { return application_; }
  /// After code protection has changed.
  void protect(std::int32_t before, std::int32_t after);
  /// What a global parameter of bank 0 tells about the program; nothing if it is about other
  /// things.
  std::optional<std::int32_t> parameter(std::uint8_t number) const;
  std::int32_t code_protection() const override;

 private:
  void keep();
  bool has_state_in_low_byte() const;

  Answer perform(const Request& request) override { return perform_(request); }
  std::int32_t user_variable(std::uint8_t number) const override {
    return module_.globals.user_variable(number);
  }
  void set_user_variable(std::uint8_t number, std::int32_t value) override {
    module_.globals.set_user_variable(number, value);
  }
  std::int32_t interrupt_setting(std::uint8_t number) const override {
    return module_.globals.interrupt_setting(number);
  }
  std::size_t motors() const override { return module_.axes.size(); }
  MotorConditions motor(std::size_t number) const override;
  std::size_t inputs() const override { return module_.io.inputs(); }
  bool input(std::size_t number) const override { return module_.io.input(number); }
  Alarms alarms() const override;
  TimePoint next_event() const override;

  ModuleState& module_;
  std::function<Answer(const Request&)> perform_;
  Application application_{*this};
};

/// SAP, GAP, STAP, RSAP.
class AxisParameterCommands {
 public:
  explicit AxisParameterCommands(ModuleState& module) : module_(module) {}
  Answer set(const Request& request);
  Answer get(const Request& request);
  Answer store(const Request& request);
  Answer restore(const Request& request);

 private:
  ModuleState& module_;
};

/// SGP, GGP, STGP, RSGP.
class GlobalParameterCommands {
 public:
  GlobalParameterCommands(ModuleState& module, ProgramCommands& programs)
      : module_(module), programs_(programs) {}
  Answer set(const Request& request);
  Answer get(const Request& request);
  Answer store(const Request& request);
  Answer restore(const Request& request);

 private:
  ModuleState& module_;
  ProgramCommands& programs_;
};

/// WRITE_MC, READ_MC, WRITE_DRV, READ_DRV: registers of the chips, by their addresses.
class RegisterCommands {
 public:
  explicit RegisterCommands(ModuleState& module) : module_(module) {}
  Answer access_controller(const Request& request);
  Answer access_driver(const Request& request);

 private:
  struct ChipRegister {
    std::size_t motor;
    std::uint8_t address;
  };
  std::optional<ChipRegister> controller_register(const Request& request) const;

  ModuleState& module_;
};

/// RAM_DEBUG, and what a channel of the data logger reads: what the module would answer a host.
class DataLoggerCommands {
 public:
  DataLoggerCommands(ModuleState& module, AxisParameterCommands& axes,
                     GlobalParameterCommands& globals, RegisterCommands& registers)
      : module_(module), axes_(axes), globals_(globals), registers_(registers) {}
  Answer access(const Request& request);
  void run_due();

 private:
  bool has_data_logger() const;
  DataLogger::Probe probe();
  std::uint32_t read_channel(const DataLogger::Channel& channel);
  std::uint32_t stacked_register(std::uint32_t select);

  ModuleState& module_;
  AxisParameterCommands& axes_;
  GlobalParameterCommands& globals_;
  RegisterCommands& registers_;
};

/// Commands about the module itself, and those after which something else listens: the ASCII mode,
/// the bootloader, or the firmware again.
class SystemCommands {
 public:
  explicit SystemCommands(ModuleState& module) : module_(module) {}
  Answer tell_version(const Request& request) const;
  Answer arm_event(const Request& request, EventSink& from);
  Answer restart_after_reply(const Request& request);
  Answer reset_to_factory_settings(const Request& request);
  Answer tell_info(const Request& request) const;
  Answer tell_limit(const Request& request) const;
  Answer tell_measured_speed(const Request& request) const;
  Answer reset_board(const Request& request);
  Answer enter_ascii_mode(const Request& request);
  Answer enter_bootloader(const Request& request);
  Answer execute_in_bootloader(const Request& request);

 private:
  ModuleState& module_;
};

}  // namespace tmcl::sim
