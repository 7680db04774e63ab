/// What is the same for all ramp generators: time, and parameters that are registers.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <span>

#include "sim/module/motor.hpp"
#include "sim/module/tick_clock.hpp"
#include "tmcl/ramp/generator.hpp"
#include "tmcl/ramp/passing.hpp"
#include "tmcl/unit_mode.hpp"

namespace tmcl::sim {

template <ramp::Travelling Chip>
class ChipMotor : public Motor {
 public:
  void advance_to(TimePoint time) final { chip_.advance_to(clock_.at(time)); }
  MotionForecast outlook() const final;

  int heading() const final { return chip_.heading(); }
  bool accelerates() const final { return chip_.heading() * chip_.motion().acceleration > 0; }
  std::int32_t position() const final { return static_cast<std::int32_t>(chip_.motion().position); }
  int position_bits() const final { return Chip::position_bits; }
  TimePoint passing(std::int64_t back, std::int64_t ahead) const final;
  TimePoint turning() const final { return time_of(ramp::turning(chip_, clock_.at(never))); }
  TimePoint next_change() final { return time_of({.tick = chip_.next_change()}); }
  void set_switches(bool left, bool right) final { chip_.set_switches(left, right); }

  void set_position(std::int32_t position) final;

  std::optional<std::int32_t> read(const ParameterInfo& row) const override;
  Status write(const ParameterInfo& row, std::int32_t value) override;

  std::int32_t read_chip(std::uint8_t address) final;
  Status write_chip(std::uint8_t address, std::int32_t value) final;

 protected:
  using Register = typename Chip::Register;
  /// An axis parameter that is a register of the chip.
  struct Mapped {
    std::uint8_t number;
    Register name;
  };

  ChipMotor(TimePoint power_on, std::span<const Mapped> mapped, UnitMode units = {})
      : clock_(power_on, static_cast<std::uint64_t>(Chip::ticks_per_second(clock_hz))),
        mapped_(mapped),
        units_(units) {}

  static const ramp::RegisterInfo& range_of(Register name) {
    return Chip::registers()[static_cast<std::size_t>(name)];
  }
  static Register name_of(const ramp::RegisterInfo& info) {
    return static_cast<Register>(&info - Chip::registers().data());
  }

  /// What is to be written to the register for a value in the unit of the moment; nothing if that
  /// is outside its range.
  std::optional<std::int64_t> in_register(Register name, Scale scale, std::int64_t value) const {
    return units_.write(scale, value, range_of(name));
  }
  Status write_register(Register name, Scale scale, std::int64_t value) {
    const auto number = in_register(name, scale, value);
    return number && chip_.write(name, *number) ? Status::ok : Status::invalid_value;
  }
  std::int32_t read_register(Register name, Scale scale) const {
    return units_.read(scale, chip_.read(name));
  }

  /// A register that only the chip writes; nothing for any other.
  virtual std::optional<std::int32_t> chip_reading(std::uint8_t address) = 0;

  Chip& chip() { return chip_; }
  const Chip& chip() const { return chip_; }
  UnitMode& units() { return units_; }
  const UnitMode& units() const { return units_; }

 private:
  /// Of all modules.
  static constexpr double clock_hz = 16e6;
  /// A movement takes some hundreds of changes at most. One that goes to and fro takes any number;
  /// if it comes to an end after all, that is noticed within `patience`.
  static constexpr std::size_t changes_foreseen = 1000;
  static constexpr auto patience = std::chrono::seconds(1);

  TimePoint time_of(const ramp::Passing& passing) const {
    return passing.tick == ramp::forever ? never : clock_.of(passing.tick);
  }

  static std::int64_t value_of(const ramp::RegisterInfo& info, std::uint32_t word) {
    const int spare = 64 - info.bits.count;
    const auto high = std::uint64_t{word} >> info.bits.shift << spare;
    if (info.minimum >= 0) return static_cast<std::int64_t>(high >> spare);
    return static_cast<std::int64_t>(high) >> spare;
  }

  const Mapped* find(std::uint8_t number) const {
    const auto row = std::ranges::find(mapped_, number, &Mapped::number);
    return row == mapped_.end() ? nullptr : &*row;
  }

  Chip chip_;
  TickClock clock_;
  std::span<const Mapped> mapped_;
  UnitMode units_;
  std::map<std::uint8_t, std::uint32_t> words_;  // as they were written
};

template <ramp::Travelling Chip>
MotionForecast ChipMotor<Chip>::outlook() const {
  const auto end_of_time = clock_.at(never);
  const auto ahead = ramp::look_ahead(chip_, end_of_time, changes_foreseen);
  const auto end = clock_.of(ahead.tick());
  if (ahead.arrived()) return {.arrival = end, .rest = end};
  if (ahead.settled()) return {.rest = ahead.heading() == 0 ? end : never};
  if (ahead.tick() >= end_of_time) return {};
  return {.look_again = clock_.of(chip_.tick()) + patience};
}

template <ramp::Travelling Chip>
TimePoint ChipMotor<Chip>::passing(std::int64_t back, std::int64_t ahead) const {
  constexpr auto longest = ramp::longest_way<Chip>;
  return time_of(
      ramp::passing(chip_, std::min(back, longest), std::min(ahead, longest), clock_.at(never)));
}

template <ramp::Travelling Chip>
void ChipMotor<Chip>::set_position(std::int32_t position) {
  for (const auto number : {axis_parameter::target_position, axis_parameter::actual_position})
    chip_.write(find(number)->name, position);
}

template <ramp::Travelling Chip>
std::optional<std::int32_t> ChipMotor<Chip>::read(const ParameterInfo& row) const {
  const auto* mapped = find(row.number);
  if (mapped == nullptr) return std::nullopt;
  return read_register(mapped->name, row.scale);
}

template <ramp::Travelling Chip>
Status ChipMotor<Chip>::write(const ParameterInfo& row, std::int32_t value) {
  const auto* mapped = find(row.number);
  if (mapped != nullptr) return write_register(mapped->name, row.scale, value);
  return units_.accepts(row, value) ? Status::ok : Status::invalid_value;
}

template <ramp::Travelling Chip>
std::int32_t ChipMotor<Chip>::read_chip(std::uint8_t address) {
  if (const auto reading = chip_reading(address)) return *reading;
  const auto kept = words_.find(address);
  auto word = kept == words_.end() ? 0 : kept->second;
  for (const auto& info : Chip::registers()) {
    if (!info.bits.are_at(address)) continue;
    const auto value = chip_.read(name_of(info));
    if (info.minimum < 0) return static_cast<std::int32_t>(value);
    const auto mask = ((std::uint64_t{1} << info.bits.count) - 1) << info.bits.shift;
    const auto bits = static_cast<std::uint64_t>(value) << info.bits.shift & mask;
    word = static_cast<std::uint32_t>((word & ~mask) | bits);
  }
  return static_cast<std::int32_t>(word);
}

template <ramp::Travelling Chip>
Status ChipMotor<Chip>::write_chip(std::uint8_t address, std::int32_t value) {
  // A register of a chip is as long as a position.
  constexpr auto all_bits =
      static_cast<std::uint32_t>((std::uint64_t{1} << Chip::position_bits) - 1);
  const auto word = static_cast<std::uint32_t>(value) & all_bits;
  const auto before = chip_;
  for (const auto& info : Chip::registers()) {
    if (!info.bits.are_at(address)) continue;
    if (chip_.write(name_of(info), value_of(info, word))) continue;
    chip_ = before;
    return Status::invalid_value;
  }
  words_[address] = word;
  return Status::ok;
}

}  // namespace tmcl::sim
