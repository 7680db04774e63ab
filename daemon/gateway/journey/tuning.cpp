#include "gateway/journey/tuning.hpp"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gateway/gateway.hpp"
#include "gateway/journey/measuring_course.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcld {
namespace {

constexpr auto max_current = tmcl::number_of("max_current");

class TuningCourse {
 public:
  TuningCourse(std::shared_ptr<GatewayAxis> axis, TuningRequest request)
      : axis_(std::move(axis)), request_(std::move(request)) {}

  GatewayAxis::Awaitable<tmcl::Tuning> carry_out();
  /// What the axis had; empty if nothing was to be changed yet.
  const std::vector<tmcl::plan::Setting>& before() const { return options_.settings; }

 private:
  GatewayAxis::Awaitable<void> prepare();
  tmcl::Result<void> check_reference() const;
  tmcl::Result<void> check_current() const;
  GatewayAxis& axis() const { return *axis_; }

  std::shared_ptr<GatewayAxis> axis_;
  TuningRequest request_;
  tmcl::TuneOptions options_;
};

/// Soft limits mean something only then.
tmcl::Result<void> TuningCourse::check_reference() const {
  if (!axis().soft_limits() || axis().is_referenced()) return {};
  return tl::unexpected(tmcl::not_sent(
      tmcl::Errc::latched,
      "axis '" + axis().name() + "' has not searched its reference, and has soft limits",
      "'tmclctl home " + axis().name() + "' does that"));
}

tmcl::Result<void> TuningCourse::check_current() const {
  const auto* row = find_parameter(axis().parameters(), max_current);
  if (row == nullptr)
    return tl::unexpected(tmcl::bad_argument("nothing is known of a current of this model"));
  if (request_.max_current >= 1 && request_.max_current <= row->maximum) return {};
  return tl::unexpected(tmcl::bad_argument(
      fmt::format("a current of {} is not within 1 to {}", request_.max_current, row->maximum),
      "it is that of parameter 6, max_current"));
}

GatewayAxis::Awaitable<void> TuningCourse::prepare() {
  auto checked = co_await check_course(axis(), request_.travel.has_value());
  if (!checked) co_return checked;
  auto referenced = check_reference();
  if (!referenced) co_return referenced;
  auto current = check_current();
  if (!current) co_return current;
  const auto travel = co_await travel_of(axis(), request_.travel);
  if (!travel) co_return tl::unexpected(travel.error());
  const auto greatest = co_await greatest_rates(axis());
  if (!greatest) co_return tl::unexpected(greatest.error());
  const auto units = co_await axis().module_units();
  if (!units) co_return tl::unexpected(units.error());
  if (!*units)
    co_return tl::unexpected(tmcl::bad_argument("the module does not tell what it counts in"));
  options_.units.axis = axis().name();
  options_.units.model = axis().module().model();
  options_.units.module = *units;
  options_.travel = *travel;
  options_.greatest_velocity = greatest->velocity;
  options_.greatest_acceleration = greatest->acceleration;
  options_.max_current = request_.max_current;
  options_.margin = request_.margin;
  options_.by_switch = request_.by_switch;
  options_.tell = [this](const std::string& what) {
    // What its numbers mean changes.
    axis().module().note_settings_changed();
    request_.tell(what);
  };
  const bool can_tell = options_.by_switch || tmcl::tune_encoder(*options_.units.model);
  if (!can_tell) co_return tmcl::Result<void>{};
  auto settings = co_await keep_settings(axis(), tmcl::tune_parameters(*options_.units.model));
  if (!settings) co_return tl::unexpected(settings.error());
  options_.settings = std::move(*settings);
  co_return tmcl::Result<void>{};
}

GatewayAxis::Awaitable<tmcl::Tuning> TuningCourse::carry_out() {
  auto admitted =
      co_await axis().admit(action::FollowPath{}, axis().begin_movement(request_.permit, {}));
  if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
  auto ready = co_await prepare();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  RunOptions movement = std::move(*admitted);
  auto script = tmcl::verbs::tune(axis().address(), options_);
  auto found = co_await axis().perform(std::move(script), std::move(movement));
  // What ended it may have come between lost steps and their correction.
  const bool is_lost = found ? found->lost_steps : !before().empty();
  if (is_lost) axis().bus().motors().set_referenced(axis().address(), false);
  co_return found;
}

}  // namespace

GatewayAxis::Awaitable<TunedAxis> tune_axis(std::shared_ptr<Gateway> gateway,
                                            std::shared_ptr<GatewayAxis> axis,
                                            TuningRequest request) {
  auto ready = co_await axis->be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  // It is a movement for any client.
  request.permit.exceeds_limits = false;
  request.permit.ends_with_client = true;
  const ClaimOwner claim_owner{ClaimKind::tuning, request.permit};
  auto begun = co_await begin_course(*gateway, axis, request.client, claim_owner);
  if (!begun) co_return tl::unexpected(std::move(begun.error()));
  TuningCourse course(axis, std::move(request));
  auto found = co_await course.carry_out();
  // It has given back what it had, unless something has ended it.
  const auto before = course.before();
  if (!found && !before.empty()) found.error().outcome = tmcl::Outcome::unknown;
  std::vector<tmcl::plan::Setting> not_given_back;
  if (!found) not_given_back = before;
  auto ending = end_course(gateway, axis, *begun, std::move(not_given_back));
  co_await std::move(ending);
  if (!found) co_return tl::unexpected(std::move(found.error()));
  TunedAxis tuned{std::move(*found), before};
  co_return tuned;
}

}  // namespace tmcld
