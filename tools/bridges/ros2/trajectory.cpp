#include "trajectory.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "joints.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/client.hpp"
#include "tmcl/hex.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl::ros2 {

namespace {

using Kind = Failure::Kind;

constexpr auto longest_answer = std::chrono::seconds(1);
/// tmcld tells nothing while it plans; of a path that is passed it tells five times a second.
constexpr auto longest_silence = std::chrono::seconds(30);
constexpr std::size_t bytes_at_once = 16'384;

tl::unexpected<Failure> failed(Kind kind, std::string text) {
  return tl::unexpected(Failure{kind, std::move(text)});
}

tl::unexpected<Failure> refused(const client::Error& error) {
  return failed(Kind::refused, error.message);
}

tl::expected<std::vector<std::string>, Failure> axes_of(const Trajectory& trajectory,
                                                        const TrajectoryChoices& choices) {
  std::vector<std::string> axes;
  const auto& joints = trajectory.joints;
  for (const auto& joint : joints) {
    const auto known = choices.axes.find(joint);
    if (known == choices.axes.end())
      return failed(Kind::bad_joints, "joint '" + joint + "' is not known here");
    if (std::ranges::count(joints, joint) > 1)
      return failed(Kind::bad_joints, "joint '" + joint + "' is named twice");
    axes.push_back(known->second);
  }
  for (const auto& [joint, tolerance] : trajectory.tolerances)
    if (std::ranges::count(joints, joint) == 0)
      return failed(Kind::bad_joints, "joint '" + joint + "' has a tolerance and no positions");
  if (axes.empty()) return failed(Kind::bad_joints, "the trajectory names no joints");
  return axes;
}

tl::expected<void, Failure> check(const Trajectory& trajectory) {
  if (trajectory.points.empty()) return failed(Kind::refused, "the trajectory has no points");
  double before_s = -1e-9;  // The first may be at 0 s.
  std::size_t number = 0;
  for (const auto& point : trajectory.points) {
    const auto name = "point " + std::to_string(++number);
    if (point.positions.size() != trajectory.joints.size())
      return failed(Kind::refused, name + " does not have a position for each joint");
    if (!std::ranges::all_of(point.positions, [](double place) { return std::isfinite(place); }))
      return failed(Kind::refused, name + " has a position that is no finite number");
    if (!(point.at_s > before_s))
      return failed(Kind::refused, name + " is not later than the one before it, or the start");
    before_s = point.at_s;
  }
  return {};
}

std::string row_of(double at_s, std::span<const double> places) {
  auto row = plain_number(at_s);
  for (const double place : places) row += ',' + plain_number(place);
  return row + '\n';
}

/// Calls of one trajectory, under one lease.
class Passing {
 public:
  Passing(client::Caller caller, std::vector<std::string> axes,
          const std::function<bool()>& cancelled)
      : caller_(std::move(caller)), axes_(std::move(axes)), cancelled_(cancelled) {}

  tl::expected<void, Failure> pass(const Trajectory& trajectory, const TrajectoryChoices& choices);

 private:
  tl::expected<void, Failure> take_lease(double ttl_s);
  tl::expected<void, Failure> look_at_axes();
  std::string table_of(const Trajectory& trajectory) const;
  std::optional<double> deviation_of(const Trajectory& trajectory) const;
  tl::expected<void, Failure> hand_over(const std::string& table);
  tl::expected<std::int32_t, Failure> plan(const Trajectory& trajectory, double period_s);
  tl::expected<void, Failure> run(std::int32_t plan);

  client::Caller caller_;
  const std::vector<std::string> axes_;
  const std::function<bool()>& cancelled_;
  api::lease::OnLease lease_;
  std::vector<double> si_per_unit_, places_;  ///< Of each axis; places in its unit.
};

tl::expected<void, Failure> Passing::take_lease(double ttl_s) {
  const auto granted = caller_.call(api::lease::Acquire{axes_, std::llround(ttl_s * 1000), {}});
  if (!granted) return refused(granted.error());
  lease_ = {.lease = granted->lease, .epoch = granted->epoch};
  caller_.use_lease(lease_);
  return {};
}

tl::expected<void, Failure> Passing::look_at_axes() {
  for (const auto& axis : axes_) {
    const auto si = si_per_unit(caller_, axis);
    if (!si) return failed(Kind::refused, si.error());
    const auto state = caller_.axis(axis).state();
    if (!state) return refused(state.error());
    if (!state->position)
      return failed(Kind::refused, "axis '" + axis + "': tmcld tells no position");
    si_per_unit_.push_back(*si);
    places_.push_back(*state->position);
  }
  return {};
}

std::string Passing::table_of(const Trajectory& trajectory) const {
  std::string table = "t";
  for (std::size_t i = 0; i < axes_.size(); ++i) table += ",joint" + std::to_string(i + 1);
  table += '\n';
  if (trajectory.points.front().at_s > 0) table += row_of(0, places_);
  for (const auto& point : trajectory.points) {
    auto places = point.positions;
    for (std::size_t i = 0; i < places.size(); ++i) places[i] /= si_per_unit_[i];
    table += row_of(point.at_s, places);
  }
  return table;
}

/// tmcld has one for all axes, each in its unit.
std::optional<double> Passing::deviation_of(const Trajectory& trajectory) const {
  std::optional<double> least;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto found = trajectory.tolerances.find(trajectory.joints[i]);
    const double deviation =
        found == trajectory.tolerances.end() ? 0 : found->second / si_per_unit_[i];
    if (deviation > 0) least = std::min(least.value_or(deviation), deviation);
  }
  return least;
}

tl::expected<void, Failure> Passing::hand_over(const std::string& table) {
  for (std::size_t offset = 0; offset < table.size(); offset += bytes_at_once) {
    const auto part = table.substr(offset, bytes_at_once);
    const std::vector<std::uint8_t> bytes(part.begin(), part.end());
    const auto taken =
        caller_.call(api::path::Stage{static_cast<std::int32_t>(offset), to_hex(bytes)});
    if (!taken) return refused(taken.error());
  }
  return {};
}

tl::expected<std::int32_t, Failure> Passing::plan(const Trajectory& trajectory, double period_s) {
  const auto table = table_of(trajectory);
  if (auto handed = hand_over(table); !handed) return tl::unexpected(handed.error());
  api::path::Plan wish;
  wish.axes = axes_;
  wish.bytes = static_cast<std::uint32_t>(table.size());
  wish.format = "csv";
  wish.deviation = deviation_of(trajectory);
  wish.period_ms = static_cast<std::int32_t>(std::lround(period_s * 1000));
  wish.name = "trajectory";
  const auto planned = caller_.call(wish, {.timeout = longest_silence, .meanwhile = {}});
  if (!planned) return refused(planned.error());
  return planned->plan;
}

Failure end_of(const client::Error& error, bool is_cancelled) {
  const bool unknown = error.outcome == Outcome::unknown;
  if (is_cancelled && !unknown) return {Kind::cancelled, error.message};
  if (error.outcome == Outcome::not_sent) return {Kind::refused, error.message};
  if (unknown) return {Kind::ended_early, error.message + "; axes may still move"};
  return {error.name == "not_at_end" ? Kind::not_at_end : Kind::ended_early, error.message};
}

tl::expected<void, Failure> Passing::run(std::int32_t plan) {
  api::path::Run wish;
  wish.plan = plan;
  bool is_cancelled = false, is_stopped = false;
  const auto look = [&] {
    static_cast<void>(caller_.call(api::lease::Renew{lease_}));  // One that is lost ends the path.
    is_cancelled = is_cancelled || cancelled_();
    // An error while the path has not begun: then it is stopped the next time.
    if (is_cancelled && !is_stopped)
      is_stopped = caller_.call(api::path::Stop{{axes_}}).has_value();
  };
  const auto passed = caller_.call(wish, {.timeout = longest_silence, .meanwhile = look});
  // tmcld has stopped them. What it has refused to begin may move for another client.
  const bool stop = !passed && passed.error().outcome == Outcome::unknown;
  static_cast<void>(caller_.call(api::lease::Release{lease_, stop}));
  if (!passed) return tl::unexpected(end_of(passed.error(), is_cancelled));
  return {};
}

tl::expected<void, Failure> Passing::pass(const Trajectory& trajectory,
                                          const TrajectoryChoices& choices) {
  if (auto looked = look_at_axes(); !looked) return looked;
  const auto planned = plan(trajectory, choices.period_s);
  if (!planned) return tl::unexpected(planned.error());
  if (cancelled_()) return failed(Kind::cancelled, "cancelled before anything moved");
  if (auto leased = take_lease(choices.lease_ttl_s); !leased) return leased;
  return run(*planned);
}

}  // namespace

tl::expected<void, Failure> carry_out(const Trajectory& trajectory,
                                      const TrajectoryChoices& choices,
                                      const std::function<bool()>& cancelled) {
  auto axes = axes_of(trajectory, choices);
  if (!axes) return tl::unexpected(axes.error());
  if (auto checked = check(trajectory); !checked) return checked;
  auto caller = client::Caller::open(
      choices.socket,
      {.wait_for_socket = {}, .hello_timeout = longest_answer, .call_timeout = longest_answer});
  if (!caller) return refused(caller.error());
  return Passing(std::move(*caller), std::move(*axes), cancelled).pass(trajectory, choices);
}

}  // namespace tmcl::ros2
