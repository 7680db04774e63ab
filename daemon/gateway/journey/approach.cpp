#include "gateway/journey/approach.hpp"

#include <cmath>
#include <utility>

#include <boost/asio/this_coro.hpp>

#include "async/spawn.hpp"
#include "gateway/axis/axis_range.hpp"
#include "gateway/journey/wished_run.hpp"
#include "tmcl/plan/approach_drive.hpp"
#include "tmcl/scale_factor.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using tmcl::plan::Approach;

class ApproachRun final : public WishedRun {
 public:
  ApproachRun(const boost::asio::any_io_executor& executor, DriveMember member, Approach approach)
      : WishedRun(executor, std::move(member), ClaimKind::approach,
                  GatewayEvent::Kind::approach_broken),
        drive_(approach) {}

  std::optional<std::uint64_t> wish(Length target) {
    const auto number = drive_.wish(target.microsteps);
    if (number) target_ = target.microsteps;
    woken_.notify();
    return number;
  }

  const tmcl::plan::DriveReport& report() const override { return drive_.report(); }

 private:
  tmcl::plan::Drive& what_drives() override { return drive_; }
  std::uint64_t carried_out() const override { return drive_.done(); }
  std::string what_it_is() const override { return "the move of axis '" + axis().name() + "'"; }
  /// The deadline of the call is for its first move: the second one comes when that has ended.
  awaitable<tmcl::TimePoint> before_step() override {
    if (drive_.done() > 0) members_.front().admitted->deadline.reset();
    return WishedRun::before_step();
  }
  void aim(const DriveMember& member, tmcl::Microsteps place) const override {
    WishedRun::aim(member, place);
    axis().note_bound_for(target_);
  }
  void over() override { axis().note_bound_for({}); }

  tmcl::plan::ApproachDrive drive_;
  tmcl::Microsteps target_{};
};

GatewayAxis::Awaitable<Approach> approach_of(GatewayAxis& axis) {
  const auto& config = *axis.approach();
  const auto scale = co_await axis.known_scale();
  if (!scale) co_return tl::unexpected(scale.error());
  const double distance = std::ceil(config.distance * microsteps_per_unit(*scale));
  const auto range = range_of(axis, *scale);
  const double whole_range = static_cast<double>(range.greatest) - range.least;
  Approach approach;
  approach.upwards = config.from_below != scale->reverse;
  approach.distance =
      static_cast<std::int32_t>(std::min({distance, whole_range, static_cast<double>(INT32_MAX)}));
  approach.range = range;
  co_return approach;
}

/// Of both moves. Nothing if it does not come to rest.
std::optional<tmcl::Duration> time_of(const Approach& approach, tmcl::plan::AxisTwin twin,
                                      tmcl::Microsteps target) {
  const auto motion = twin.motion();
  const tmcl::InternalVelocity moves{motion.velocity.value == 0 ? 0 : 1};
  tmcl::Duration total{};
  for (const auto place : {first_stop(approach, motion.position, moves, target), target}) {
    twin.move_to(place);
    const auto time = twin.time_to_arrival();
    if (!time) return std::nullopt;
    twin.advance(*time);
    total += *time;
  }
  return total;
}

/// Nothing is foreseen where that fails: the move does not depend on it.
awaitable<StartedMove> foresee(const ApproachOrder& order, const Approach& approach) {
  StartedMove started{order.target.microsteps, std::nullopt};
  if (!order.predict) co_return started;
  auto twin = co_await order.axis->twin(order.movement);
  if (!twin) started.warnings.push_back("no prediction: " + twin.error().message);
  if (!twin || !*twin) co_return started;
  started.predicted = time_of(approach, **twin, started.target);
  (*twin)->move_to(started.target);
  for (auto& warning : order.axis->warnings_of(**twin))
    started.warnings.push_back(std::move(warning));
  if (!started.predicted)
    started.warnings.emplace_back("with these settings it does not come to rest on its target");
  co_return started;
}

/// The run of the same client that goes on, or another one.
awaitable<tmcl::Result<void>> send_off(const ApproachOrder& order, const Approach& approach) {
  const auto& axis = order.axis;
  if (const auto run = std::dynamic_pointer_cast<ApproachRun>(axis->journey())) {
    if (run->client() != order.movement.permit.client) co_return tl::unexpected(axis->claimed());
    if (const auto number = run->wish(order.target))
      co_return co_await WishedRun::outcome(run, *number);
  }
  const auto executor = co_await boost::asio::this_coro::executor;
  const auto run =
      std::make_shared<ApproachRun>(executor, DriveMember{axis, order.movement}, approach);
  const auto number = run->wish(order.target);
  spawn(executor, WishedRun::run(run));
  co_return co_await WishedRun::outcome(run, *number);
}

}  // namespace

awaitable<tmcl::Result<StartedMove>> approach(ApproachOrder order) {
  auto& axis = *order.axis;
  auto allowed = co_await axis.check_target(order.target, order.movement);
  if (!allowed) co_return tl::unexpected(std::move(allowed.error()));
  const auto how = co_await approach_of(axis);
  if (!how) co_return tl::unexpected(how.error());
  auto started = co_await foresee(order, *how);
  const auto begin = axis.bus().clock().now();
  auto sent = co_await send_off(order, *how);
  if (!sent) co_return tl::unexpected(std::move(sent.error()));
  axis.note_request(order.target);
  if (started.predicted) axis.expect_arrival(begin + *started.predicted);
  co_return started;
}

}  // namespace tmcld
