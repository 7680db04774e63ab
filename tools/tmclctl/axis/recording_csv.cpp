#include "axis/recording_csv.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "output/print.hpp"
#include "scale_factors.hpp"
#include "tmcl/api/parameter.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/utc_text.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

constexpr int digits_of_units = 10;

/// " 1.13"
std::string firmware_text(const api::axis::Axis& axis, const api::module::Modules& modules) {
  for (const auto& module : modules.modules) {
    if (module.bus == axis.bus && module.address == axis.address && module.firmware)
      return " " + *module.firmware;
  }
  return "";
}

/// "TMCM-3110 1.13, module 1 of bench, motor 0"
std::string module_text(const std::string& name, const api::axis::Axes& axes,
                        const api::module::Modules& modules) {
  const auto axis = std::ranges::find(axes.axes, name, &api::axis::Axis::name);
  if (axis == axes.axes.end()) return "";
  return fmt::format("{}{}, module {} of {}, motor {}", axis->model.value_or("unknown model"),
                     firmware_text(*axis, modules), axis->address, axis->bus, axis->motor);
}

std::string unit_text(const plot::Recording& recording, Context& context) {
  if (const auto& user = recording.user) {
    const auto factors = scale_factors_of(recording.axis, true, context);
    return fmt::format("unit {} of {} microsteps, velocity_internal of {} pps", user->scale.unit,
                       factor_text(factors.microsteps_per_unit),
                       tmcl::plain_number(user->module.velocity.value, digits_of_units));
  }
  const auto units = context.call(api::axis::GetUnits{recording.axis});
  if (!units || !units->velocity_unit_pps) return "";
  return fmt::format("velocity_internal of {} pps",
                     tmcl::plain_number(*units->velocity_unit_pps, digits_of_units));
}

std::string joined_if_any(std::string text, const std::string& more, const char* between) {
  if (!text.empty() && !more.empty()) text += between;
  return text + more;
}

/// What the tables say of further parameters, each of which is on all axes.
std::string parameter_comments(const plot::Recording& recording, Context& context) {
  if (recording.also.empty()) return "";
  const auto known = context.call(api::parameter::List{recording.axis});
  std::string text;
  for (const auto& [name, unit] : recording.also) {
    text += "# " + name;
    if (known) {
      const auto row = std::ranges::find(known->parameters, name, &api::parameter::Parameter::name);
      if (row != known->parameters.end())
        text += ": " + joined_if_any(row->unit, row->meaning, "; ");
    }
    text += '\n';
  }
  return text;
}

/// How old it was when the reading was taken.
std::int64_t age_at(const AxisReading& reading, const api::Sample& sample) {
  return sample.age_ms - reading.age_ms;
}

}  // namespace

Result<plot::Recording> begin_recording(const std::string& axis,
                                        const std::vector<std::string>& parameters, bool internal,
                                        Context& context) {
  const auto reading = state_of(axis, context);
  if (!reading) return tl::unexpected(reading.error());
  plot::Recording recording{reading->axis, {}};
  for (const auto& parameter : parameters) {
    const auto value = context.call(api::parameter::Get{{axis, name_or_number(parameter)}});
    if (!value) return tl::unexpected(value.error());
    const auto name = name_of(*value);
    const auto& also = recording.also;
    // It may go by two names.
    if (std::ranges::find(also, name, &plot::AlsoRecorded::name) != also.end()) continue;
    recording.also.push_back({name, internal ? "" : value->unit.value_or("")});
  }
  if (internal || !reading->position) return recording;
  auto units = units_of(axis, context);
  // Whatever comes of it: there is something to record.
  if (units && units->scale && units->module)
    plot::use({std::move(*units->scale), *units->module}, recording);
  return recording;
}

plot::Sample sample_of(const AxisReading& reading, double time_s,
                       const plot::Recording& recording) {
  const auto age_s = static_cast<double>(reading.age_ms) / 1000;
  plot::Sample sample{time_s, reading.position_microsteps, reading.velocity_internal, age_s};
  for (const auto& [name, unit] : recording.also) {
    auto& value = sample.also.emplace_back();
    const auto read = std::ranges::find_if(
        reading.samples, [&](const api::Sample& one) { return name_of(one) == name; });
    if (read == reading.samples.end()) continue;
    value = plot::ParameterValue{read->value, unit.empty() ? std::nullopt : read->value_in_unit,
                                 age_at(reading, *read)};
  }
  return sample;
}

std::string csv_comments(const std::vector<plot::Recording>& recordings, Context& context) {
  std::string text = "# tmclctl " TMCL_VERSION;
  const auto gateway = context.gateway.caller.version();
  if (!gateway.empty()) text += ", tmcld " + gateway;
  text += "\n# begins " + tmcl::to_text(context.host.utc()) + '\n';
  const auto axes = context.call(api::axis::List{true}).value_or(api::axis::Axes{});
  const auto modules = context.call(api::module::List{}).value_or(api::module::Modules{});
  for (const auto& recording : recordings) {
    const auto about = joined_if_any(module_text(recording.axis, axes, modules),
                                     unit_text(recording, context), "; ");
    text += "# " + joined_if_any(recording.axis, about, ": ") + '\n';
  }
  return recordings.empty() ? text : text + parameter_comments(recordings.front(), context);
}

Result<void> RecordingCsv::open(const std::string& path) {
  path_ = path;
  return file_.open(path == "-" ? "" : path);
}

void RecordingCsv::begin(const std::vector<plot::Recording>& recordings) {
  if (!is_wanted() || recordings.empty()) return;
  rows_ = recordings.size() > 1 ? plot::Rows::of_several : plot::Rows::of_one;
  comments_ = csv_comments(recordings, context_);
  columns_ = csv_columns(recordings.front(), rows_);
}

void RecordingCsv::add(const plot::Recording& recording, const plot::Sample& sample) {
  if (!is_wanted()) return;
  if (!std::exchange(has_begun_, true)) write(comments_ + columns_);
  write(csv_row(recording, sample, rows_));
}

void RecordingCsv::add(const plot::Recording& recording, const plot::Shown& shown) {
  if (is_wanted()) write(comments_ + to_csv(recording, shown));
}

void RecordingCsv::write(const std::string& text) {
  if (!written_) return;
  if (path_ == "-") {
    context_.output.out << text << std::flush;
  } else {
    written_ = file_.append(text);
  }
}

}  // namespace tmclctl
