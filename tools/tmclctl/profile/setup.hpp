/// What `profile simulate` is asked for, checked against the registers of the generator.
#pragma once

#include "command_line/options.hpp"
#include "plot/recording.hpp"
#include "profile/generators.hpp"

namespace tmclctl::profile {

/// An axis parameter, and what it is in its register.
struct GivenParameter {
  std::string said;  ///< As it was typed.
  std::string name;
  std::uint8_t number = 0;
  std::int32_t value = 0;
  std::string chip_register;
  std::int64_t held = 0;
  std::optional<double> off{};  ///< By how much of what was asked for it is off.
};

struct Setup {
  const GeneratorInfo& generator;
  double ticks_per_second;  ///< Or in a cycle, as the generator's time_unit says.
  Script script;
  std::vector<GivenParameter> parameters{};  ///< Of a module, as they were given.
  /// What its curves are drawn in, and what the chip counts in; nothing: they are drawn in that.
  std::optional<plot::UserUnit> user{};

  /// Not before which tick this time is.
  Tick tick_at(double time) const;
  double time_of(Tick tick) const { return static_cast<double>(tick) / ticks_per_second; }
};

Result<const GeneratorInfo*> find_generator(std::string_view name);

Result<Setup> read_setup(const verb::Simulate& verb);
/// The same of the parameters of a model.
Result<Setup> read_model_setup(const verb::Simulate& verb);

/// The name, for f_clk as if it were a register, and the clock that most modules have.
constexpr std::string_view clock_name = "f_clk";
constexpr double usual_clock_hz = 16e6;
constexpr double least_clock_hz = 1e5;
constexpr double greatest_clock_hz = 1e8;

}  // namespace tmclctl::profile
