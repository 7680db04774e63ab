// A simulation by the parameters of a module, as a user would set them on an axis.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "axis/axis_names.hpp"
#include "axis/offline_axis.hpp"
#include "setup.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/ramp_registers.hpp"

namespace tmclctl::profile {
namespace {

namespace ap = tmcl::axis_parameter;
using tmcl::plan::RampRegisters;

struct Assignment {
  std::string words;
  const tmcl::ParameterInfo* row;
  std::string value;
};

/// It says what the others mean.
bool is_unit_parameter(const tmcl::Model& model, std::uint8_t number) {
  const auto numbers = tmcl::unit_parameters(model);
  return std::ranges::count(numbers, number) != 0;
}

bool starts_motion(const tmcl::ParameterInfo& row) {
  return row.number == ap::target_position || row.number == ap::target_velocity;
}

class ModelReader {
 public:
  ModelReader(tmcl::AxisUnits units, RampRegisters registers)
      : units_(std::move(units)), registers_(std::move(registers)) {
    for (const auto number : tmcl::unit_parameters(*units_.model))
      unit_values_[number] = find_parameter(units_.parameters(), number)->initial;
  }

  const RampRegisters& registers() const { return registers_; }
  /// What the chip counts in, and the unit of the axis; microsteps if it has none.
  plot::UserUnit drawn_unit() const {
    return {units_.limits_scale(),
            {{in_microsteps(ap::max_velocity)}, {in_microsteps(ap::max_acceleration)}}};
  }
  const tmcl::AxisUnits& units() const { return units_; }

  Result<Assignment> split(const std::string& words) const {
    const auto equals = words.find('=');
    if (equals == std::string::npos || equals == 0) {
      return tl::unexpected(usage_error("bad_register",
                                        fmt::format("'{}' is no PARAMETER=VALUE", words),
                                        "Such as max_velocity=20mm/s, or 4=1000"));
    }
    const auto name = parse_parameter(units_.parameters(), words.substr(0, equals));
    if (!name) return tl::unexpected(name.error());
    const auto* row = find_parameter(units_.parameters(), name->number);
    if (row != nullptr) return Assignment{words, row, words.substr(equals + 1)};
    return tl::unexpected(usage_error(
        "unknown_parameter",
        fmt::format("{}: a {} has no parameter {}", words, units_.model->name, name->number)));
  }

  /// What the words write, to be noted as given.
  Result<std::vector<Write>> writes_of(const Assignment& assignment, GivenParameter& given) {
    const auto& row = *assignment.row;
    const auto typed = typed_quantity(assignment.value, units_);
    if (!typed) return tl::unexpected(of_words(assignment, typed.error()));
    const auto value = attempt(to_parameter(typed->quantity, typed->units, row));
    if (!value) return tl::unexpected(of_words(assignment, value.error()));
    if (is_unit_parameter(*units_.model, row.number)) take_unit(row.number, *value);
    const auto writes = registers_.writes_of(row, *value);
    const bool only_means = writes.empty() && row.number == ap::unit_mode;
    if (writes.empty() && !only_means) return tl::unexpected(refusal(assignment, *value));
    given = {assignment.value, std::string(row.name), row.number, *value, {}, 0};
    if (!writes.empty()) {
      given.chip_register = registers_.registers()[writes.back().index].name;
      given.held = writes.back().value;
      given.off = deviation(*typed, row, given.held);
    }
    std::vector<Write> all;
    for (const auto& write : writes) all.push_back({write.index, write.value, assignment.words});
    return all;
  }

 private:
  /// What the register of the parameter counts in.
  double in_microsteps(std::uint8_t number) const {
    return registers_.in_microsteps(*find_parameter(units_.parameters(), number), 1,
                                    *units_.module);
  }
  static Error of_words(const Assignment& assignment, Error error) {
    error.message = assignment.words + ": " + error.message;
    return error;
  }

  Error refusal(const Assignment& assignment, std::int32_t value) const {
    const auto& row = *assignment.row;
    const auto range = range_of(row, initial_units(*units_.model), *units_.module);
    if (value < range.least || value > range.greatest) {
      return usage_error("out_of_range",
                         fmt::format("{}: {} ({}) is {} to {}", assignment.words, row.name,
                                     row.number, range.least, range.greatest));
    }
    return usage_error(
        "bad_register",
        fmt::format("{}: {} is in no register of the ramp generator", assignment.words, row.name),
        "'profile simulate --help' names what is");
  }

  void take_unit(std::uint8_t number, std::int32_t value) {
    unit_values_[number] = value;
    std::vector<std::int32_t> values;
    for (const auto one : tmcl::unit_parameters(*units_.model)) values.push_back(unit_values_[one]);
    if (const auto now = module_units(*units_.model, values)) units_.module = *now;
    if (number == ap::unit_mode) registers_.count_in_pps(value == 1);
  }

  /// Of what was asked for with a unit.
  std::optional<double> deviation(const TypedQuantity& typed, const tmcl::ParameterInfo& row,
                                  std::int64_t held) const {
    const auto wished = [&]() -> std::optional<double> {
      const auto undirected = typed.units.undirected();
      if (typed.quantity.unit.empty()) return std::nullopt;
      const auto value_of = [](const auto& converted) {
        return converted ? std::optional(converted->value) : std::nullopt;
      };
      if (dimension_of(row) == tmcl::Dimension::velocity)
        return value_of(to_pps(typed.quantity, undirected));
      if (dimension_of(row) == tmcl::Dimension::acceleration)
        return value_of(to_pps2(typed.quantity, undirected));
      return std::nullopt;
    }();
    if (!wished || *wished == 0) return std::nullopt;
    return registers_.in_microsteps(row, held, *units_.module) / *wished - 1;
  }

  tmcl::AxisUnits units_;
  RampRegisters registers_;
  std::map<std::uint8_t, std::int32_t> unit_values_;
};

/// The unit first, and last what sets the motor going.
void put_in_order(std::vector<Assignment>& assignments, const tmcl::Model& model) {
  std::ranges::stable_sort(assignments, {}, [&](const Assignment& one) {
    return is_unit_parameter(model, one.row->number) ? 0 : starts_motion(*one.row) ? 2 : 1;
  });
}

Result<void> read_start(ModelReader& reader, const std::vector<std::string>& settings,
                        Setup& setup) {
  std::vector<Assignment> assignments;
  for (const auto& words : settings) {
    auto assignment = reader.split(words);
    if (!assignment) return tl::unexpected(assignment.error());
    if (std::ranges::find(assignments, assignment->row, &Assignment::row) != assignments.end()) {
      return tl::unexpected(usage_error("bad_register",
                                        fmt::format("{} is given twice", assignment->row->name),
                                        "--change writes it again later"));
    }
    assignments.push_back(std::move(*assignment));
  }
  put_in_order(assignments, *reader.units().model);
  for (const auto& write : reader.registers().initial_writes())
    setup.script.start.push_back({write.index, write.value, "as the module starts"});
  for (const auto& assignment : assignments) {
    GivenParameter given;
    const auto writes = reader.writes_of(assignment, given);
    if (!writes) return tl::unexpected(writes.error());
    setup.script.start.insert(setup.script.start.end(), writes->begin(), writes->end());
    setup.parameters.push_back(std::move(given));
  }
  return {};
}

Result<void> read_changes(ModelReader& reader, const verb::Simulate& verb, Setup& setup) {
  auto by_time = verb.changes;
  std::ranges::stable_sort(by_time, {}, &verb::Simulate::Change::time);
  for (const auto& change : by_time) {
    const auto assignment = reader.split(change.setting);
    if (!assignment) return tl::unexpected(assignment.error());
    GivenParameter given;
    const auto writes = reader.writes_of(*assignment, given);
    if (!writes) return tl::unexpected(writes.error());
    for (auto write : *writes) {
      write.words = fmt::format("--change {}:{}", change.time, change.setting);
      setup.script.changes.push_back({setup.tick_at(change.time), std::move(write)});
    }
    setup.parameters.push_back(std::move(given));
  }
  return {};
}

/// As the parameter was typed, where it was.
std::function<std::string(const tmcl::ramp::Finding::Mention&)> names_of(
    RampRegisters registers, std::vector<GivenParameter> given) {
  return [registers = std::move(registers),
          given = std::move(given)](const tmcl::ramp::Finding::Mention& mention) {
    using Form = tmcl::ramp::Finding::Form;
    const auto* row = registers.row_of(mention.index);
    if (row == nullptr)
      return describe(tmcl::ramp::Finding{"{}", {mention}}, registers.registers());
    const std::string name(row->name);
    if (mention.form == Form::name) return name;
    const auto read = std::to_string(registers.unit_mode().read(row->scale, mention.value));
    if (mention.form == Form::value) return read;
    const auto typed = std::ranges::find_if(given.rbegin(), given.rend(), [&](const auto& one) {
      return one.number == row->number && one.held == mention.value;
    });
    const bool vanishes = typed != given.rend() && typed->value != 0 && mention.value == 0;
    return name + " " + (typed == given.rend() ? read : typed->said) +
           (vanishes ? " (0 in the chip)" : "");
  };
}

}  // namespace

Result<Setup> read_model_setup(const verb::Simulate& verb) {
  auto units = axis_units_of(verb.axis);
  if (!units) return tl::unexpected(units.error());
  auto registers = RampRegisters::of(*units->model);
  if (!registers) {
    return tl::unexpected(
        usage_error("not_foreseeable",
                    fmt::format("the firmware of a {} makes its ramps, and no document says how",
                                units->model->name),
                    "'tmclctl ramp --model' tells their parameters, times and lengths"));
  }
  const auto generator = find_generator(registers->chip());
  if (!generator) return tl::unexpected(generator.error());
  Setup setup{**generator, (*generator)->ticks_per_second(usual_clock_hz), {}};
  ModelReader reader(std::move(*units), std::move(*registers));
  if (const auto read = read_start(reader, verb.settings, setup); !read)
    return tl::unexpected(read.error());
  if (const auto read = read_changes(reader, verb, setup); !read)
    return tl::unexpected(read.error());
  setup.user = reader.drawn_unit();
  setup.script.said = names_of(reader.registers(), setup.parameters);
  return setup;
}

}  // namespace tmclctl::profile
