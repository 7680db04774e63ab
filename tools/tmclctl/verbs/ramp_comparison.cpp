// ramp --compare: all ramps of a model beside each other.
#include <cmath>

#include <fmt/format.h>

#include "api/ramp_view.hpp"
#include "output/print.hpp"
#include "ramp_words.hpp"
#include "tmcl/api/ramp.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/ramp_comparison.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace plan = tmcl::plan;

using api::ramp::ComparedRamp;
using api::ramp::Comparison;

/// "max_bow 8"
std::string settings_text(const ComparedRamp& ramp) {
  std::string text;
  for (const auto& setting : ramp.settings)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", setting.parameter, setting.value);
  return text.empty() ? "as it is" : text;
}

void show(const Comparison& comparison, Output& output) {
  if (output.json) return print_json(api::to_json(comparison), output);
  const bool has_load = comparison.tolerance_microsteps.has_value();
  const auto unit = comparison.unit.value_or("microsteps");
  std::vector<std::string> headings{"RAMP", "TIME [s]", "LONGEST PHASE [s]"};
  if (has_load) headings.insert(headings.end(), {fmt::format("SWINGS [{}]", unit), "SETTLED [s]"});
  Table table(headings);
  const auto number = [](std::optional<double> value, const char* none) {
    return value ? tmcl::plain_number(*value, 5) : std::string(none);
  };
  for (const auto& ramp : comparison.ramps) {
    std::vector<std::string> cells{settings_text(ramp), number(ramp.move_s, "swings for ever"),
                                   number(ramp.longest_phase_s, "")};
    if (has_load) {
      cells.push_back(number(comparison.unit ? ramp.swing : ramp.swing_microsteps, "-"));
      cells.push_back(number(ramp.settled_s, ramp.move_s ? "never" : "-"));
    }
    table.add(std::move(cells));
  }
  table.print(output);
  if (!comparison.proposed) {
    if (has_load) output.out << "with none of them does the load come to rest\n";
    return;
  }
  const auto& best = comparison.ramps.at(static_cast<std::size_t>(*comparison.proposed));
  output.out << fmt::format("the load stands first with {}, after {} s\n", settings_text(best),
                            tmcl::plain_number(*best.settled_s, 4));
}

/// `unit`: how many of it a microstep is.
Result<Comparison> compared(const verb::Ramp& verb, const plan::PlannedRamp& planned,
                            const AxisUnits& units, std::optional<double> unit) {
  const auto distance = way_of(verb.distance, units);
  if (!distance) return tl::unexpected(distance.error());
  std::optional<plan::LoadWish> load;
  if (verb.resonance_hz) {
    load = {{*verb.resonance_hz, verb.damping.value_or(tmcl::ramp::usual_load_damping)},
            plan::usual_load_tolerance * std::abs(static_cast<double>(distance->value))};
  }
  if (load && !verb.tolerance.empty()) {
    const auto tolerance = length_of(verb.tolerance, units);
    if (!tolerance) return tl::unexpected(tolerance.error());
    load->tolerance = std::abs(static_cast<double>(tolerance->value));
  }
  const auto& model = *units.model;
  const auto& settings = planned.choice.settings;
  Comparison comparison{{}, std::string(model.name)};
  if (unit) comparison.unit = units.scale->unit;
  comparison.distance_microsteps = distance->value;
  if (load) comparison.tolerance_microsteps = load->tolerance;
  std::vector<plan::RampVerdict> verdicts;
  for (const auto& variant : plan::ramp_variants(model, settings)) {
    const auto verdict = plan::judge_variant(model, settings, variant, *distance, load);
    if (!verdict) {
      return tl::unexpected(usage_error(
          "not_foreseeable", fmt::format("how a {} makes a move by {} microsteps is not described",
                                         model.name, distance->value)));
    }
    verdicts.push_back(*verdict);
    comparison.ramps.push_back(tmcld::view_of(variant, verdicts.back(), model, unit));
  }
  if (const auto first = plan::first_settled(verdicts))
    comparison.proposed = static_cast<std::int32_t>(*first);
  return comparison;
}

}  // namespace

Result<ExitCode> compare_on_axis(const verb::Ramp& verb, Context& context) {
  auto method = method_of<api::ramp::Compare>(verb);
  const auto typed = [&](const std::string& text) { return Typed{text, verb.internal}; };
  method.distance = typed(verb.distance).amount();
  method.distance_microsteps = typed(verb.distance).counted();
  method.resonance_hz = verb.resonance_hz;
  method.damping = verb.damping;
  method.tolerance = typed(verb.tolerance).amount();
  method.tolerance_microsteps = typed(verb.tolerance).counted();
  const auto comparison = context.call(method);
  if (!comparison) return tl::unexpected(comparison.error());
  show(*comparison, context.output);
  return ExitCode::done;
}

Result<ExitCode> compare_on_model(const verb::Ramp& verb, const plan::PlannedRamp& planned,
                                  const AxisUnits& units, std::optional<double> unit,
                                  Output& output) {
  const auto comparison = compared(verb, planned, units, unit);
  if (!comparison) return tl::unexpected(comparison.error());
  show(*comparison, output);
  return ExitCode::done;
}

}  // namespace tmclctl
