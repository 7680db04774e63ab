#include "gateway/authority/axis_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "gateway/authority/motors.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {
namespace {

using tmcl::Command;
using tmcl::Request;
namespace ap = tmcl::axis_parameter;

constexpr std::array<std::string_view, 4> speeds{
    "target_velocity", "max_velocity", "reference_search_speed", "reference_switch_speed"};
constexpr std::array<std::string_view, 3> currents{"max_current", "standby_current",
                                                   "boost_current"};
// Above it another current is used: nothing accelerates by it.
constexpr std::string_view no_acceleration = "acceleration_threshold";

constexpr std::string_view bow = "max_bow";

constexpr std::array<std::string_view, 5> keys{"max_velocity", "max_acceleration",
                                               "max_deceleration", "max_jerk", "max_current"};

// All brake by parameter 5, too, at least when they do not go to a position.
bool speeds_up(const tmcl::ParameterInfo& row) {
  return row.name.find("deceleration") == std::string_view::npos;
}
bool brakes(const tmcl::ParameterInfo& row) {
  return !speeds_up(row) || row.number == ap::max_acceleration;
}

/// It takes its value from where no host sees it, and that may be what is limited. Where a move
/// goes to is not.
bool sets_unseen(const tmcl::Intent& intent) {
  return intent.is_unseen && intent.motion != tmcl::Motion::to_position &&
         intent.motion != tmcl::Motion::by_distance;
}

/// By this request and no program: it is known what it will do.
bool moves(const Request& request) {
  const auto intent = intent_of(request);
  const bool is_of_motor =
      intent.subject == tmcl::Subject::motor || intent.subject == tmcl::Subject::several;
  const bool stops = intent.motion == tmcl::Motion::stops ||
                     (intent.sets == tmcl::Setpoint::velocity && request.value == 0);
  return intent.effect == tmcl::Effect::moves && is_of_motor && !sets_unseen(intent) && !stops;
}

}  // namespace

// ---- what is looked at -------------------------------------------------------------------------

bool AxisLimits::is_of_axis(const Request& request) const {
  return concerns(request, config_.address, module_.model());
}

bool AxisLimits::is_limited(std::uint8_t parameter) const {
  const auto* row = find_parameter(tmcl::axis_parameters(*module_.model()), parameter);
  return is_scale(parameter) || (row != nullptr && !limited_kinds(*row).empty());
}

std::vector<AxisLimits::Kind> AxisLimits::limited_kinds(const tmcl::ParameterInfo& row) const {
  const auto& limits = config_.motion_limits;
  if (row.access == tmcl::Access::read) return {};
  if (limits.velocity && std::ranges::count(speeds, row.name) != 0) return {Kind::velocity};
  if (limits.current && std::ranges::count(currents, row.name) != 0) return {Kind::current};
  if (limits.jerk && row.name == bow) return {Kind::jerk};
  if (dimension_of(row) != tmcl::Dimension::acceleration || row.name == no_acceleration) return {};
  std::vector<Kind> kinds;
  const bool is_for_both = !limits.deceleration;
  if (limits.acceleration && (is_for_both || speeds_up(row))) kinds.push_back(Kind::acceleration);
  if (limits.deceleration && brakes(row)) kinds.push_back(Kind::deceleration);
  return kinds;
}

std::vector<AxisLimits::Limited> AxisLimits::limited() const {
  std::vector<Limited> all;
  for (const auto& row : tmcl::axis_parameters(*module_.model()))
    for (const auto kind : limited_kinds(row)) all.push_back({&row, kind});
  return all;
}

std::vector<std::uint8_t> AxisLimits::scales() const {
  const auto& limits = config_.motion_limits;
  if (!limits.velocity && !limits.acceleration && !limits.deceleration && !limits.jerk) return {};
  auto all = tmcl::unit_parameters(*module_.model());
  const bool tells_microsteps = !config_.scale.unit.empty() && !config_.scale.microstep_resolution;
  if (tells_microsteps) all.push_back(ap::microstep_resolution);
  return all;
}

bool AxisLimits::is_scale(std::uint8_t parameter) const {
  const auto all = scales();
  return std::ranges::count(all, parameter) != 0;
}

// ---- before a request --------------------------------------------------------------------------

bool AxisLimits::matters(const Request& request) const {
  const bool is_unseen = sets_unseen(intent_of(request));
  if (request.command != Command::SAP && !moves(request) && !is_unseen) return false;
  if (!is_of_axis(request)) return false;
  const bool is_of_settings = request.command == Command::RSAP && module_.model() != nullptr;
  return !is_of_settings || is_limited(request.type);
}

bool AxisLimits::must_read(const Request& request) const {
  const bool is_decided_by_settings =
      matters(request) && module_.model() != nullptr && !sets_unseen(intent_of(request));
  const bool is_known = !values_.empty() && epoch_ == module_.settings_epoch();
  return is_decided_by_settings && !is_known;
}

tmcl::Script<tmcl::Result<void>> AxisLimits::check(Request request) {
  // What it turns at is not followed here.
  const bool is_scaling = request.command == Command::SAP && matters(request) &&
                          module_.model() != nullptr && is_scale(request.type);
  if (is_scaling) values_.clear();
  if (must_read(request)) co_await must(read());
  auto objection = this->objection(request);
  if (objection) co_return tl::unexpected(std::move(*objection));
  co_return tmcl::Result<void>{};
}

tmcl::Script<tmcl::Result<void>> AxisLimits::read() {
  auto numbers = scales();
  for (const auto& one : limited()) numbers.push_back(one.row->number);
  const auto epoch = module_.settings_epoch();
  auto read = co_await tmcl::verbs::get_all(config_.address, numbers);
  if (!read) {
    read.error().outcome = tmcl::Outcome::not_sent;
    co_return tl::unexpected(std::move(read.error()));
  }
  values_.clear();
  for (std::size_t i = 0; i < numbers.size(); ++i) values_.emplace(numbers[i], (*read)[i]);
  epoch_ = epoch;
  co_return tmcl::Result<void>{};
}

std::optional<tmcl::Error> AxisLimits::objection(const Request& request) const {
  if (!matters(request)) return std::nullopt;
  if (module_.model() == nullptr) {
    return error(
        "its module has not said what it is, or is of a model without a "
        "table: whether this is within its limits cannot be told",
        "take the limits out of its [[axis]]");
  }
  if (sets_unseen(intent_of(request))) {
    return error("it has limits, and whether this keeps them cannot be told",
                 "set the parameter to a value instead; see 'max_velocity' in the configuration");
  }
  std::optional<tmcl::Error> objection;
  if (request.command == Command::SAP) objection = objection_to_write(request.type, request.value);
  if (request.command == Command::ROR || request.command == Command::ROL)
    objection = objection_to_turn(request.value);
  return objection || !moves(request) ? objection : objection_to_settings();
}

/// What was beyond a limit before is another's fault, and may come nearer to it.
std::optional<tmcl::Error> AxisLimits::objection_to_write(std::uint8_t parameter,
                                                          std::int32_t value) const {
  if (!values_.contains(parameter)) return std::nullopt;
  auto after = values_;
  after[parameter] = value;
  for (const auto& [row, kind] : limited()) {
    const auto number = row->number;
    if (!exceeds(kind, after.at(number), after)) continue;
    if (number != parameter && exceeds(kind, values_.at(number), values_)) continue;
    return beyond(kind, std::string(row->name) + " would be", after.at(number), after);
  }
  return std::nullopt;
}

std::optional<tmcl::Error> AxisLimits::objection_to_turn(std::int32_t velocity) const {
  if (!config_.motion_limits.velocity || !exceeds(Kind::velocity, velocity, values_))
    return std::nullopt;
  return beyond(Kind::velocity, "it would turn at", velocity, values_);
}

std::optional<tmcl::Error> AxisLimits::objection_to_settings() const {
  if (config_.motion_limits.jerk &&
      find_parameter(tmcl::axis_parameters(*module_.model()), bow) == nullptr) {
    return error("its module makes no S-curves, so each of its ramps is above its limit of " +
                     in_words(Kind::jerk, limit(Kind::jerk)),
                 "take 'max_jerk' out of its [[axis]]");
  }
  for (const auto& [row, kind] : limited()) {
    const auto value = values_.at(row->number);
    if (row->number == ap::target_velocity || !exceeds(kind, value, values_)) continue;
    auto error = beyond(kind, "nothing moves it while its " + std::string(row->name) + " is", value,
                        values_);
    error.hint = fmt::format("set that {} first: 'tmclctl set {} {} ...'",
                             kind == Kind::jerk && value == 0 ? "from 1 on" : "lower", config_.name,
                             row->name);
    return error;
  }
  return std::nullopt;
}

tmcl::Script<tmcl::Result<AxisLimits::Greatest>> AxisLimits::greatest() {
  const auto& limits = config_.motion_limits;
  Greatest all;
  const auto& axis = config_.address;
  const auto may_move =
      co_await check({axis.module, Command::MVP, tmcl::move_type::absolute, axis.motor, 0});
  if (!may_move) co_return tl::unexpected(may_move.error());
  if (limits.velocity) all.velocity = static_cast<std::int32_t>(greatest(Kind::velocity, values_));
  for (const auto& [kind, is_limited] :
       {std::pair(Kind::acceleration, limits.acceleration.has_value()),
        std::pair(Kind::deceleration, limits.deceleration.has_value())}) {
    if (!is_limited) continue;
    const auto most = static_cast<std::int32_t>(greatest(kind, values_));
    all.acceleration = std::min(all.acceleration.value_or(most), most);
  }
  co_return all;
}

// ---- behind it ---------------------------------------------------------------------------------

void AxisLimits::note(const Request& request, const tmcl::Result<tmcl::Answer>& answer) {
  if (request.address != config_.address.module) return;
  if (request.command != Command::SAP) {
    // What restarts, programs and the like set is not seen.
    if (can_move(request) && !moves(request)) values_.clear();
    return;
  }
  const auto known = values_.find(request.type);
  if (request.motor != config_.address.motor || known == values_.end()) return;
  if (answer && !is_scale(request.type)) {
    known->second = request.value;
  } else {
    values_.clear();
  }
}

// ---- numbers and words -------------------------------------------------------------------------

tmcl::UserScale AxisLimits::scale_with(const Values& values) const {
  if (config_.scale.unit.empty()) return tmcl::microsteps_scale();
  const auto told = values.find(ap::microstep_resolution);
  const auto resolution = told == values.end()
                              ? *config_.scale.microstep_resolution
                              : std::clamp(told->second, 0, tmcl::max_microstep_resolution);
  return config_.scale.with_resolution(resolution);
}

double AxisLimits::unit_of(Kind kind, const Values& values) const {
  if (kind == Kind::current) return 1;
  const auto& model = *module_.model();
  std::vector<std::int32_t> units;
  for (const auto parameter : tmcl::unit_parameters(model)) units.push_back(values.at(parameter));
  // With a value that it cannot have: as it is after it was switched on.
  const auto module = tmcl::module_units(model, units).value_or(tmcl::initial_units(model));
  const auto scale = scale_with(values);
  const auto unit = kind == Kind::velocity ? to_user(module.velocity, scale).value
                                           : to_user(module.acceleration, scale).value;
  return std::abs(unit);
}

/// Without a bow an acceleration changes at once.
double AxisLimits::amount_of(Kind kind, std::int32_t value, const Values& values) const {
  if (kind != Kind::jerk) return std::abs(static_cast<double>(value)) * unit_of(kind, values);
  if (value < 1) return std::numeric_limits<double>::infinity();
  const auto pps3 = tmcl::to_pps3(std::min(value, tmcl::greatest_bow));
  return std::abs(to_user(tmcl::PulsesPerSecond2{pps3.value}, scale_with(values)).value);
}

double AxisLimits::limit(Kind kind) const {
  const auto& limits = config_.motion_limits;
  switch (kind) {
    case Kind::velocity: return *limits.velocity;
    case Kind::acceleration: return *limits.acceleration;
    case Kind::deceleration: return *limits.deceleration;
    case Kind::jerk: return *limits.jerk;
    case Kind::current: return *limits.current;
  }
  return 0;
}

/// The limit itself can be set, although it is rounded then.
double AxisLimits::greatest(Kind kind, const Values& values) const {
  constexpr double most = std::numeric_limits<std::int32_t>::max();
  return std::min(std::round(limit(kind) / unit_of(kind, values)), most);
}

bool AxisLimits::exceeds(Kind kind, std::int32_t value, const Values& values) const {
  if (kind == Kind::jerk) return amount_of(kind, value, values) > limit(kind);
  return std::abs(static_cast<double>(value)) > greatest(kind, values);
}

std::string AxisLimits::in_words(Kind kind, double value) const {
  if (kind == Kind::current) return tmcl::plain_number(value, 6);
  const auto& unit = config_.scale.unit;
  return fmt::format("{} {}/s{}", tmcl::plain_number(value, 6), unit.empty() ? "microsteps" : unit,
                     kind == Kind::velocity ? ""
                     : kind == Kind::jerk   ? "^3"
                                            : "^2");
}

tmcl::Error AxisLimits::beyond(Kind kind, const std::string& what, std::int32_t value,
                               const Values& values) const {
  const auto asked = amount_of(kind, value, values);
  const auto key = keys[static_cast<std::size_t>(kind)];
  return error(fmt::format("{} {}, above its limit of {}", what, in_words(kind, asked),
                           in_words(kind, limit(kind))),
               fmt::format("the configuration has it: '{}'", key));
}

tmcl::Error AxisLimits::error(std::string what, std::string hint) const {
  auto error = tmcl::not_sent(tmcl::Errc::not_permitted,
                              "axis '" + config_.name + "': " + std::move(what), std::move(hint));
  error.bus = config_.bus;
  return error;
}

}  // namespace tmcld
