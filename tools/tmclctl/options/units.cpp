// Quantities with units, and the verbs that are about them.
#include <bit>

#include "grammar.hpp"
#include "help_text.hpp"
#include "tmcl/jerk.hpp"

namespace tmclctl {
namespace {

tl::expected<void, std::string> read_microsteps(const std::string& text, std::int32_t& into) {
  const auto value = parse_number<std::int32_t>(text, 1, 1 << tmcl::max_microstep_resolution);
  if (!value) return tl::unexpected(value.error());
  if (!std::has_single_bit(static_cast<std::uint32_t>(*value)))
    return tl::unexpected(fmt::format("{} is no power of two", text));
  into = *value;
  return {};
}

}  // namespace

void add_units(Grammar& grammar) {
  auto ramp = grammar.verb<verb::Ramp>(
      "ramp", "Choose and set registers for a velocity and an acceleration", help_text::ramp);
  ramp.axis(ramp->axis);
  ramp.required_option("--velocity", "VELOCITY", "Of positioning moves, such as 50000pps",
                       text(ramp->velocity));
  ramp.required_option("--acceleration", "ACCELERATION", "Of every ramp, such as 100mm/s^2",
                       text(ramp->acceleration));
  ramp.option("--deceleration", "ACCELERATION", "To brake with, where the module has it apart",
              text(ramp->deceleration));
  ramp.option("--jerk", "JERK",
              "How fast the acceleration changes, such as 500mm/s^3, or max; as it is without",
              text(ramp->jerk));
  ramp.flag("--dry-run", "Only show what would be set", ramp->dry_run);
  ramp.internal(ramp->internal);

  auto convert = grammar.verb<verb::Convert>(
      "convert", "Show a quantity in all its units, without any module", help_text::convert);
  convert.optional_word("QUANTITY",
                        "Such as 500, 61035pps, 2rps, 1.5rev, 100000pps/s or 1e6pps/s^2",
                        text(convert->quantity));
  convert.required_option("--model", "MODEL", "Such as TMCM-1110", text(convert->model));
  convert.option("--pulse-div", "N", "Pulse divider (parameter 154) of a TMC429",
                 number(convert->pulse_div, 0, tmcl::tmc429_max_divider));
  convert.option("--ramp-div", "N", "Its ramp divider (parameter 153)",
                 number(convert->ramp_div, 0, tmcl::tmc429_max_divider));
  convert.option("--unit-mode", "MODE", "Parameter 255 of other chips",
                 number(convert->unit_mode, 0, 1));
  auto& microsteps = convert->microsteps;
  convert.option(
      "--microsteps", "N", "Microsteps of a full step (default 256)",
      [&microsteps](const std::string& text) { return read_microsteps(text, microsteps); });
  convert.option("--bow", "N", "A bow of a TMC457 (parameter 18) instead of a quantity",
                 number(convert->bow, 1, tmcl::greatest_bow));
  convert.option("--acceleration", "ACCELERATION",
                 "Time and length of the ramp to QUANTITY, a velocity; S-shaped with --bow",
                 text(convert->acceleration));
  convert.object(
      [](const verb::Convert& said, bool) -> std::string {
        if (!said.acceleration.empty())
          return said.quantity.empty() ? "--acceleration is of the ramp to a velocity" : "";
        return said.quantity.empty() == said.bow.has_value() ? "" : "give QUANTITY or --bow";
      },
      "such as 'tmclctl convert --model TMCM-142 --bow 11'");
  convert.option("--full-steps", "N", "Full steps of a turn (default 200)",
                 number(convert->full_steps, 1, tmcl::max_full_steps));
}

}  // namespace tmclctl
