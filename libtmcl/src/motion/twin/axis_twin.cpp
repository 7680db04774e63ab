#include "tmcl/plan/axis_twin.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "tmcl/conversion.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/quantity.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;
using ramp::SixPoint;
using ramp::Tick;
using ramp::Tmc429;
using ramp::Tmc457;

constexpr double clock_hz = 16e6;  // of all modules
constexpr std::int64_t second = 1'000'000'000;
// A movement has some hundreds of them. What has more goes to and fro; a prediction that takes
// longer than a few milliseconds would hold up its caller.
constexpr std::size_t most_changes = 10'000;

template <class Chip>
Tick ticks_per_second() {
  return static_cast<Tick>(Chip::ticks_per_second(clock_hz));
}

// The last tick that is not after this time, and when a tick is, to the nanosecond after it.
template <class Chip>
Tick ticks_in(Duration time) {
  const auto count = static_cast<Tick>(time.count());
  return count / second * ticks_per_second<Chip>() +
         count % second * ticks_per_second<Chip>() / second;
}
template <class Chip>
Duration time_of(Tick ticks) {
  const auto per_second = ticks_per_second<Chip>();
  const auto rest = (ticks % per_second * second + per_second - 1) / per_second;
  return Duration(ticks / per_second * second + rest);
}

// ---- which register holds an axis parameter ----

template <class Chip>
struct Mapped {
  std::uint8_t parameter;
  typename Chip::Register name;
};

using R429 = Tmc429::Register;
constexpr std::array<Mapped<Tmc429>, 5> tmc429_map{{{ap::max_velocity, R429::v_max},
                                                    {ap::max_acceleration, R429::a_max},
                                                    {number_of("minimum_velocity"), R429::v_min},
                                                    {number_of("ramp_divisor"), R429::ramp_div},
                                                    {number_of("pulse_divisor"), R429::pulse_div}}};
using R457 = Tmc457::Register;
constexpr std::array<Mapped<Tmc457>, 5> tmc457_map{{{ap::max_velocity, R457::v_max},
                                                    {ap::max_acceleration, R457::a_max_d_max},
                                                    {number_of("acceleration"), R457::a_max},
                                                    {number_of("max_deceleration"), R457::d_max},
                                                    {number_of("max_bow"), R457::bow_max}}};
using R6 = SixPoint::Register;
constexpr std::array<Mapped<SixPoint>, 9> sixpoint_map{
    {{ap::max_velocity, R6::vmax},
     {ap::max_acceleration, R6::amax},
     {number_of("acceleration_a1"), R6::a1},
     {number_of("velocity_v1"), R6::v1},
     {number_of("max_deceleration"), R6::dmax},
     {number_of("deceleration_d1"), R6::d1},
     {number_of(Family::sixpoint, "start_velocity"), R6::vstart},
     {number_of("stop_velocity"), R6::vstop},
     {number_of("ramp_wait_time"), R6::tzerowait}}};

constexpr std::span<const Mapped<Tmc429>> map_of(const Tmc429&) { return tmc429_map; }
constexpr std::span<const Mapped<Tmc457>> map_of(const Tmc457&) { return tmc457_map; }
constexpr std::span<const Mapped<SixPoint>> map_of(const SixPoint&) { return sixpoint_map; }

template <class Chip>
const ramp::RegisterInfo& info_of(const Chip&, typename Chip::Register name) {
  return Chip::registers()[static_cast<std::size_t>(name)];
}

// ---- what the firmware does with the registers ----

std::int64_t wrapped(std::int64_t position) {
  constexpr std::int64_t turn = 1 << Tmc429::position_bits;
  return ((position + turn / 2) & (turn - 1)) - turn / 2;
}

void move(Tmc429& chip, std::int32_t target, std::int64_t top_speed) {
  chip.write(R429::v_max, top_speed);
  chip.write(R429::x_target, wrapped(target));
  chip.write(Tmc429::Mode::ramp);
}
void move(Tmc457& chip, std::int32_t target, std::int64_t top_speed) {
  chip.write(R457::v_max, top_speed);
  chip.write(R457::x_target, target);
  chip.write(Tmc457::Mode::position);
}
void move(SixPoint& chip, std::int32_t target, std::int64_t top_speed) {
  chip.write(R6::vmax, top_speed);
  chip.write(R6::xtarget, target);
  chip.write(SixPoint::Mode::position);
}

bool turn(Tmc429& chip, std::int64_t velocity) {
  chip.write(Tmc429::Mode::velocity);
  chip.write(R429::v_max, info_of(chip, R429::v_max).maximum);
  return chip.write(R429::v_target, velocity).has_value();
}
bool turn(Tmc457& chip, std::int64_t velocity) {
  if (!chip.write(R457::v_target, velocity)) return false;
  chip.write(Tmc457::Mode::velocity);
  return true;
}
bool turn(SixPoint& chip, std::int64_t velocity) {
  if (!chip.write(R6::vmax, std::abs(velocity))) return false;
  chip.write(velocity < 0 ? SixPoint::Mode::velocity_negative : SixPoint::Mode::velocity_positive);
  return true;
}

// A motor at this speed. A sixPoint chip has no register to write a speed to, so it is run up.
void bring_to_speed(Tmc429& chip, std::int64_t velocity) {
  chip.write(Tmc429::Mode::hold);
  chip.write(R429::v_actual, velocity);
}
void bring_to_speed(Tmc457& chip, std::int64_t velocity) {
  chip.write(Tmc457::Mode::hold);
  chip.write(R457::v_target, velocity);
  chip.next_change();
}
void bring_to_speed(SixPoint& chip, std::int64_t velocity) {
  const auto amax = chip.read(R6::amax);
  const auto v1 = chip.read(R6::v1);
  chip.write(R6::amax, info_of(chip, R6::amax).maximum);
  chip.write(R6::v1, 0);
  turn(chip, velocity);
  const auto there = ramp::look_ahead(chip, ramp::last_tick).tick();
  chip.advance_to(std::max(there, chip.tick() + 1));
  chip.write(R6::amax, amax);
  chip.write(R6::v1, v1);
}

void call_position(Tmc429& chip, std::int32_t position) {
  chip.write(R429::x_actual, wrapped(position));
}
void call_position(Tmc457& chip, std::int32_t position) { chip.write(R457::x_actual, position); }
void call_position(SixPoint& chip, std::int32_t position) { chip.write(R6::xactual, position); }

// What one unit of velocity and of acceleration of the chip's is.
ModuleUnits chip_units(const Tmc429& chip) { return module_units(chip.dividers()); }
ModuleUnits chip_units(RegisterUnit velocity, RegisterUnit acceleration) {
  const auto real = [](RegisterUnit unit) {
    return static_cast<double>(unit.numerator) / static_cast<double>(unit.denominator);
  };
  return {{real(velocity)}, {real(acceleration)}};
}
ModuleUnits chip_units(const Tmc457&) {
  return chip_units(tmc457_velocity_unit, tmc457_acceleration_unit);
}
ModuleUnits chip_units(const SixPoint&) {
  return chip_units(sixpoint_velocity_unit, sixpoint_acceleration_unit);
}

bool starts_in_pps(const Model& model) {
  const auto* row = find_parameter(axis_parameters(model), ap::unit_mode);
  return row == nullptr || row->initial == 1;
}

}  // namespace

AxisTwin::AxisTwin(const Model& model, Chip chip, UnitMode units)
    : model_(&model), chip_(chip), units_(units) {
  for (const auto parameter : parameters(model))
    set({parameter, find_parameter(axis_parameters(model), parameter)->initial});
}

std::optional<AxisTwin> AxisTwin::of(const Model& model) {
  const bool pps = starts_in_pps(model);
  switch (model.family) {
    case Family::tmc429: return AxisTwin(model, Tmc429{}, {});
    case Family::tmc457:
      return AxisTwin(model, Tmc457{}, {tmc457_velocity_unit, tmc457_acceleration_unit, pps});
    case Family::sixpoint:
      return AxisTwin(model, SixPoint{}, {sixpoint_velocity_unit, sixpoint_acceleration_unit, pps});
    case Family::tmc4361:
    case Family::firmware: return std::nullopt;
  }
  return std::nullopt;
}

// The unit mode comes first: it says what the others mean. On a TMC457, 5 is another way to write
// 16 and 17.
std::vector<std::uint8_t> AxisTwin::parameters(const Model& model) {
  std::vector<std::uint8_t> numbers;
  const auto add = [&](std::uint8_t number) {
    if (find_parameter(axis_parameters(model), number) != nullptr) numbers.push_back(number);
  };
  const auto add_all = [&](const auto& map) {
    for (const auto& mapped : map) add(mapped.parameter);
  };
  if (model.family == Family::sixpoint || model.family == Family::tmc457) add(ap::unit_mode);
  if (model.family == Family::sixpoint) add_all(sixpoint_map);
  if (model.family == Family::tmc429) add_all(tmc429_map);
  if (model.family == Family::tmc457) {
    for (const auto number : {ap::max_velocity, number_of("acceleration"),
                              number_of("max_deceleration"), number_of("max_bow")})
      add(number);
  }
  return numbers;
}

void AxisTwin::take_traits(const ModuleTraits& traits) {
  if (auto* chip = std::get_if<Tmc429>(&chip_)) tmcl::take_traits(*chip, traits);
}

bool AxisTwin::set(Setting setting) {
  const auto* row = find_parameter(axis_parameters(*model_), setting.parameter);
  return row != nullptr && units_.accepts(*row, setting.value) && take(*row, setting.value);
}

bool AxisTwin::set(std::span<const Setting> settings) {
  return std::ranges::all_of(settings, [&](Setting setting) { return set(setting); });
}

bool AxisTwin::take(const ParameterInfo& row, std::int32_t value) {
  if (row.number == ap::unit_mode) {
    units_.set(value == 1);
    return true;
  }
  return std::visit(
      [&](auto& chip) {
        const auto map = map_of(chip);
        const auto found =
            std::ranges::find(map, row.number, [](const auto& mapped) { return mapped.parameter; });
        if (found == map.end()) return true;
        const auto number = units_.write(row.scale, value, info_of(chip, found->name));
        if (!number || !chip.write(found->name, *number)) return false;
        if (row.number == ap::max_velocity) top_speed_ = *number;
        return true;
      },
      chip_);
}

void AxisTwin::place(Microsteps position, InternalVelocity velocity) {
  std::visit(
      [&](auto& chip) {
        const auto before = chip.tick();
        bring_to_speed(chip, units_.in_register(Scale::velocity, velocity.value));
        call_position(chip, position.value);
        origin_ += chip.tick() - before;
      },
      chip_);
}

void AxisTwin::move_to(Microsteps target) {
  std::visit([&](auto& chip) { move(chip, target.value, top_speed_); }, chip_);
}

bool AxisTwin::rotate(InternalVelocity velocity) {
  return std::visit(
      [&](auto& chip) { return turn(chip, units_.in_register(Scale::velocity, velocity.value)); },
      chip_);
}

void AxisTwin::stop() {
  std::visit([](auto& chip) { turn(chip, 0); }, chip_);
}

void AxisTwin::advance(Duration by) {
  elapsed_ += by;
  std::visit(
      [&](auto& chip) {
        using G = std::remove_reference_t<decltype(chip)>;
        chip.advance_to(origin_ + ticks_in<G>(elapsed_));
      },
      chip_);
}

AxisMotion AxisTwin::motion() const {
  return std::visit(
      [](const auto& chip) {
        const auto motion = chip.motion();
        const auto units = chip_units(chip);
        return AxisMotion{{static_cast<std::int32_t>(motion.position)},
                          {static_cast<double>(motion.velocity) * units.velocity.value},
                          {static_cast<double>(motion.acceleration) * units.acceleration.value}};
      },
      chip_);
}

std::optional<Duration> AxisTwin::time_to_arrival(Duration limit) const {
  return std::visit(
      [&](const auto& chip) -> std::optional<Duration> {
        using G = std::remove_cvref_t<decltype(chip)>;
        const auto end = origin_ + ticks_in<G>(elapsed_ + limit);
        const auto ahead = ramp::look_ahead(chip, end, most_changes);
        if (!ahead.arrived()) return std::nullopt;
        return std::max(time_of<G>(ahead.tick() - origin_) - elapsed_, Duration{});
      },
      chip_);
}

namespace {

/// How a register is called where a user sees it as an axis parameter.
template <class Chip>
class ParameterNames {
 public:
  ParameterNames(const Model& model, const Chip& chip, const UnitMode& units,
                 std::span<const Setting> written, const std::optional<UserScale>& scale)
      : chip_(chip), unit_mode_(units), written_(written) {
    axis_.model = &model;
    axis_.module = units.in_pps() ? ModuleUnits{} : chip_units(chip);
    if (scale && !scale->unit.empty()) axis_.scale = scale;
  }

  std::string operator()(const ramp::Finding::Mention& mention) const {
    using Form = ramp::Finding::Form;
    const auto* row = row_of(static_cast<typename Chip::Register>(mention.index));
    if (row == nullptr) return in_register(mention);
    const std::string name(row->name);
    if (mention.form == Form::name) return name;
    if (mention.form == Form::value)
      return text_of(unit_mode_.read(row->scale, mention.value), *row, {});
    const auto value = value_of(*row, mention);
    const bool vanishes = value != 0 && mention.value == 0;
    return name + " " + text_of(value, *row, vanishes ? "0 in the chip" : "");
  }

 private:
  const ParameterInfo* row_of(typename Chip::Register name) const {
    const auto map = map_of(chip_);
    const auto mapped = std::ranges::find(map, name, &Mapped<Chip>::name);
    return mapped == map.end() ? nullptr : find_parameter(axis_.parameters(), mapped->parameter);
  }

  static std::string in_register(const ramp::Finding::Mention& mention) {
    return describe(ramp::Finding{"{}", {mention}}, Chip::registers());
  }

  std::int32_t value_of(const ParameterInfo& row, const ramp::Finding::Mention& mention) const {
    const auto written = std::ranges::find(written_, row.number, &Setting::parameter);
    const bool is_it = written != written_.end() &&
                       unit_mode_.in_register(row.scale, written->value) == mention.value;
    return is_it ? written->value : unit_mode_.read(row.scale, mention.value);
  }

  /// Such as "40960 pps (4 mm/s)".
  std::string text_of(std::int32_t value, const ParameterInfo& row, std::string remark) const {
    auto text = std::to_string(value);
    if (row.scale == Scale::velocity && unit_mode_.in_pps()) text += " pps";
    if (row.scale == Scale::acceleration && unit_mode_.in_pps()) text += " pps/s";
    if (const auto quantity = from_parameter(value, axis_, row); axis_.scale && quantity) {
      constexpr int digits = 4;
      const auto in_unit = plain_number(quantity->number, digits) + " " + quantity->unit;
      remark = remark.empty() ? in_unit : in_unit + "; " + remark;
    }
    return remark.empty() ? text : text + " (" + remark + ")";
  }

  const Chip& chip_;
  const UnitMode& unit_mode_;
  std::span<const Setting> written_;
  AxisUnits axis_;
};

}  // namespace

std::vector<std::string> AxisTwin::warnings(std::span<const Setting> written,
                                            const std::optional<UserScale>& scale) const {
  return std::visit(
      [&](const auto& chip) {
        const ParameterNames names(*model_, chip, units_, written, scale);
        std::vector<std::string> warnings;
        for (const auto& finding : chip.findings()) warnings.push_back(describe(finding, names));
        return warnings;
      },
      chip_);
}

PulsesPerSecond AxisTwin::to_pps(InternalVelocity velocity) const {
  return std::visit(
      [&](const auto& chip) -> PulsesPerSecond {
        return tmcl::to_pps(velocity, units_.in_pps() ? ModuleUnits{} : chip_units(chip));
      },
      chip_);
}

PulsesPerSecond2 AxisTwin::to_pps2(InternalAcceleration acceleration) const {
  return std::visit(
      [&](const auto& chip) -> PulsesPerSecond2 {
        return tmcl::to_pps2(acceleration, units_.in_pps() ? ModuleUnits{} : chip_units(chip));
      },
      chip_);
}

std::vector<AxisMotion> motions(AxisTwin twin, Duration step, std::size_t count) {
  std::vector<AxisMotion> curve;
  curve.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    twin.advance(step);
    curve.push_back(twin.motion());
  }
  return curve;
}

}  // namespace tmcl::plan
