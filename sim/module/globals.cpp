#include "sim/module/globals.hpp"

#include <limits>

#include "tmcl/parameter.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

constexpr std::int32_t code_to_lock = 1234;
constexpr std::int32_t code_to_unlock = 4321;

// A number that none has stands for models without such an address.
std::uint8_t secondary_address_parameter(const Model& model) {
  constexpr std::uint8_t no_parameter = 0;
  const auto* row = find_parameter(global_parameters(model), "serial_secondary_address");
  return row == nullptr ? no_parameter : row->number;
}

EepromCell cell(std::uint8_t bank, std::uint8_t number) {
  return {EepromCell::Area::global_parameter, bank, number};
}

}  // namespace

Globals::Globals(const Model& model, Eeprom& eeprom, TimePoint start)
    : model_(&model),
      eeprom_(&eeprom),
      timer_zero_(start),
      random_(model.number),
      secondary_address_number_(secondary_address_parameter(model)) {
  load_addresses();
  for (const auto& row : global_parameters(model)) {
    load(parameter_bank, row.number, row.stored, row.initial);
  }
  for (int number = 0; number < 256; ++number) {
    const auto n = static_cast<std::uint8_t>(number);
    const auto row = global_range(model, interrupt_bank, n);
    if (row) load(interrupt_bank, n, row->stored, row->initial);
  }
  if (value(gp::zero_user_variables) != 0) return;
  for (std::uint8_t n = 0; n < kept_user_variables; ++n) load(variable_bank, n, true, 0);
}

// Every module can be put on every line here, even where its model has no such parameter.
void Globals::load_addresses() {
  const auto load_or = [&](std::uint8_t number, std::int32_t factory_setting) {
    values_[number] = eeprom_->read(cell(parameter_bank, number)).value_or(factory_setting);
  };
  load_or(gp::serial_address, 1);
  load_or(gp::serial_host_address, 2);
  load_or(gp::can_id, 1);
  load_or(gp::can_reply_id, 2);
}

void Globals::load(std::uint8_t bank, std::uint8_t number, bool stored, std::int32_t initial) {
  const auto kept = stored ? eeprom_->read(cell(bank, number)) : std::nullopt;
  values_of(bank)[number] = kept.value_or(initial);
}

void Globals::keep(std::uint8_t bank, std::uint8_t number) {
  eeprom_->write(cell(bank, number), values_of(bank)[number]);
}

Globals::Values& Globals::values_of(std::uint8_t bank) {
  if (bank == variable_bank) return variables_;
  return bank == interrupt_bank ? interrupts_ : values_;
}

// An unknown bank is told from an unknown number by what bank 0 has.
tl::expected<GlobalRange, Status> Globals::find(std::uint8_t bank, std::uint8_t number) const {
  if (const auto range = global_range(*model_, bank, number)) return *range;
  const bool known_bank = bank == parameter_bank || bank == interrupt_bank;
  const bool known_number = global_range(*model_, parameter_bank, number).has_value();
  return tl::unexpected(!known_bank && known_number ? Status::invalid_value : Status::wrong_type);
}

tl::expected<std::int32_t, Status> Globals::get(std::uint8_t bank, std::uint8_t number,
                                                TimePoint now) {
  const auto row = find(bank, number);
  if (!row) return tl::unexpected(row.error());
  if (bank == parameter_bank && number == gp::tick_timer) return tick_timer(now);
  if (bank == parameter_bank && number == gp::random_number) return next_random_number();
  return values_of(bank)[number];
}

Status Globals::set(std::uint8_t bank, std::uint8_t number, std::int32_t value, TimePoint now) {
  const auto row = find(bank, number);
  if (!row) return row.error();
  if (row->access == Access::read) return Status::wrong_type;
  const bool of_module = bank == parameter_bank;
  if (of_module && number == gp::eeprom_lock) return lock(value);
  if (value < row->minimum || value > row->maximum) return Status::invalid_value;
  const bool keeps = of_module && row->stored;
  if (keeps && eeprom_locked()) return Status::eeprom_locked;
  values_of(bank)[number] = value;
  if (keeps) keep(bank, number);
  if (of_module && number == gp::tick_timer) timer_zero_ = now - std::chrono::milliseconds(value);
  return Status::ok;
}

Status Globals::store(std::uint8_t bank, std::uint8_t number) {
  const auto row = find(bank, number);
  if (!row) return row.error();
  if (!row->stored) return Status::wrong_type;
  if (eeprom_locked()) return Status::eeprom_locked;
  keep(bank, number);
  return Status::ok;
}

Status Globals::restore(std::uint8_t bank, std::uint8_t number) {
  const auto row = find(bank, number);
  if (!row) return row.error();
  if (!row->stored) return Status::wrong_type;
  load(bank, number, row->stored, row->initial);
  return Status::ok;
}

bool Globals::eeprom_locked() const { return value(gp::eeprom_lock) != 0; }

// The lock itself is kept in the EEPROM, and is the one thing that can be written while it is on.
Status Globals::lock(std::int32_t code) {
  if (code != code_to_lock && code != code_to_unlock) return Status::invalid_value;
  values_[gp::eeprom_lock] = code == code_to_lock ? 1 : 0;
  keep(parameter_bank, gp::eeprom_lock);
  return Status::ok;
}

std::int32_t Globals::tick_timer(TimePoint now) const {
  const auto passed =
      std::chrono::duration_cast<std::chrono::milliseconds>(now - timer_zero_).count();
  return static_cast<std::int32_t>(passed & INT32_MAX);
}

std::int32_t Globals::next_random_number() {
  return std::uniform_int_distribution<std::int32_t>(
      0, std::numeric_limits<std::int32_t>::max())(random_);
}

}  // namespace tmcl::sim
