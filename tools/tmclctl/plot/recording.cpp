#include "plot/recording.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include <fmt/format.h>

#include "axis/quantity_text.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/utc_text.hpp"

namespace tmclctl::plot {
namespace {

using Converts = double (*)(double recorded, const Recording&);

Curve curve(const Recording& recording, std::string name, std::string unit,
            std::int64_t Sample::*value, Converts shown) {
  Curve made{std::move(name), std::move(unit), {}, {}};
  for (const auto& sample : recording.samples) {
    made.times.push_back(sample.time);
    made.values.push_back(shown(static_cast<double>(sample.*value), recording));
  }
  return made;
}

double position_of(const Sample& sample, const Recording& recording) {
  return shown_position(static_cast<double>(sample.position), recording);
}

double velocity_of(const Sample& sample, const Recording& recording) {
  return shown_velocity(static_cast<double>(sample.velocity), recording);
}

/// "mm/s^2" behind a velocity in mm/s.
std::string change_of(const std::string& unit, int order, const Recording& recording) {
  const auto per = '/' + recording.time_unit;
  const auto of = unit.ends_with(per) ? unit.substr(0, unit.size() - per.size()) : unit;
  const auto power = of == unit ? order : order + 1;
  return of + per + (power > 1 ? '^' + std::to_string(power) : "");
}

std::vector<double> breaks_of(const Recording& recording) {
  std::vector<double> breaks;
  for (const auto& phase : recording.phases) breaks.push_back(phase.time);
  return breaks;
}

/// "mm_per_s2"
std::string in_a_name(std::string unit) {
  std::erase(unit, '^');
  const auto slash = unit.find('/');
  return slash == std::string::npos ? unit : unit.replace(slash, 1, "_per_");
}

/// "acceleration_mm_per_s2"
std::string column_of(const Curve& curve) { return curve.name + '_' + in_a_name(curve.unit); }

bool knows_accelerations(const Recording& recording) {
  return !recording.samples.empty() && recording.samples.front().acceleration;
}

double shown_acceleration(double recorded, const Recording& recording) {
  if (!recording.user) return recorded;
  const auto pps2 = recorded * recording.user->module.acceleration.value;
  return to_user(tmcl::PulsesPerSecond2{pps2}, recording.user->scale).value;
}

}  // namespace

void use(UserUnit unit, Recording& recording) {
  recording.position_unit = unit.scale.unit;
  recording.velocity_unit = unit.scale.unit + "/s";
  recording.user = std::move(unit);
}

double shown_position(double recorded, const Recording& recording) {
  if (!recording.user) return recorded;
  // As a speed, because that need not be whole.
  return to_user(tmcl::PulsesPerSecond{recorded}, recording.user->scale).value;
}

double shown_velocity(double recorded, const Recording& recording) {
  if (!recording.user) return recorded;
  const auto pps = recorded * recording.user->module.velocity.value;
  return to_user(tmcl::PulsesPerSecond{pps}, recording.user->scale).value;
}

Curve position_curve(const Recording& recording) {
  return curve(recording, "position", recording.position_unit, &Sample::position, shown_position);
}

Curve velocity_curve(const Recording& recording) {
  return curve(recording, "velocity", recording.velocity_unit, &Sample::velocity, shown_velocity);
}

Curve acceleration_curve(const Recording& recording) {
  const auto unit = change_of(recording.velocity_unit, 1, recording);
  if (!knows_accelerations(recording))
    return derivative(velocity_curve(recording), "acceleration", unit, breaks_of(recording));
  // What a chip counts accelerations in is no velocity a second.
  Curve made{"acceleration", recording.user ? unit : recording.velocity_unit, {}, {}};
  for (const auto& sample : recording.samples) {
    made.times.push_back(sample.time);
    made.values.push_back(shown_acceleration(static_cast<double>(*sample.acceleration), recording));
  }
  return made;
}

Curve jerk_curve(const Recording& recording) {
  const auto acceleration = acceleration_curve(recording);
  const bool counts = knows_accelerations(recording) && !recording.user;
  return derivative(acceleration, "jerk",
                    change_of(recording.velocity_unit, counts ? 1 : 2, recording),
                    breaks_of(recording));
}

std::vector<Curve> also_curves(const Recording& recording) {
  std::vector<Curve> curves;
  for (std::size_t i = 0; i < recording.also.size(); ++i) {
    const auto& [name, unit] = recording.also[i];
    // Drawn like an acceleration: in a colour that position and velocity do not have.
    Curve curve{name, unit.empty() ? "internal" : unit, {}, {}, {}, "acceleration"};
    for (const auto& sample : recording.samples) {
      if (i >= sample.also.size() || !sample.also[i]) continue;
      const auto& read = *sample.also[i];
      curve.times.push_back(sample.time);
      curve.values.push_back(read.in_unit.value_or(read.value));
    }
    if (!curve.times.empty()) curves.push_back(std::move(curve));
  }
  return curves;
}

std::string summary(const Recording& recording) {
  if (recording.samples.empty()) return fmt::format("{}: nothing was recorded", recording.axis);
  const auto& first = recording.samples.front();
  const auto& last = recording.samples.back();
  const auto fastest = std::ranges::max_element(
      recording.samples, {}, [](const Sample& sample) { return std::abs(sample.velocity); });
  const auto position = [&](const Sample& sample) {
    return shown_number(position_of(sample, recording), static_cast<double>(sample.position));
  };
  return fmt::format(
      "{} went from {} to {} {} in {:.2f} {}, fastest velocity {} {}", recording.axis,
      position(first), position(last), recording.position_unit, last.time - first.time,
      recording.time_unit,
      shown_number(velocity_of(*fastest, recording), static_cast<double>(fastest->velocity)),
      recording.user ? recording.velocity_unit : '[' + recording.velocity_unit + ']');
}

namespace {

std::vector<Curve> changes_of(const Recording& recording, const Shown& shown) {
  std::vector<Curve> changes;
  if (std::ranges::count(shown, Quantity::acceleration) > 0)
    changes.push_back(acceleration_curve(recording));
  if (std::ranges::count(shown, Quantity::jerk) > 0) changes.push_back(jerk_curve(recording));
  return changes;
}

/// `more`: the names of further columns, each with a comma before it.
std::string columns(const Recording& recording, Rows rows, const std::string& more) {
  const bool several = rows == Rows::of_several;
  std::string text = several ? "time_s,axis" : "time_s";
  text += ",position_microsteps,velocity_internal";
  if (several) {
    text += ",position_in_unit,velocity_in_unit";
  } else if (const auto& user = recording.user) {
    text += fmt::format(",position_{0},velocity_{0}_per_s", user->scale.unit);
  }
  for (const auto& [name, unit] : recording.also) {
    text += ',' + name;
    if (several || !unit.empty())
      text += ',' + name + '_' + (several ? "in_unit" : in_a_name(unit));
    text += ',' + name + "_age_ms";
  }
  return text + more + (recording.begin_utc ? ",utc\n" : "\n");
}

/// The cells of a further parameter, each with a comma before it.
std::string cells(const std::optional<ParameterValue>& value, bool has_unit) {
  if (!value) return has_unit ? ",,," : ",,";
  auto text = fmt::format(",{}", value->value);
  if (has_unit) text += ',' + (value->in_unit ? tmcl::plain_number(*value->in_unit, 12) : "");
  return text + fmt::format(",{}", value->age_ms);
}

std::string row(const Recording& recording, const Sample& sample, Rows rows,
                const std::string& more) {
  const bool several = rows == Rows::of_several;
  std::string text = fmt::format("{:.6f}", sample.time);
  if (several) text += ',' + recording.axis;
  text += fmt::format(",{},{}", sample.position, sample.velocity);
  if (recording.user) {
    text += ',' + tmcl::plain_number(position_of(sample, recording), 12) + ',' +
            tmcl::plain_number(velocity_of(sample, recording), 12);
  } else if (several) {
    text += ",,";
  }
  for (std::size_t i = 0; i < recording.also.size(); ++i) {
    const auto value = i < sample.also.size() ? sample.also[i] : std::nullopt;
    text += cells(value, several || !recording.also[i].unit.empty());
  }
  text += more;
  if (recording.begin_utc) {
    const auto time = std::chrono::duration<double>(sample.time);
    text += ',' + tmcl::to_text(*recording.begin_utc + std::chrono::round<tmcl::Duration>(time));
  }
  return text + '\n';
}

}  // namespace

std::string csv_columns(const Recording& recording, Rows rows) {
  return columns(recording, rows, "");
}

std::string csv_row(const Recording& recording, const Sample& sample, Rows rows) {
  return row(recording, sample, rows, "");
}

std::string to_csv(const Recording& recording, const Shown& shown) {
  const auto changes = changes_of(recording, shown);
  std::string names;
  for (const auto& curve : changes) names += ',' + column_of(curve);
  auto text = columns(recording, Rows::of_one, names);
  for (std::size_t i = 0; i < recording.samples.size(); ++i) {
    std::string values;
    for (const auto& curve : changes) values += ',' + tmcl::plain_number(curve.values[i], 6);
    text += row(recording, recording.samples[i], Rows::of_one, values);
  }
  return text;
}

}  // namespace tmclctl::plot
