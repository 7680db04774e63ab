// resonance.
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "axis/typed.hpp"
#include "output/print.hpp"
#include "tmcl/api/resonance.hpp"
#include "tmcl/plain_number.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
using api::axis::MeasuredResonance;

api::axis::Resonance method_of(const verb::Resonance& verb) {
  api::axis::Resonance method;
  method.axis = verb.axis;
  if (!verb.distance.empty()) {
    const Typed distance{verb.distance, verb.internal};
    method.distance = distance.amount();
    method.distance_microsteps = distance.counted();
  }
  if (verb.for_s) method.listen_ms = std::llround(*verb.for_s * 1000);
  return method;
}

/// What to type next, with the ramp and the distance of the move.
std::string next_words(const verb::Resonance& verb, const MeasuredResonance& measured) {
  constexpr int digits = 4;
  const auto text = [](double value) { return tmcl::plain_number(value, digits); };
  return fmt::format(
      "tmclctl ramp {} --compare --velocity {}pps --acceleration {}pps/s --distance {}microsteps "
      "--resonance {}Hz --damping {}",
      verb.axis, tmcl::plain_number(measured.velocity_pps, 6),
      tmcl::plain_number(measured.acceleration_pps2, 6), std::abs(measured.distance_microsteps),
      text(*measured.resonance_hz), text(*measured.damping));
}

void show(const verb::Resonance& verb, const MeasuredResonance& measured, Output& output) {
  warn(measured.warnings, output);
  const auto next = measured.resonance_hz ? next_words(verb, measured) : std::string();
  if (output.json) {
    auto document = api::to_json(measured);
    document["axis"] = verb.axis;
    document["compare"] = next.empty() ? boost::json::value() : boost::json::value(next);
    return print_json(document, output);
  }
  const auto text = [](double value) { return tmcl::plain_number(value, 4); };
  if (measured.resonance_hz) {
    output.out << fmt::format(
        "the load of {} swings at {} Hz, with a damping of {}: {} counts to either side at first, "
        "{:.0f} % of what the encoder did\n",
        verb.axis, text(*measured.resonance_hz), text(*measured.damping), text(*measured.swing),
        100 * measured.confidence);
  } else if (measured.verdict == "still") {
    output.out << fmt::format("the load of {} stood as soon as its motor\n", verb.axis);
  } else {
    output.out << fmt::format("how the load of {} swings is not clear\n", verb.axis);
  }
  output.out << fmt::format("seen is what swings at {} to {} Hz: {} readings in {} s\n",
                            text(measured.lowest_hz), text(measured.highest_hz), measured.readings,
                            text(measured.readings_s));
  if (!next.empty()) output.out << next << '\n';
}

Result<ExitCode> run(const verb::Resonance& verb, Context& context) {
  const auto measured = context.call(method_of(verb));
  if (!measured) return tl::unexpected(measured.error());
  show(verb, *measured, context.output);
  return ExitCode::done;
}

constexpr const char* resonance_help = R"(
Makes a small move with the ramp that the axis has, reads the encoder as soon as the motor stands, and
finds how fast the load swings behind the motor, and how soon that ends. Says also what can be seen:
what swings faster than the encoder is read on this bus, or more slowly than --for lasts, is not. The
last line compares all ramps of the module for that move and that load.

The encoder must be on the load, or on what swings with it. The move is admitted as any other: it stays
within soft limits, and other clients' leases. A negative distance goes the other way. Ctrl-C ends the
reading and NOT the move.

  tmclctl resonance x
  tmclctl resonance x --distance 2mm --for 2
)";

}  // namespace

void add_resonance(Grammar& grammar) {
  auto resonance = grammar.verb<verb::Resonance>(
      "resonance", access::acts, "Measure how the load of an axis swings", resonance_help, run);
  resonance.axis(resonance->axis);
  resonance.option("--distance", "DISTANCE",
                   "How far to move, 1000 full steps at most (default: a quarter of a turn)",
                   text(resonance->distance));
  resonance.option("--for", "SECONDS", "For how long the encoder is read (default: 1)",
                   number(resonance->for_s, api::axis::shortest_listening_ms / 1e3,
                          api::axis::longest_listening_ms / 1e3));
  resonance.internal(resonance->internal);
}

}  // namespace tmclctl
