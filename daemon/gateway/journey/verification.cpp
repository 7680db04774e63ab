#include "gateway/journey/verification.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "async/spawn.hpp"
#include "async/wait_until.hpp"
#include "gateway/authority/axis_limits.hpp"
#include "gateway/authority/claim.hpp"
#include "gateway/axis/axis_range.hpp"
#include "gateway/gateway.hpp"
#include "gateway/orphans.hpp"
#include "gateway/standing_stop.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;

/// Longer than any course.
constexpr tmcl::Duration lease_time = 10min;
/// What an answer waits for the axis to be in order: it is put there all the same.
constexpr tmcl::Duration time_to_put_in_order = 2s;
/// From here downward an address is looked for that no module has.
constexpr std::uint16_t greatest_free_address = 250;
constexpr int bytes_of_exchange = 18;
constexpr int bits_of_byte = 10;

tl::unexpected<tmcl::Error> impossible(std::string message, std::string hint) {
  return tl::unexpected(tmcl::bad_argument(std::move(message), std::move(hint)));
}

std::optional<tmcl::ModuleAddress> free_address_of(const GatewayBus& bus) {
  if (bus.is_can()) return std::nullopt;
  for (auto address = greatest_free_address; address > 0; --address) {
    const bool is_host = address == bus.config().bus_options.host_address;
    if (!is_host && bus.find_module(tmcl::ModuleAddress{address}) == nullptr)
      return tmcl::ModuleAddress{address};
  }
  return std::nullopt;
}

tmcl::Duration wire_time(const GatewayBus& bus) {
  const auto* serial = std::get_if<tmcl::SerialName>(&bus.config().link);
  if (serial == nullptr || serial->baud == 0) return {};
  return tmcl::Duration(1s) * bytes_of_exchange * bits_of_byte / serial->baud;
}

class Course {
 public:
  Course(std::shared_ptr<GatewayAxis> axis, VerificationRequest request)
      : axis_(std::move(axis)), request_(std::move(request)) {}

  GatewayAxis::Awaitable<tmcl::Verification> carry_out();
  /// What the axis had; empty if nothing was to be changed yet.
  const std::vector<tmcl::plan::Setting>& before() const { return options_.settings; }

 private:
  GatewayAxis::Awaitable<void> prepare();
  GatewayAxis::Awaitable<void> read_settings();
  GatewayAxis::Awaitable<void> find_travel();
  GatewayAxis::Awaitable<void> find_limits();
  void tell(const std::string& what) const;
  GatewayAxis& axis() const { return *axis_; }

  std::shared_ptr<GatewayAxis> axis_;
  VerificationRequest request_;
  tmcl::VerifyOptions options_;
};

void Course::tell(const std::string& what) const {
  // What its numbers mean changes.
  axis().module().note_settings_changed();
  request_.tell(what);
}

GatewayAxis::Awaitable<void> Course::find_travel() {
  const auto scale = co_await axis().scale();
  if (!scale) co_return tl::unexpected(scale.error());
  if (axis().soft_limits() && !axis().unit().empty() && !*scale)
    co_return impossible("the module does not tell its microstep resolution",
                         "the configuration can: 'microsteps'");
  options_.travel = range_of(axis(), scale->value_or(tmcl::microsteps_scale()));
  if (!request_.travel) co_return tmcl::Result<void>{};
  const auto here = co_await axis().get(tmcl::axis_parameter::actual_position, {});
  if (!here) co_return tl::unexpected(here.error());
  auto& travel = options_.travel;
  const auto bounded = [&](std::int32_t by) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(
        std::int64_t{*here} + by, travel.least, std::max(travel.least, travel.greatest)));
  };
  travel = {bounded(request_.travel->least), bounded(request_.travel->greatest)};
  co_return tmcl::Result<void>{};
}

GatewayAxis::Awaitable<void> Course::find_limits() {
  const auto limits = axis().motion_limits();
  if (!limits) co_return tmcl::Result<void>{};
  const auto units = co_await axis().module_units();
  if (!units) co_return tl::unexpected(units.error());
  const auto greatest = co_await axis().perform(limits->greatest(), {});
  if (!greatest) co_return tl::unexpected(greatest.error());
  if (!*units) co_return tmcl::Result<void>{};
  if (const auto velocity = greatest->velocity)
    options_.greatest_velocity = tmcl::to_pps(tmcl::InternalVelocity{*velocity}, **units);
  if (const auto acceleration = greatest->acceleration)
    options_.greatest_acceleration =
        tmcl::PulsesPerSecond2{*acceleration * (*units)->acceleration.value};
  co_return tmcl::Result<void>{};
}

/// From here on they are given back, also by the next tmcld if this one is killed.
GatewayAxis::Awaitable<void> Course::read_settings() {
  const auto parameters = tmcl::verify_parameters(*options_.model);
  const auto values =
      co_await axis().perform(tmcl::verbs::get_all(axis().address(), parameters), {});
  if (!values) co_return tl::unexpected(values.error());
  for (std::size_t i = 0; i < parameters.size(); ++i)
    options_.settings.push_back({parameters[i], (*values)[i]});
  for (const auto& setting : options_.settings) axis().note_before(setting);
  co_await axis().enter_journal();
  co_return tmcl::Result<void>{};
}

GatewayAxis::Awaitable<void> Course::prepare() {
  options_.model = axis().module().model();
  if (options_.model == nullptr)
    co_return impossible("nothing is known of this model that it could be held against", {});
  if (!request_.travel && !axis().soft_limits())
    co_return impossible("axis '" + axis().name() + "' has no soft limits",
                         "say how far it may go, such as --travel -2mm..2mm");
  // Before anything is read that would have to be given back.
  const auto velocity = co_await axis().get(tmcl::axis_parameter::actual_velocity, {});
  if (!velocity) co_return tl::unexpected(velocity.error());
  if (*velocity != 0) co_return impossible("axis '" + axis().name() + "' moves", "stop it first");
  auto travel = co_await find_travel();
  if (!travel) co_return travel;
  auto limits = co_await find_limits();
  if (!limits) co_return limits;
  options_.expected = axis().module().traits();
  options_.free_address = free_address_of(axis().bus());
  options_.strays = [this] { return axis().bus().counters().unexpected_replies; };
  options_.wire_time = wire_time(axis().bus());
  options_.tell = [this](const std::string& what) { tell(what); };
  auto settings = co_await read_settings();
  co_return settings;
}

GatewayAxis::Awaitable<tmcl::Verification> Course::carry_out() {
  auto admitted =
      co_await axis().admit(action::FollowPath{}, axis().begin_movement(request_.permit, {}));
  if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
  auto ready = co_await prepare();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  RunOptions movement = std::move(*admitted);
  auto script = tmcl::verbs::verify(axis().address(), options_);
  auto found = co_await axis().perform(std::move(script), std::move(movement));
  if (found && axis().bus().is_can()) found->answer.reset();
  co_return found;
}

/// What a test of its deadman has found, if there was one.
void add_deadman(tmcl::Verification& found, const Deadman& deadman) {
  const auto stops_after = deadman.stops_after_ms();
  if (!stops_after || !deadman.is_set()) return;
  for (auto& finding : found.traits) {
    if (finding.trait != tmcl::Trait::heartbeat) continue;
    const bool stops = *stops_after > 0;
    finding.measured = true;
    finding.fits = {tmcl::index_of(stops ? tmcl::Heartbeat::stops : tmcl::Heartbeat::ignored)};
    finding.text = stops ? "its motor stopped " + std::to_string(*stops_after) +
                               " ms after the last command, in a test of its deadman"
                         : "its motor went on, in a test of its deadman";
  }
}

struct Held {
  std::vector<Claim> claims;
  std::optional<std::int32_t> lease;
};

awaitable<void> put_in_order(std::shared_ptr<Gateway> gateway, std::shared_ptr<GatewayAxis> axis,
                             std::shared_ptr<Held> held, std::vector<tmcl::plan::Setting> before,
                             std::shared_ptr<bool> ended) {
  if (!before.empty()) co_await be_stopped(*axis);
  for (const auto& setting : before) {
    // What has started again has its own.
    if (!axis->latched()) co_await set_back(*axis, setting.parameter);
  }
  axis->forget_before();
  axis->module().note_settings_changed();
  held->claims.clear();
  if (held->lease) gateway->leases()->release(*held->lease);
  *ended = true;
}

GatewayAxis::Awaitable<std::shared_ptr<Held>> take(Gateway& gateway,
                                                   std::shared_ptr<GatewayAxis> axis,
                                                   const VerificationRequest& request) {
  auto held = std::make_shared<Held>();
  const std::vector<std::shared_ptr<GatewayAxis>> axes{axis};
  const auto holder = axis->holder();
  const bool has_lease = holder.lease != 0 && holder.client == request.client.number;
  if (request.client.number != 0 && !has_lease) {
    const LeaseTerms terms{lease_time, true};
    auto acquired = Leases::acquire(gateway.leases(), request.client, axes, terms, request.permit);
    const auto lease = co_await std::move(acquired);
    if (!lease) co_return tl::unexpected(lease.error());
    held->lease = lease->number;
  }
  const ClaimOwner claim_owner{ClaimKind::verification, request.permit};
  auto claims = co_await claim_all(axes, claim_owner);
  if (!claims) {
    if (held->lease) gateway.leases()->release(*held->lease);
    co_return tl::unexpected(std::move(claims.error()));
  }
  held->claims = std::move(*claims);
  co_return held;
}

}  // namespace

GatewayAxis::Awaitable<tmcl::Verification> verify_axis(std::shared_ptr<Gateway> gateway,
                                                       std::shared_ptr<GatewayAxis> axis,
                                                       VerificationRequest request) {
  auto ready = co_await axis->be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  // It is a movement for any client.
  request.permit.exceeds_limits = false;
  request.permit.ends_with_client = true;
  auto held = co_await take(*gateway, axis, request);
  if (!held) co_return tl::unexpected(std::move(held.error()));
  Course course(axis, std::move(request));
  auto found = co_await course.carry_out();
  // It has given back what it had, unless something has ended it.
  auto before = found ? std::vector<tmcl::plan::Setting>{} : course.before();
  if (!found && !before.empty()) found.error().outcome = tmcl::Outcome::unknown;
  const auto ended = std::make_shared<bool>(false);
  spawn(axis->bus().executor(), put_in_order(gateway, axis, *held, std::move(before), ended));
  co_await wait_until([&] { return *ended; }, time_to_put_in_order);
  if (found) add_deadman(*found, axis->module().deadman());
  co_return found;
}

}  // namespace tmcld
