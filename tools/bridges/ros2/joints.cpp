#include "joints.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

namespace tmcl::ros2 {

namespace {

using namespace std::chrono_literals;

constexpr Duration period = 20ms;
constexpr std::uint16_t cached_ms = 100;  // So old is what tmcld says without asking the module.
constexpr Duration fresh = 1500ms;        // Within two seconds ROS 2 has to know of a loss.
constexpr Duration longest_call = 1s;
constexpr std::int64_t deadline_ms = 500;  // What tmcld cannot send so soon moves nothing.
constexpr Duration renewal = 300ms;
constexpr Duration silence = 1s;  // After that without a command the lease may run out.

const std::map<std::string, double> radians_or_metres{{"m", 1},
                                                      {"mm", 1e-3},
                                                      {"um", 1e-6},
                                                      {"rad", 1},
                                                      {"mrad", 1e-3},
                                                      {"deg", std::numbers::pi / 180},
                                                      {"\u00b0", std::numbers::pi / 180}};
/// Faults that a module does not recover from by itself; others are warnings.
const std::set<std::string> broken{"overtemperature", "short_to_ground_a", "short_to_ground_b",
                                   "undervoltage", "overvoltage"};
/// Why an axis stands short of its target, where that was not wanted.
const std::set<std::string> alarming{"left_limit", "right_limit", "search_limit", "stall",
                                     "deviation",  "deadman",     "supply"};

tl::unexpected<std::string> about(const std::string& axis, const std::string& what) {
  return tl::unexpected("axis '" + axis + "': " + what);
}

/// Why a state is none to go on with; empty if it is one.
std::string trouble_in(const api::axis::State& state) {
  if (state.latched) return "its module has started again: recover it, or search its reference";
  for (const auto& fault : state.faults)
    if (broken.contains(fault)) return "its driver reports " + fault;
  return state.position ? "" : "tmcld tells no position";
}

}  // namespace

tl::expected<double, std::string> si_per_unit(client::Caller& caller, const std::string& axis) {
  const auto units = caller.axis(axis).units();
  if (!units) return about(axis, units.error().message);
  const auto name = units->unit.value_or("");
  const auto known = radians_or_metres.find(name);
  if (known == radians_or_metres.end())
    return about(axis, "its unit '" + name + "' is no length or angle");
  return known->second;
}

Joints::Joints(Choices choices) : choices_(std::move(choices)) {
  for (const auto& axis : choices_.axes) joints_.push_back({.axis = axis});
}

tl::expected<void, std::string> Joints::open() {
  const std::scoped_lock calls(calls_);
  client::Options options{
      .wait_for_socket = {}, .hello_timeout = longest_call, .call_timeout = longest_call};
  auto caller = client::Caller::open(choices_.socket, std::move(options));
  if (!caller) return tl::unexpected(caller.error().message);
  caller_.emplace(std::move(*caller));
  for (auto& joint : joints_) {
    const auto si = si_per_unit(*caller_, joint.axis);
    if (!si) return tl::unexpected(si.error());
    joint.si_per_unit = *si;
    if (auto seen = look(joint, {}); !seen) return seen;
  }
  worker_ = std::jthread([this](const std::stop_token& ending) { follow(ending); });
  return {};
}

tl::expected<void, std::string> Joints::look(Joint& joint,
                                             std::optional<std::uint16_t> may_be_old_ms) {
  const auto asked = clock_.now();
  const auto state =
      caller_->call(api::axis::GetState{.axis = joint.axis, .max_age_ms = may_be_old_ms});
  if (!state) return about(joint.axis, state.error().message);
  if (const auto trouble = trouble_in(*state); !trouble.empty()) return about(joint.axis, trouble);
  const std::scoped_lock data(data_);
  const auto before = std::exchange(joint.stop_cause, state->stop_cause.value_or(""));
  if (lease_ && state->last_stop != joint.last_stop)
    return about(joint.axis, "it was stopped by another client, or by tmcld itself");
  if (lease_ && joint.stop_cause != before && alarming.contains(joint.stop_cause))
    return about(joint.axis, "it stands short of its target: " + joint.stop_cause);
  joint.reading.position = *state->position * joint.si_per_unit;
  joint.reading.velocity = state->velocity.value_or(unknown) * joint.si_per_unit;
  joint.seen = asked - std::chrono::milliseconds(state->age_ms);
  joint.moving = state->moving;
  joint.last_stop = state->last_stop;
  return {};
}

tl::expected<std::vector<double>, std::string> Joints::stand() {
  std::vector<double> places;
  for (auto& joint : joints_) {
    if (auto seen = look(joint, {}); !seen) return tl::unexpected(seen.error());
    if (joint.moving) return about(joint.axis, "it moves for another client");
    joint.wanted = joint.sent = joint.reading.position;
    places.push_back(joint.sent);
  }
  return places;
}

tl::expected<std::vector<double>, std::string> Joints::take() {
  const std::scoped_lock calls(calls_);
  // First: what has a lease is stopped with that.
  if (auto before = stand(); !before) return before;
  api::lease::Acquire wish{};
  wish.axes = choices_.axes;
  wish.ttl_ms = std::llround(choices_.lease_ttl_s * 1000);
  const auto granted = caller_->call(wish);
  if (!granted) return tl::unexpected(granted.error().message);
  lease_ = api::lease::OnLease{.lease = granted->lease, .epoch = granted->epoch};
  asked_ = renewed_ = clock_.now();
  return stand();
}

tl::expected<void, std::string> Joints::give() {
  const std::scoped_lock calls(calls_);
  if (!lease_) return {};
  api::lease::Release release{};
  static_cast<api::lease::OnLease&>(release) = *std::exchange(lease_, {});
  if (auto given = caller_->call(release); !given) return tl::unexpected(given.error().message);
  return {};
}

tl::expected<std::vector<Reading>, std::string> Joints::read() {
  const auto now = clock_.now();
  const std::scoped_lock data(data_);
  if (!failure_.empty()) return tl::unexpected(failure_);
  std::vector<Reading> readings;
  for (const auto& joint : joints_) {
    const auto age = now - joint.seen;
    if (age > fresh) return about(joint.axis, "tmcld has told nothing of it for 1.5 s");
    readings.push_back(joint.reading);
    readings.back().age_s = std::chrono::duration<double>(age).count();
  }
  return readings;
}

tl::expected<void, std::string> Joints::command(std::span<const double> positions) {
  const std::scoped_lock data(data_);
  asked_ = clock_.now();
  if (!failure_.empty()) return tl::unexpected(failure_);
  for (std::size_t i = 0; i < joints_.size() && i < positions.size(); ++i)
    if (std::isfinite(positions[i])) joints_[i].wanted = positions[i];
  return {};
}

tl::expected<void, std::string> Joints::send(Joint& joint) {
  {
    const std::scoped_lock data(data_);
    // The command of a loop that hung is an old one.
    const bool is_new = joint.wanted != joint.sent && clock_.now() - asked_.load() < silence;
    if (!lease_ || !is_new) return {};
    joint.sent = joint.wanted;
  }
  const auto moved = caller_->call(api::axis::MoveTo{.axis = joint.axis,
                                                     .position_microsteps = {},
                                                     .position = joint.sent / joint.si_per_unit,
                                                     .predict = false,
                                                     .deadline_ms = deadline_ms});
  if (!moved) return about(joint.axis, moved.error().message);
  return {};
}

tl::expected<void, std::string> Joints::keep_lease() {
  const auto now = clock_.now();
  if (!lease_ || now - renewed_ < renewal || now - asked_.load() > silence) return {};
  api::lease::Renew renew{};
  static_cast<api::lease::OnLease&>(renew) = *lease_;
  if (const auto renewed = caller_->call(renew); !renewed)
    return tl::unexpected(renewed.error().message);
  renewed_ = now;
  return {};
}

/// A stop by another client is seen before the next command goes out.
tl::expected<void, std::string> Joints::turn() {
  const std::scoped_lock calls(calls_);
  auto done = keep_lease();
  for (auto joint = joints_.begin(); done && joint != joints_.end(); ++joint)
    done = look(*joint, cached_ms).and_then([&] { return send(*joint); });
  return done;
}

void Joints::follow(const std::stop_token& ending) {
  while (!ending.stop_requested()) {
    auto done = turn();
    std::unique_lock data(data_);
    if (!done) {
      failure_ = std::move(done.error());
      return;
    }
    pause_.wait_for(data, ending, period, [] { return false; });
  }
}

}  // namespace tmcl::ros2
