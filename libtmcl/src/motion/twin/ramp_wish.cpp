#include "tmcl/plan/ramp_wish.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tmcl/jerk.hpp"
#include "tmcl/spelling.hpp"

namespace tmcl::plan {
namespace {

using Part = RampObjection::Part;

std::string_view name_of(Part part) {
  switch (part) {
    case Part::velocity: return "velocity";
    case Part::acceleration: return "acceleration";
    case Part::deceleration: return "deceleration";
    case Part::jerk: return "jerk";
    case Part::bow: return "bow";
  }
  return {};
}

tl::unexpected<RampObjection> object(Part part, Error error) {
  return tl::unexpected(RampObjection{part, std::move(error)});
}

template <class Value>
tl::expected<Value, RampObjection> in_pulses(Part part, const tmcl::Quantity& said,
                                             const AxisUnits& units,
                                             Result<Value> (*convert)(const tmcl::Quantity&,
                                                                      const AxisUnits&)) {
  const auto value = convert(said, units);
  if (!value) return object(part, value.error());
  if (value->value > 0) return *value;
  return object(part,
                not_sent(Errc::out_of_range, quoted(name_of(part)) + " must be greater than 0"));
}

/// What the module counts itself may count something else with the ramp that is chosen.
WishUnit unit_of(const tmcl::Quantity& said, double pulses, std::string_view in_microsteps) {
  if (said.unit.empty()) return {1, std::string(in_microsteps)};
  return {said.number / pulses, said.unit};
}

class Planner {
 public:
  Planner(const RampWish& wish, const AxisUnits& units, std::int32_t present_bow)
      : wish_(wish), units_(units.undirected()), model_(*units.model) {
    request_.bow = present_bow;
    request_.jerk.reset();
  }

  tl::expected<RampRequest, RampObjection> request() {
    return read_rates().and_then([&] { return read_jerk(); }).map([&] { return request_; });
  }

  tl::expected<PlannedRamp, RampObjection> plan() {
    return request().and_then(
        [&](const RampRequest& request) -> tl::expected<PlannedRamp, RampObjection> {
          auto choice = choose_ramp(model_, request, *units_.module);
          if (!choice) return tl::unexpected(too_far(choice.error()));
          PlannedRamp planned{std::move(*choice), {}};
          planned.warnings = foreseen(planned);
          return planned;
        });
  }

 private:
  const tmcl::Quantity& braking() const {
    return wish_.deceleration ? *wish_.deceleration : wish_.acceleration;
  }

  tl::expected<void, RampObjection> read_rates() {
    const auto velocity =
        in_pulses<PulsesPerSecond>(Part::velocity, wish_.velocity, units_, to_pps);
    if (!velocity) return tl::unexpected(velocity.error());
    const auto acceleration =
        in_pulses<PulsesPerSecond2>(Part::acceleration, wish_.acceleration, units_, to_pps2);
    if (!acceleration) return tl::unexpected(acceleration.error());
    const auto deceleration =
        in_pulses<PulsesPerSecond2>(Part::deceleration, braking(), units_, to_pps2);
    if (!deceleration) return tl::unexpected(deceleration.error());
    request_.velocity = *velocity;
    request_.acceleration = *acceleration;
    request_.deceleration = *deceleration;
    request_.said_in.velocity = unit_of(wish_.velocity, velocity->value, "microsteps/s");
    request_.said_in.acceleration =
        unit_of(wish_.acceleration, acceleration->value, "microsteps/s^2");
    request_.said_in.deceleration = unit_of(braking(), deceleration->value, "microsteps/s^2");
    return {};
  }

  tl::expected<void, RampObjection> read_jerk() {
    if (!wish_.jerk) return {};
    const auto part = wish_.jerk->bow ? Part::bow : Part::jerk;
    if (wish_.jerk->highest) {
      request_.jerk = highest_jerk;
      return {};
    }
    if (wish_.jerk->bow) request_.jerk = to_pps3(*wish_.jerk->bow).value;
    if (const auto& said = wish_.jerk->quantity) {
      const auto jerk = in_pulses<PulsesPerSecond3>(part, *said, units_, to_pps3);
      if (!jerk) return tl::unexpected(jerk.error());
      request_.jerk = jerk->value;
      request_.said_in.jerk = {said->number / jerk->value, said->unit};
    }
    return refuse_jerk_out_of_reach(part);
  }

  /// What no bow keeps would be exceeded in silence.
  tl::expected<void, RampObjection> refuse_jerk_out_of_reach(Part part) const {
    const auto fault = jerk_out_of_reach(model_, *request_.jerk);
    if (!fault) return {};
    if (std::isinf(fault->nearest)) {
      return object(part, not_sent(Errc::out_of_range,
                                   "a " + std::string(model_.name) +
                                       " has no bow: its acceleration changes at once",
                                   "leave 'jerk' and 'bow' away, or give 'max' as 'jerk'"));
    }
    auto told = in_unit(*fault, request_.said_in.jerk);
    if (wish_.jerk->quantity) told.wished = wish_.jerk->quantity->number;
    return object(part, not_sent(Errc::out_of_range, describe(told),
                                 "give a higher jerk, or leave 'jerk' away"));
  }

  /// With fewer microsteps, by which what was said in them stays as it is.
  std::string hint_of_microsteps() const {
    if (!units_.scale) return {};
    return hint_of_resolution(units_.scale->steps.resolution, [&](double share) {
      auto request = request_;
      const auto shrink = [&](const tmcl::Quantity& said, auto& pulses) {
        if (!is_in_microsteps(said)) pulses.value *= share;
      };
      shrink(wish_.velocity, request.velocity);
      shrink(wish_.acceleration, request.acceleration);
      shrink(braking(), request.deceleration);
      return choose_ramp(model_, request, *units_.module).has_value();
    });
  }

  /// Which of them the module does not have.
  RampObjection too_far(const OutOfReach& fault) const {
    const auto off = [&](PulsesPerSecond2 wished) { return std::abs(fault.wished - wished.value); };
    const bool is_braking = off(request_.deceleration) < off(request_.acceleration);
    const auto part = fault.is_velocity() ? Part::velocity
                      : is_braking        ? Part::deceleration
                                          : Part::acceleration;
    const auto& said = fault.is_velocity() ? wish_.velocity
                       : is_braking        ? braking()
                                           : wish_.acceleration;
    auto error = out_of_reach(said, units_, fault);
    error.hint.clear();
    if (fault.wished > fault.nearest) error.hint = hint_of_microsteps();
    return {part, std::move(error)};
  }

  /// A TMC429 whose ramp ticks are long may pass its target again and again, whatever its data
  /// sheet allows.
  std::vector<std::string> foreseen(const PlannedRamp& planned) const {
    constexpr double farthest = 8e6;
    if (model_.family != Family::tmc429) return {};
    auto twin = AxisTwin::of(model_);
    if (!twin || !twin->set(planned.choice.settings)) return {};
    const double way = std::min(3 * planned.ramp_up().microsteps + 1, farthest);
    twin->move_to({static_cast<std::int32_t>(way)});
    if (twin->time_to_arrival()) return {};
    return {
        "with these settings a move may not come to rest on its target; another acceleration "
        "does"};
  }

  const RampWish& wish_;
  AxisUnits units_;
  const Model& model_;
  RampRequest request_{};
};

}  // namespace

RampLength PlannedRamp::ramp_up() const {
  return ramp_length(choice.velocity, choice.acceleration, {choice.jerk});
}

tl::expected<RampRequest, RampObjection> ramp_request(const RampWish& wish, const AxisUnits& units,
                                                      std::int32_t present_bow) {
  return Planner(wish, units, present_bow).request();
}

tl::expected<PlannedRamp, RampObjection> plan_ramp(const RampWish& wish, const AxisUnits& units,
                                                   std::int32_t present_bow) {
  return Planner(wish, units, present_bow).plan();
}

}  // namespace tmcl::plan
