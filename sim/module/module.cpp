#include "sim/module/module.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/module/delivered_stage.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

// Far more than a module has to do at one instant.
constexpr unsigned most_rounds_at_once = 10'000;
constexpr std::int32_t eeprom_is_valid = 228;
constexpr std::int32_t no_board_error = 0;
constexpr std::int32_t ascii_at_start = 1;

EepromCell global_cell(std::uint8_t number) {
  return {EepromCell::Area::global_parameter, Globals::parameter_bank, number};
}

Eeprom delivered(ModuleAddress address) {
  Eeprom eeprom;
  eeprom.preset(global_cell(gp::serial_address), reply_byte(address));
  eeprom.preset(global_cell(gp::can_id), number(address));
  return eeprom;
}

/// Of what a module does not execute for a host.
Status refusal_of(Command command) {
  const auto* row = find_command(static_cast<std::uint8_t>(command));
  const bool only_in_programs = row != nullptr && row->operands && !is_direct(command);
  return only_in_programs ? Status::command_not_available : Status::invalid_command;
}

}  // namespace

Module::Module(const Model& model, ModuleAddress address, const Clock& clock,
               const ModuleSettings& settings)
    : Module(model, delivered(address), clock, settings) {}

Module::Module(const Model& model, Eeprom eeprom, const Clock& clock,
               const ModuleSettings& settings)
    : model_(&model),
      clock_(&clock),
      settings_(settings),
      now_(clock.now()),
      deaf_until_(now_),
      eeprom_(std::move(eeprom)),
      globals_(model, eeprom_, now_),
      io_(model),
      coordinates_(model, eeprom_),
      stages_(model.axes, Stage(delivered_stage(model))),
      events_(model.axes),
      logger_(now_),
      bootloader_(model.number, delivered_version()) {
  power_up();
}

FirmwareVersion Module::delivered_version() const {
  const auto release = settings_.firmware.value_or(delivered_firmware(*model_));
  return {model_->number, release.major, release.minor};
}

void Module::power_up() {
  in_bootloader_ = std::exchange(bootloader_wanted_, false) || !bootloader_.has_firmware();
  firmware_ = bootloader_.firmware_version(delivered_version());
  const auto magic = eeprom_.read(global_cell(gp::eeprom_magic)).value_or(eeprom_is_valid);
  if (magic != eeprom_is_valid) eeprom_.erase();
  globals_ = Globals(*model_, eeprom_, now_);
  const bool wants_ascii = (globals_.value(gp::ascii_mode) & ascii_at_start) != 0;
  in_ascii_mode_ = wants_ascii && has_letter() && !in_bootloader_;
  io_.reset();
  coordinates_ = Coordinates(*model_, eeprom_);
  if (keeps_coordinates()) coordinates_.load_all(0);
  build_axes();
  events_ = TargetEvents(model_->axes);
  logger_ = DataLogger(now_);
  start_application();
  serial_.heard(now_);
  can_.heard(now_);
}

void Module::build_axes() {
  axes_.clear();
  axes_.reserve(model_->axes);
  for (std::size_t motor = 0; motor < model_->axes; ++motor) {
    axes_.emplace_back(*model_, stages_[motor], now_, settings_.traits);
    axes_.back().set_supply(io_.supply());
  }
  wire_axes();
  for (std::size_t motor = 0; motor < model_->axes; ++motor) restore_axis(motor);
}

void Module::restart() {
  restarts_ = false;
  deaf_until_ = now_ + boot_time;
  power_up();
}

void Module::power_cycle() {
  run_due();
  bootloader_wanted_ = false;
  restart();
  run_application();
}

void Module::power_off() {
  run_due();
  bootloader_wanted_ = false;
  restart();
  application_.power_on(false, now_);
  deaf_until_ = TimePoint::max();
}

Answer Module::execute(const Request& request, Medium medium, EventSink& from) {
  run_due();
  if (!hears()) return no_answer;
  heartbeat(medium).heard(now_);
  auto answer = in_bootloader_ ? execute_in_bootloader(request) : execute_direct(request, from);
  const bool reads = effect_of(request.command, request.type) == Effect::reads;
  const bool suppressed = globals_.value(gp::suppress_reply) != 0 && !in_bootloader_;
  if (suppressed && !reads) answer = no_answer;
  if (restarts_) restart();
  run_application();
  return answer;
}

Answer Module::execute_direct(const Request& request, EventSink& from) {
  if (application_.in_download() && request.command < Command::STOP_APPLICATION)
    return application_.record(request);
  if (Application::is_control(request.command)) return control_application(request);
  if (is_direct_calculation(request.command)) return application_.execute_directly(request, now_);
  switch (request.command) {
    case Command::GET_FIRMWARE_VERSION: return tell_version(request);
    case Command::TARGET_REACHED_EVENT: return arm_event(request, from);
    case Command::FACTORY_RESET: return reset_to_factory_settings(request);
    case Command::SECURITY_CODE: return echo(request);  // nothing here is hidden without it
    case Command::WRITE_MC:
    case Command::READ_MC: return access_controller(request);
    case Command::WRITE_DRV:
    case Command::READ_DRV: return access_driver(request);
    case Command::MEASURED_SPEED: return tell_measured_speed(request);
    case Command::BOARD_ERROR: return reading(no_board_error);
    case Command::BOARD_RESET: return reset_board(request);
    case Command::GET_INFO: return tell_info(request);
    case Command::GET_AP_MIN:
    case Command::GET_AP_MAX: return tell_limit(request);
    case Command::SOFTWARE_RESET: return restart_after_reply(request);
    case Command::ENTER_ASCII_MODE: return enter_ascii_mode(request);
    case Command::ENTER_BOOTLOADER: return enter_bootloader(request);
    case Command::RAM_DEBUG: return access_data_logger(request);
    // Known, but only to firmware for special boards or customers.
    case Command::GET_IDS:
    case Command::WRITE_USER_CHANNEL:
    case Command::READ_USER_CHANNEL: return echo(request, Status::command_not_available);
    default: return perform(request);
  }
}

Answer Module::perform(const Request& request) {
  switch (request.command) {
    case Command::ROR: return rotate(request, 1);
    case Command::ROL: return rotate(request, -1);
    case Command::MST: return stop(request);
    case Command::MVP: return move(request);
    case Command::RFS: return search(request);
    case Command::SAP: return set_axis_parameter(request);
    case Command::GAP: return get_axis_parameter(request);
    case Command::STAP: return store_axis_parameter(request);
    case Command::RSAP: return restore_axis_parameter(request);
    case Command::SGP: return set_global_parameter(request);
    case Command::GGP: return get_global_parameter(request);
    case Command::STGP: return store_global_parameter(request);
    case Command::RSGP: return restore_global_parameter(request);
    case Command::SIO: return set_output(request);
    case Command::GIO: return get_input(request);
    case Command::SCO: return set_coordinate(request);
    case Command::GCO: return get_coordinate(request);
    case Command::CCO: return capture_coordinate(request);
    case Command::SAC:
    case Command::UF0:
    case Command::UF1:
    case Command::UF2:
    case Command::UF3:
    case Command::UF4:
    case Command::UF5:
    case Command::UF6:
    case Command::UF7: return echo(request, Status::command_not_available);
    default: return echo(request, refusal_of(request.command));
  }
}

TimePoint Module::serial_due() const {
  if (ignores_silence()) return never;
  return serial_.due(globals_.milliseconds(gp::serial_heartbeat));
}

TimePoint Module::can_due() const {
  if (ignores_silence()) return never;
  return can_.due(globals_.milliseconds(gp::can_heartbeat));
}

bool Module::ignores_silence() const {
  return settings_.traits.get<tmcl::Heartbeat>(Trait::heartbeat, *model_) ==
         tmcl::Heartbeat::ignored;
}

void Module::stop_if_silent() {
  const bool serial_silent = serial_due() <= now_;
  const bool can_silent = can_due() <= now_;
  if (serial_silent) serial_.expire();
  if (can_silent) can_.expire();
  if (serial_silent || can_silent) stop_all_motors();
}

TimePoint Module::next_due() const {
  auto due = std::min({serial_due(), can_due(), events_.next_due(axes_), logger_.next_due(),
                       application_.next_due(), supply_returns_});
  for (const auto& axis : axes_) due = std::min(due, axis.next_due());
  return due;
}

// Each thing that is due leaves with a later time, or none, when it is due next.
void Module::run_due() {
  const auto present = clock_->now();
  auto latest = TimePoint::min();
  unsigned rounds_at_once = 0;
  for (auto due = next_due(); due <= present; due = next_due()) {
    rounds_at_once = due > latest ? 0 : rounds_at_once + 1;
    if (rounds_at_once > most_rounds_at_once)
      throw std::logic_error("a module has something to do at one instant for ever");
    latest = std::max(latest, due);
    bring_to(due);
    run_what_is_due_now();
  }
  bring_to(present);
}

void Module::mount(std::size_t motor, const StageSettings& settings) {
  at_stage(motor, [&](Stage& stage) { stage = Stage(settings); });
}

void Module::at_stage(std::size_t motor, const std::function<void(Stage&)>& change) {
  run_due();
  change(stages_.at(motor));
  axes_.at(motor).stage_changed();
  run_application();
}

void Module::run_application() {
  application_.run_due(now_);
  if (shut_down()) stop_all_motors();
}

void Module::bring_to(TimePoint time) {
  now_ = std::max(now_, time);
  for (auto& axis : axes_) axis.advance_to(now_);
}

void Module::run_what_is_due_now() {
  stop_if_silent();
  end_brown_out();
  for (auto& axis : axes_) axis.run_due();
  events_.run_due(now_, axes_, *this);
  logger_.run_due(now_, data_logger_probe());
  run_application();
}

}  // namespace tmcl::sim
