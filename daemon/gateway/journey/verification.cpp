#include "gateway/journey/verification.hpp"

#include <utility>
#include <vector>

#include "gateway/gateway.hpp"
#include "gateway/journey/measuring_course.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;

/// From here downward an address is looked for that no module has.
constexpr std::uint16_t greatest_free_address = 250;
constexpr int bytes_of_exchange = 18;
constexpr int bits_of_byte = 10;

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

GatewayAxis::Awaitable<void> Course::prepare() {
  auto checked = co_await check_course(axis(), request_.travel.has_value());
  if (!checked) co_return checked;
  options_.model = axis().module().model();
  const auto travel = co_await travel_of(axis(), request_.travel);
  if (!travel) co_return tl::unexpected(travel.error());
  options_.travel = *travel;
  const auto greatest = co_await greatest_rates(axis());
  if (!greatest) co_return tl::unexpected(greatest.error());
  options_.greatest_velocity = greatest->velocity;
  options_.greatest_acceleration = greatest->acceleration;
  options_.expected = axis().module().traits();
  options_.free_address = free_address_of(axis().bus());
  options_.strays = [this] { return axis().bus().link().counters().unexpected_replies; };
  options_.wire_time = wire_time(axis().bus());
  options_.tell = [this](const std::string& what) { tell(what); };
  auto settings = co_await keep_settings(axis(), tmcl::verify_parameters(*options_.model));
  if (!settings) co_return tl::unexpected(settings.error());
  options_.settings = std::move(*settings);
  co_return tmcl::Result<void>{};
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

}  // namespace

GatewayAxis::Awaitable<tmcl::Verification> verify_axis(std::shared_ptr<Gateway> gateway,
                                                       std::shared_ptr<GatewayAxis> axis,
                                                       VerificationRequest request) {
  auto ready = co_await axis->be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  // It is a movement for any client.
  request.permit.exceeds_limits = false;
  request.permit.ends_with_client = true;
  const ClaimOwner claim_owner{ClaimKind::verification, request.permit};
  auto begun = co_await begin_course(*gateway, axis, request.client, claim_owner);
  if (!begun) co_return tl::unexpected(std::move(begun.error()));
  Course course(axis, std::move(request));
  auto found = co_await course.carry_out();
  // It has given back what it had, unless something has ended it.
  auto before = found ? std::vector<tmcl::plan::Setting>{} : course.before();
  if (!found && !before.empty()) found.error().outcome = tmcl::Outcome::unknown;
  co_await end_course(gateway, axis, *begun, std::move(before));
  if (found) add_deadman(*found, axis->module().deadman());
  co_return found;
}

}  // namespace tmcld
