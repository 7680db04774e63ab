/// What can be asked of a module as a whole, apart from its axes.
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/datagram.hpp"
#include "tmcl/script.hpp"

namespace tmcl {

/// The banks of SIO and GIO.
enum class IoBank : std::uint8_t {
  digital_inputs = 0,   ///< 0 or 1; port 255: all of them, a bit each.
  analog_inputs = 1,    ///< As the converter gives it; some ports are temperatures or voltages.
  digital_outputs = 2,  ///< The only bank that can be written.
};

/// What GET_INFO says of a module's firmware; nothing where the module does not know the question.
struct FirmwareInfo {
  std::optional<std::int32_t> module_id;
  std::optional<std::int32_t> version;
  /// 1 bootloader, 2 stand-alone programs, 4 CANopen, 8 EtherCAT, 16 IO-Link
  std::optional<std::int32_t> capabilities;
  std::optional<std::int32_t> release_type;
  std::optional<std::int32_t> bootloader_id;
  std::optional<std::int32_t> bootloader_version;
  std::optional<std::int32_t> axis_parameter_width;
  std::optional<std::int32_t> register_address_width;
  std::optional<std::int32_t> git_hash;
};

/// When a module sends the event that a target was reached.
enum class ArrivalEvents : std::uint8_t {
  next_move = 0,
  every_move = 1,
};

namespace verbs {

/// Copies a global parameter to the EEPROM (STGP). Outcome::unknown when the answer is lost: it may
/// be stored.
Script<Result<void>> store_global(ModuleAddress module, std::uint8_t bank, std::uint8_t parameter);
/// And back (RSGP).
Script<Result<void>> restore_global(ModuleAddress module, std::uint8_t bank,
                                    std::uint8_t parameter);

/// Reads a port (GIO).
Script<Result<std::int32_t>> get_io(ModuleAddress module, IoBank bank, std::uint8_t port);
/// Sets a digital output (SIO). When the answer is lost, reading it back settles whether it was
/// set.
Script<Result<void>> set_output(ModuleAddress module, std::uint8_t port, std::int32_t value);

/// Asks for everything that GET_INFO knows. Errors: those of the exchanges, but not a refusal.
Script<Result<FirmwareInfo>> firmware_info(ModuleAddress module);

/// Asks for an event when targets are reached (TARGET_REACHED_EVENT). `motors`: bit n is motor n;
/// old firmware of modules with one motor takes 0 or 1 alike.
Script<Result<void>> request_arrival_events(ModuleAddress module, ArrivalEvents events,
                                            std::int32_t motors);

/// Restarts the module (SOFTWARE_RESET). It answers first, and is silent for a while then.
Script<Result<void>> reset_module(ModuleAddress module);
/// Everything stored in the module goes back to how it was delivered, its address too
/// (FACTORY_RESET); done when it is on the wire: there is no answer.
Script<Result<void>> factory_reset(ModuleAddress module);

}  // namespace verbs
}  // namespace tmcl
