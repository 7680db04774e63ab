// state, watch.
#include <fmt/format.h>

#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

bool same(const AxisReading& a, const AxisReading& b) {
  return a.position == b.position && a.velocity == b.velocity && a.target == b.target &&
         a.moving == b.moving && a.position_reached == b.position_reached;
}

// "position 12.5 mm  velocity 0.25 mm/s  target 20 mm"
std::string in_unit(const UserReading& user, tmcl::InternalVelocity velocity) {
  const auto speed = user.velocity ? fmt::format("{:.10g} {}/s", *user.velocity, user.unit)
                                   : fmt::format("{}", velocity.value);
  return fmt::format("position {:.10g} {}  velocity {}  target {:.10g} {}", user.position,
                     user.unit, speed, user.target, user.unit);
}

std::string in_module_units(const AxisReading& reading) {
  return fmt::format("position {}  velocity {}  target {}", reading.position.value,
                     reading.velocity.value, reading.target.value);
}

void print_change(const verb::Watch& verb, const AxisReading& reading, double at_s,
                  Output& output) {
  if (output.json) {
    auto document = to_json(verb.axis, reading);
    document["time_s"] = at_s;
    print_json(document, output);
    return;
  }
  const bool has_unit = reading.user && !verb.internal;
  output.out << fmt::format(
                    "{:9.3f} s  {}  {}  {}", at_s, verb.axis,
                    has_unit ? in_unit(*reading.user, reading.velocity) : in_module_units(reading),
                    reading.moving             ? "moving"
                    : reading.position_reached ? "at target"
                                               : "standing")
             << std::endl;
}

}  // namespace

VerbResult run(const verb::State& verb, Room& room) {
  const auto reading = room.target.state(verb.axis);
  if (!reading) return tl::unexpected(reading.error());
  if (room.output.json) {
    print_json(to_json(verb.axis, *reading), room.output);
    return ExitCode::done;
  }
  const auto in_unit = [&](double value, std::string_view per_time = "") {
    return fmt::format("{:.10g} {}{} = ", value, reading->user->unit, per_time);
  };
  const auto& user = reading->user;
  const auto pps =
      reading->velocity_pps ? fmt::format(" ({:.1f} microsteps/s)", *reading->velocity_pps) : "";
  room.output.out << fmt::format(
      "axis      {}\nposition  {}{} microsteps\ntarget    {}{} microsteps{}\nvelocity  "
      "{}{}{}\nmoving    "
      "{}\n",
      verb.axis, user ? in_unit(user->position) : "", reading->position.value,
      user ? in_unit(user->target) : "", reading->target.value,
      reading->position_reached ? ", reached" : "",
      user && user->velocity ? in_unit(*user->velocity, "/s") : "", reading->velocity.value, pps,
      reading->moving ? "yes" : "no");
  return ExitCode::done;
}

VerbResult run(const verb::Watch& verb, Room& room) {
  const auto begin = room.patience.now();
  const auto seconds_since_begin = [&](tmcl::TimePoint at) {
    return std::chrono::duration<double>(at - begin).count();
  };
  std::optional<AxisReading> last;
  const auto watched = room.target.watch(verb.axis, verb.interval, [&](const AxisReading* reading) {
    if (reading != nullptr && !(last && same(*last, *reading))) {
      print_change(verb, *reading, seconds_since_begin(room.patience.now()), room.output);
      last = *reading;
    }
    // Ending it is what Ctrl-C is for here, so that is no failure.
    return room.patience.signal() == 0 &&
           !(verb.for_s && seconds_since_begin(room.patience.now()) >= *verb.for_s);
  });
  if (!watched && room.patience.signal() == 0) return tl::unexpected(watched.error());
  return ExitCode::done;
}

}  // namespace tmclctl
