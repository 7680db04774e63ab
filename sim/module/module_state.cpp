#include "sim/module/module_state.hpp"

#include "sim/module/delivered_stage.hpp"
#include "tmcl/ascii.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

// No document at hand says which is which.
constexpr std::int32_t shuts_down_when_high = 1;
constexpr std::int32_t shuts_down_when_low = 2;

}  // namespace

EepromCell axis_cell(std::size_t motor, std::uint8_t number) {
  return {EepromCell::Area::axis_parameter, static_cast<std::uint8_t>(motor), number};
}

ModuleState::ModuleState(const Model& of, Eeprom memory, const Clock& time,
                         const ModuleSettings& made)
    : model(&of),
      clock(&time),
      settings(made),
      now(time.now()),
      deaf_until(now),
      eeprom(std::move(memory)),
      globals(of, eeprom, now),
      io(of),
      coordinates(of, eeprom),
      stages(of.axes, Stage(delivered_stage(of))),
      events(of.axes),
      logger(now),
      bootloader(of.number, delivered_version()) {}

FirmwareVersion ModuleState::delivered_version() const {
  const auto release = settings.firmware.value_or(delivered_firmware(*model));
  return {model->number, release.major, release.minor};
}

void ModuleState::build_axes() {
  axes.clear();
  for (std::size_t motor = 0; motor < model->axes; ++motor) {
    axes.emplace_back(*model, stages[motor], now, settings.traits);
    axes.back().set_supply(io.supply());
  }
  wire_axes();
  for (std::size_t motor = 0; motor < model->axes; ++motor) restore_axis(motor);
}

// The unit mode goes first: what was stored is counted in it. A value that the axis does not take,
// say because it was stored in the other unit, leaves the factory setting.
void ModuleState::restore_axis(std::size_t motor) {
  const auto restore = [&](std::uint8_t number) {
    if (const auto kept = eeprom.read(axis_cell(motor, number))) axes[motor].set(number, *kept);
  };
  restore(axis_parameter::unit_mode);
  for (const auto& row : axis_parameters(*model)) {
    if (row.stored && row.number != axis_parameter::unit_mode) restore(row.number);
  }
}

// A TMCM-6110 has a bit for each half of its motors.
void ModuleState::wire_axes() {
  const auto* row = find_parameter(global_parameters(*model), gp::end_switch_polarity);
  const auto groups = row != nullptr && row->maximum > 1 ? std::size_t{2} : std::size_t{1};
  for (std::size_t motor = 0; motor < axes.size(); ++motor) {
    const auto bit = motor * groups / axes.size();
    axes[motor].reverse_limit_polarity((globals.value(gp::end_switch_polarity) >> bit & 1) != 0);
    axes[motor].reverse_shaft(globals.value(gp::reverse_shaft) == 1);
  }
}

void ModuleState::stop_motor(std::size_t motor) {
  events.move_abandoned(motor);
  axes[motor].stop();
}

void ModuleState::stop_all_motors() {
  for (std::size_t motor = 0; motor < axes.size(); ++motor) stop_motor(motor);
}

// Facts are few: the numbers of the parameter, and that motors with the same one move together. So
// each does what the command says, and 0, with which all begin, makes no group.
std::uint32_t ModuleState::companions(std::size_t motor) const {
  const auto group = axes[motor].group();
  std::uint32_t motors = 1U << motor;
  for (std::size_t other = 0; group != 0 && other < axes.size(); ++other) {
    if (axes[other].group() == group) motors |= 1U << other;
  }
  return motors;
}

// For as long as it is met, no motor goes on.
bool ModuleState::shut_down() const {
  switch (globals.value(gp::shutdown_pin_function)) {
    case shuts_down_when_high: return shutdown_input == true;
    case shuts_down_when_low: return shutdown_input == false;
    default: return false;
  }
}

// Above Z there is no letter that could bring it back.
bool ModuleState::has_letter() const {
  return ascii::letter_of(globals.byte(global_parameter::serial_address)).has_value();
}

// As the manual of the TMCM-142 has it, these modules leave no choice.
bool ModuleState::keeps_coordinates() const {
  return model->family == Family::tmc457 ||
         globals.value(global_parameter::coordinate_storage) == 1;
}

}  // namespace tmcl::sim
