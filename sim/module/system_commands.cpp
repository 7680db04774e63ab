// Commands about the module itself.
#include "sim/module/command_groups.hpp"

namespace tmcl::sim {
namespace {

constexpr std::uint8_t event_once = 0;
constexpr std::uint8_t event_always = 1;
/// The value that makes sure that a reset is meant.
constexpr std::int32_t reset_code = 1234;

namespace info {
constexpr std::uint8_t module_number = 0;
constexpr std::uint8_t version = 1;
constexpr std::uint8_t abilities = 2;
constexpr std::uint8_t release = 3;
constexpr std::uint8_t bootloader_module = 10;
constexpr std::uint8_t bootloader_version = 11;
constexpr std::uint8_t axis_parameter_bits = 20;
constexpr std::uint8_t register_address_bits = 21;
constexpr std::uint8_t source_revision = 30;
}  // namespace info

constexpr std::int32_t has_bootloader = 1;
constexpr std::int32_t has_programs = 2;
constexpr std::int32_t public_release = 0;
constexpr std::int32_t unknown_revision = 0;

constexpr std::int32_t two_halves(std::int32_t high, std::int32_t low) { return high << 16 | low; }

}  // namespace

Answer SystemCommands::tell_version(const Request& request) const {
  switch (static_cast<VersionForm>(request.type)) {
    case VersionForm::text: return {Answer::Form::version_text, Status::ok, 0};
    case VersionForm::binary: return {Answer::Form::reply, Status::ok, to_value(module_.version())};
  }
  return echo(request, Status::wrong_type);
}

Answer SystemCommands::arm_event(const Request& request, EventSink& from) {
  if (request.type != event_once && request.type != event_always) {
    return echo(request, Status::wrong_type);
  }
  const auto motors = static_cast<std::uint32_t>(request.value);
  if (motors >> module_.axes.size() != 0) return echo(request, Status::invalid_value);
  if (request.type == event_once) {
    module_.events.arm_once(motors, from);
  } else {
    module_.events.arm_always(motors, from);
  }
  return echo(request);
}

Answer SystemCommands::restart_after_reply(const Request& request) {
  if (request.value != reset_code) return echo(request, module_.wrong_code(Status::invalid_value));
  module_.restarts = true;
  return echo(request);
}

Answer SystemCommands::reset_to_factory_settings(const Request& request) {
  if (request.value != reset_code) return echo(request, Status::invalid_value);
  if (module_.globals.eeprom_locked()) return echo(request, Status::eeprom_locked);
  module_.eeprom.erase();
  module_.restarts = true;
  return no_answer;
}

// Which types there are, and how their values are put together, is what PyTrinamic expects.
Answer SystemCommands::tell_info(const Request& request) const {
  const auto firmware = module_.version();
  const auto is = [](std::int32_t value) { return Answer{Answer::Form::reply, Status::ok, value}; };
  switch (request.type) {
    case info::module_number:
    case info::bootloader_module: return is(firmware.model);
    case info::version: return is(two_halves(firmware.major, firmware.minor));
    case info::abilities: return is(has_bootloader | has_programs);
    case info::release: return is(public_release);
    case info::bootloader_version:
      return is(two_halves(module_.bootloader.version().major, module_.bootloader.version().minor));
    case info::axis_parameter_bits:
    case info::register_address_bits: return is(8);
    case info::source_revision: return is(unknown_revision);
    default: return reading(tl::unexpected(Status::wrong_type));
  }
}

Answer SystemCommands::tell_limit(const Request& request) const {
  const auto* row = find_parameter(axis_parameters(*module_.model), request.type);
  if (row == nullptr) return reading(tl::unexpected(Status::wrong_type));
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  return reading(request.command == Command::GET_AP_MIN ? row->minimum : row->maximum);
}

Answer SystemCommands::tell_measured_speed(const Request& request) const {
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  return reading(module_.axes[request.motor].get(axis_parameter::actual_velocity));
}

// The evaluation boards' firmware, the only source of this command, resets the chips: motors stop
// dead and have the parameters they start with.
Answer SystemCommands::reset_board(const Request& request) {
  for (std::size_t motor = 0; motor < module_.axes.size(); ++motor)
    module_.events.move_abandoned(motor);
  module_.build_axes();
  return echo(request);
}

}  // namespace tmcl::sim
