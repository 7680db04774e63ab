#include "gateway/journey/jog.hpp"

#include <utility>
#include <vector>

#include <boost/asio/this_coro.hpp>

#include "async/spawn.hpp"
#include "gateway/axis/axis_range.hpp"
#include "gateway/journey/wished_run.hpp"
#include "tmcl/plan/ramp_limits.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using tmcl::plan::DriveFault;
using tmcl::plan::JogAxis;
using tmcl::plan::JogWish;

tmcl::Error cannot_be_foreseen(const GatewayAxis& axis) {
  return tmcl::bad_argument(
      "how far axis '" + axis.name() + "' goes until it stands cannot be foreseen",
      "its module does not tell what it counts in");
}

GatewayAxis::Awaitable<std::vector<tmcl::plan::Setting>> read_limits(GatewayAxis& axis,
                                                                     const tmcl::Model& model) {
  std::vector<tmcl::plan::Setting> settings;
  for (const auto parameter : tmcl::plan::ramp_limit_parameters(model)) {
    const auto value = co_await axis.get(parameter, {});
    if (!value) co_return tl::unexpected(value.error());
    settings.push_back({parameter, *value});
  }
  co_return settings;
}

GatewayAxis::Awaitable<JogAxis> look_at(GatewayAxis& axis, RunOptions options) {
  const auto units = co_await axis.module_units();
  if (!units) co_return tl::unexpected(units.error());
  const auto scale = co_await axis.scale();
  if (!scale) co_return tl::unexpected(scale.error());
  JogAxis known;
  known.model = axis.module().model();
  const bool needs_scale = axis.soft_limits() && !axis.unit().empty();
  if (known.model == nullptr || !*units || (needs_scale && !*scale))
    co_return tl::unexpected(cannot_be_foreseen(axis));
  known.units = **units;
  known.range = range_of(axis, scale->value_or(tmcl::microsteps_scale()));
  auto twin = co_await axis.twin(std::move(options));
  if (!twin) co_return tl::unexpected(twin.error());
  known.twin = std::move(*twin);
  if (known.twin) {
    known.ramp = axis.ramp_settings();
    co_return known;
  }
  auto limits = co_await read_limits(axis, *known.model);
  if (!limits) co_return tl::unexpected(limits.error());
  known.ramp = std::move(*limits);
  co_return known;
}

class JogRun final : public WishedRun {
 public:
  JogRun(const boost::asio::any_io_executor& executor, DriveMember member)
      : WishedRun(executor, std::move(member), ClaimKind::jog, GatewayEvent::Kind::jog_broken) {}

  /// See tmcl::plan::JogDrive.
  tmcl::Result<std::optional<std::uint64_t>> wish(JogWish wish) {
    auto number = drive_.wish(wish);
    woken_.notify();
    return number;
  }

  /// What has come of a wish.
  static awaitable<tmcl::Result<StartedJog>> outcome(std::shared_ptr<JogRun> self,
                                                     std::uint64_t wish) {
    auto carried_out = co_await WishedRun::outcome(self, wish);
    if (!carried_out) co_return tl::unexpected(std::move(carried_out.error()));
    co_return StartedJog{self->drive_.goal(), self->journal_failure()};
  }

  const tmcl::plan::DriveReport& report() const override { return drive_.report(); }

 private:
  tmcl::plan::Drive& what_drives() override { return drive_; }
  std::uint64_t carried_out() const override { return drive_.done(); }
  std::string what_it_is() const override { return "the jog of axis '" + axis().name() + "'"; }

  awaitable<tmcl::TimePoint> before_step() override {
    if (!std::exchange(has_looked_, true)) {
      auto known = co_await look_at(axis(), members_.front().movement);
      if (known) {
        drive_.know(std::move(*known));
      } else {
        drive_.stop({DriveFault::Kind::unsuited, 0, {}, std::move(known.error()), {}});
      }
    }
    co_return co_await WishedRun::before_step();
  }

  tmcl::plan::JogDrive drive_;
  bool has_looked_ = false;
};

/// The gateway leads an axis that is jogged, but only for a client that might move it itself.
std::optional<tmcl::Error> objection_to(const GatewayAxis& axis, const Permit& permit) {
  auto& motors = axis.bus().motors();
  if (auto objection = motors.objection(axis.address(), permit, axis.bus().clock().now()))
    return objection;
  const auto holder = axis.holder();
  if (holder.lease != 0 && holder.client == permit.client) return std::nullopt;
  return tmcl::not_sent(tmcl::Errc::not_permitted,
                        "axis '" + axis.name() + "' is jogged only under a lease",
                        "lease.acquire gives one; 'tmclctl jog " + axis.name() + "' has its own");
}

/// So much later than that held, a call does not go on with the one before.
constexpr auto latest_call = std::chrono::milliseconds(500);

/// A call that goes on with one that another client has stopped meanwhile is refused, and so are
/// those that go on with it: a key that is still held must not set the axis off again.
std::optional<tmcl::Error> stopped_since(GatewayAxis& axis, const JogOrder& order) {
  const auto& permit = order.movement.permit;
  const auto now = axis.bus().clock().now();
  auto& last = axis.last_jog();
  if (order.wish.velocity.value == 0) return last = {}, std::nullopt;
  const bool goes_on = last.client == permit.client && now <= last.until;
  const bool stopped = goes_on && axis.last_stop() > last.number;
  last = {permit.client, stopped ? last.number : permit.number,
          now + order.wish.hold + latest_call};
  if (!stopped) return std::nullopt;
  auto error = tmcl::not_sent(tmcl::Errc::superseded_by_stop,
                              "axis '" + axis.name() + "' was stopped while it was jogged",
                              "release the key, then jog it anew");
  error.bus = axis.bus().name();
  return error;
}

awaitable<tmcl::Result<StartedJog>> stand_there(const JogOrder& order) {
  auto here = co_await order.axis->get(tmcl::axis_parameter::actual_position, {});
  if (!here) co_return tl::unexpected(std::move(here.error()));
  co_return StartedJog{{{*here}, order.axis->bus().clock().now()}};
}

}  // namespace

awaitable<tmcl::Result<StartedJog>> jog(JogOrder order) {
  const auto& axis = order.axis;
  auto& permit = order.movement.permit;
  permit.ends_with_client = true;
  if (!std::dynamic_pointer_cast<JogRun>(axis->journey())) {
    // That another call moves it is reported first, with or without a lease.
    permit.needs_lease = false;
    auto free = co_await axis->be_free(order.movement);
    if (!free) co_return tl::unexpected(std::move(free.error()));
  }
  permit.needs_lease = true;
  if (auto objection = objection_to(*axis, permit)) co_return tl::unexpected(*objection);
  if (auto stop = stopped_since(*axis, order)) co_return tl::unexpected(*std::move(stop));
  if (const auto run = std::dynamic_pointer_cast<JogRun>(axis->journey())) {
    if (run->client() != permit.client) co_return tl::unexpected(axis->claimed());
    const auto number = run->wish(order.wish);
    if (!number) co_return tl::unexpected(error_of(*axis, number.error()));
    // One that ends takes none: another one begins.
    if (*number) co_return co_await JogRun::outcome(run, **number);
  }
  if (order.wish.velocity.value == 0) co_return co_await stand_there(order);
  const auto executor = co_await boost::asio::this_coro::executor;
  const auto run = std::make_shared<JogRun>(executor, DriveMember{axis, order.movement});
  const auto number = run->wish(order.wish);
  if (!number) co_return tl::unexpected(error_of(*axis, number.error()));
  spawn(executor, JogRun::run(run));
  co_return co_await JogRun::outcome(run, number->value());
}

}  // namespace tmcld
