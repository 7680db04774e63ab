#include "tune/switched_axis.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

namespace ap = axis_parameter;

constexpr int approaches = 5;
/// From here a switch is approached.
constexpr double full_steps_clear = 16;
constexpr int most_clearances = 8;
/// What is lost is lost in full steps.
constexpr double full_steps_lost = 0.5;
/// A switch that closes less exactly tells nothing.
constexpr double most_full_steps_of_spread = 2;

std::uint8_t state_of(LimitSwitch which) {
  return which == LimitSwitch::left ? number_of("left_limit_switch")
                                    : number_of("right_limit_switch");
}

Error interrupted(std::string what) {
  Error error;
  error.code = Errc::move_interrupted;
  error.outcome = Outcome::unknown;
  error.message = std::move(what);
  error.hint = "see the switch and its cable; then search the reference again";
  return error;
}

}  // namespace

std::int32_t SwitchedAxis::clearance() const {
  return away() * static_cast<std::int32_t>(full_steps_clear * full_step_);
}

double SwitchedAxis::tolerance() const { return std::max(full_steps_lost * full_step_, spread_); }

Script<Result<bool>> SwitchedAxis::is_closed() {
  const auto state = co_await must(watched_->get(state_of(which_)));
  co_return state == 1;
}

Script<Result<std::optional<std::int32_t>>> SwitchedAxis::approach(std::int32_t target,
                                                                   Duration limit) {
  const auto begin = co_await current_time();
  co_await must(watched_->ask(Command::MVP, move_type::absolute, target));
  std::optional<std::int32_t> place;
  while (true) {
    const bool closed = co_await must(is_closed());
    const auto velocity = co_await must(watched_->get(ap::actual_velocity));
    const auto here = co_await must(watched_->get(ap::actual_position));
    if (velocity == 0 && here == target) break;
    if (closed && velocity == 0) place = here;
    if (place) break;
    if (co_await current_time() - begin > limit)
      co_return tl::unexpected(interrupted(fmt::format(
          "the axis was sent to {}, and was at {} when it should have been there", target, here)));
  }
  co_return place;
}

/// Where a fast move ended at the switch, it may have been passed.
Script<Result<void>> SwitchedAxis::go_clear(Duration limit) {
  for (int left = most_clearances; left > 0; --left) {
    const bool closed = co_await must(is_closed());
    if (!closed) co_return Result<void>{};
    const auto here = co_await must(watched_->get(ap::actual_position));
    const Lookout lookout{limit, std::nullopt};
    const auto passage = co_await must(pass_to(here + clearance(), lookout));
    if (!passage.held()) co_return tl::unexpected(interrupted(passage.trouble));
  }
  co_return tl::unexpected(
      interrupted(fmt::format("the {} limit switch does not open again", name())));
}

Script<Result<void>> SwitchedAxis::calibrate(ValueRange travel, Duration limit) {
  const auto end = which_ == LimitSwitch::left ? travel.least : travel.greatest;
  std::vector<std::int32_t> places;
  for (int left = approaches; left > 0; --left) {
    co_await must(go_clear(limit));
    const auto place = co_await must(approach(end, limit));
    if (!place)
      co_return tl::unexpected(bad_argument(
          fmt::format("the {} limit switch has not stopped the axis within its travel", name()),
          "give a travel that reaches beyond it; is it enabled, and connected?"));
    places.push_back(*place);
  }
  // The first approach came from farther away.
  const auto [least, most] = std::minmax_element(places.begin() + 1, places.end());
  spread_ = *most - *least;
  if (spread_ > most_full_steps_of_spread * full_step_)
    co_return tl::unexpected(
        bad_argument(fmt::format("the {} limit switch closes at {} to {}: that is too uncertain",
                                 name(), *least, *most),
                     "a switch that closes within two full steps, or an encoder"));
  reference_ = *least + (*most - *least) / 2;
  co_return Result<void>{};
}

Script<Result<Passage>> SwitchedAxis::pass_to(std::int32_t target, Lookout lookout) {
  Passage passage;
  const auto begin = co_await current_time();
  const auto first = co_await must(watched_->get(ap::actual_position));
  const bool is_back = (target < first) == (away() > 0);
  co_await must(watched_->ask(Command::MVP, move_type::absolute, target));
  while (true) {
    const auto velocity = co_await must(watched_->get(ap::actual_velocity));
    const auto here = co_await must(watched_->get(ap::actual_position));
    if (here == target && velocity == 0) break;
    if (is_back && velocity == 0) {
      const bool closed = co_await must(is_closed());
      if (closed) passage.trouble = "the limit switch closed before the axis was back";
    }
    if (co_await current_time() - begin > lookout.limit)
      passage.trouble =
          fmt::format("it was sent from {} to {}, and was at {} when it should have been there",
                      first, target, here);
    if (!passage.held()) break;
    if (lookout.load_value_from)
      co_await must(look_at_load(*watched_, passage, *lookout.load_value_from));
  }
  co_return passage;
}

Script<Result<double>> SwitchedAxis::find_switch(std::int32_t reach, Duration limit) {
  co_await must(go_clear(limit));
  const auto place = co_await must(approach(reference_ - away() * reach, limit));
  if (!place)
    co_return tl::unexpected(
        interrupted(fmt::format("the {} limit switch did not close on the way to it", name())));
  const double off = std::abs(static_cast<double>(*place) - reference_);
  co_await must(watched_->stop());
  co_await must(verbs::set(axis_, ap::actual_position, reference_));
  co_return off;
}

}  // namespace tmcl::verbs
