#include "gateway/journey/measuring_course.hpp"

#include <algorithm>
#include <utility>

#include "async/spawn.hpp"
#include "async/wait_until.hpp"
#include "gateway/authority/axis_limits.hpp"
#include "gateway/axis/axis_range.hpp"
#include "gateway/gateway.hpp"
#include "gateway/orphans.hpp"
#include "gateway/standing_stop.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;

/// Longer than any course.
constexpr tmcl::Duration lease_time = 60min;
/// What an answer waits for the axis to be in order: it is put there all the same.
constexpr tmcl::Duration time_to_put_in_order = 2s;

tl::unexpected<tmcl::Error> not_measurable(std::string message, std::string hint) {
  return tl::unexpected(tmcl::bad_argument(std::move(message), std::move(hint)));
}

awaitable<void> put_in_order(std::shared_ptr<Gateway> gateway, std::shared_ptr<GatewayAxis> axis,
                             std::shared_ptr<MeasuringCourse> course,
                             std::vector<tmcl::plan::Setting> before, std::shared_ptr<bool> ended) {
  if (!before.empty()) co_await be_stopped(*axis);
  for (const auto& setting : before) {
    // What has started again has its own.
    if (!axis->latched()) co_await set_back(*axis, setting.parameter);
  }
  axis->forget_before();
  axis->module().note_settings_changed();
  course->claims.clear();
  if (course->lease) gateway->leases()->release(*course->lease);
  *ended = true;
}

}  // namespace

GatewayAxis::Awaitable<std::shared_ptr<MeasuringCourse>> begin_course(
    Gateway& gateway, std::shared_ptr<GatewayAxis> axis, Client client, ClaimOwner claim_owner) {
  auto course = std::make_shared<MeasuringCourse>();
  const std::vector<std::shared_ptr<GatewayAxis>> axes{axis};
  const auto holder = axis->holder();
  const bool has_lease = holder.lease != 0 && holder.client == client.number;
  if (client.number != 0 && !has_lease) {
    const LeaseTerms terms{lease_time, true};
    auto acquired = Leases::acquire(gateway.leases(), client, axes, terms, claim_owner.of);
    const auto lease = co_await std::move(acquired);
    if (!lease) co_return tl::unexpected(lease.error());
    course->lease = lease->number;
  }
  auto claims = co_await claim_all(axes, claim_owner);
  if (!claims) {
    if (course->lease) gateway.leases()->release(*course->lease);
    co_return tl::unexpected(std::move(claims.error()));
  }
  course->claims = std::move(*claims);
  co_return course;
}

awaitable<void> end_course(std::shared_ptr<Gateway> gateway, std::shared_ptr<GatewayAxis> axis,
                           std::shared_ptr<MeasuringCourse> course,
                           std::vector<tmcl::plan::Setting> before) {
  const auto ended = std::make_shared<bool>(false);
  spawn(axis->bus().executor(), put_in_order(gateway, axis, course, std::move(before), ended));
  co_await wait_until([&] { return *ended; }, time_to_put_in_order);
}

GatewayAxis::Awaitable<void> check_course(GatewayAxis& axis, bool has_travel) {
  if (axis.module().model() == nullptr)
    co_return not_measurable("nothing is known of this model that it could be held against", {});
  if (!has_travel && !axis.soft_limits())
    co_return not_measurable("axis '" + axis.name() + "' has no soft limits",
                             "say how far it may go, such as --travel -2mm..2mm");
  // Before anything is read that would have to be given back.
  const auto velocity = co_await axis.get(tmcl::axis_parameter::actual_velocity, {});
  if (!velocity) co_return tl::unexpected(velocity.error());
  if (*velocity != 0) co_return not_measurable("axis '" + axis.name() + "' moves", "stop it first");
  co_return tmcl::Result<void>{};
}

GatewayAxis::Awaitable<tmcl::ValueRange> travel_of(GatewayAxis& axis,
                                                   std::optional<tmcl::ValueRange> travel) {
  const auto scale = co_await axis.scale();
  if (!scale) co_return tl::unexpected(scale.error());
  if (axis.soft_limits() && !axis.unit().empty() && !*scale)
    co_return not_measurable("the module does not tell its microstep resolution",
                             "the configuration can: 'microsteps'");
  const auto range = range_of(axis, scale->value_or(tmcl::microsteps_scale()));
  if (!travel) co_return range;
  const auto here = co_await axis.get(tmcl::axis_parameter::actual_position, {});
  if (!here) co_return tl::unexpected(here.error());
  const auto bounded = [&](std::int32_t by) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(
        std::int64_t{*here} + by, range.least, std::max(range.least, range.greatest)));
  };
  tmcl::ValueRange within = range;
  within.least = bounded(travel->least);
  within.greatest = bounded(travel->greatest);
  co_return within;
}

GatewayAxis::Awaitable<GreatestRates> greatest_rates(GatewayAxis& axis) {
  GreatestRates rates;
  const auto limits = axis.motion_limits();
  if (!limits) co_return rates;
  const auto units = co_await axis.module_units();
  if (!units) co_return tl::unexpected(units.error());
  const auto greatest = co_await axis.perform(limits->greatest(), {});
  if (!greatest) co_return tl::unexpected(greatest.error());
  if (!*units) co_return rates;
  if (const auto velocity = greatest->velocity)
    rates.velocity = tmcl::to_pps(tmcl::InternalVelocity{*velocity}, **units);
  if (const auto acceleration = greatest->acceleration)
    rates.acceleration = tmcl::PulsesPerSecond2{*acceleration * (*units)->acceleration.value};
  co_return rates;
}

GatewayAxis::Awaitable<std::vector<tmcl::plan::Setting>> keep_settings(
    GatewayAxis& axis, std::vector<std::uint8_t> parameters) {
  std::vector<tmcl::plan::Setting> settings;
  auto reading = tmcl::verbs::get_all(axis.address(), parameters);
  const auto values = co_await axis.perform(std::move(reading), {});
  if (!values) co_return tl::unexpected(values.error());
  for (std::size_t i = 0; i < parameters.size(); ++i)
    settings.push_back({parameters[i], (*values)[i]});
  for (const auto& setting : settings) axis.note_before(setting);
  co_await axis.enter_journal();
  co_return settings;
}

}  // namespace tmcld
