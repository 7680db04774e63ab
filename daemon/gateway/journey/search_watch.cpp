#include "gateway/journey/search_watch.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "gateway/authority/search_questions.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;

// A module that answers RFS STATUS with 0 once may not have begun yet.
constexpr int looks_to_end = 3;
// Between two looks: short before the limit, long where it is far.
constexpr tmcl::Duration shortest_watch_pause = 5ms;
constexpr tmcl::Duration longest_watch_pause = 100ms;
// So far the times at which an answer was taken and came in can be apart: adapters collect bytes.
constexpr double time_of_answer_s = 0.05;

struct Seen {
  bool searches = true;
  SearchTravel::Look look{};
};

/// Errors: those of the exchanges, but a module that cannot tell whether it searches does.
tmcl::Script<tmcl::Result<Seen>> look_at_search(tmcl::AxisAddress motor,
                                                std::optional<tmcl::ModuleUnits> units) {
  const auto begin = co_await tmcl::current_time();
  const auto answers = co_await tmcl::exchange_all(questions_about_search(motor));
  const auto end = co_await tmcl::current_time();
  const auto& status = answers.front();
  if (!status && status.error().outcome != tmcl::Outcome::refused)
    co_return tl::unexpected(status.error());
  for (const auto& answer : {answers[1], answers[2]})
    if (!answer) co_return tl::unexpected(answer.error());
  const auto velocity = answers[1]->reply.value;
  Seen seen;
  // A module that cannot tell searches as long as it moves.
  seen.searches = status ? status->reply.value != 0 : velocity != 0;
  seen.look = {begin + (end - begin) / 2, answers[2]->reply.value,
               velocity * (units ? units->velocity.value : 1), units.has_value()};
  co_return seen;
}

tmcl::Duration pause_before(double limit, double gone, const SearchTravel::Look& look) {
  if (!look.speed_is_known) return shortest_watch_pause;
  if (look.speed == 0) return longest_watch_pause;
  const double speed = look.speed;
  const std::chrono::duration<double> to_limit((limit - gone) / std::abs(speed) / 2);
  return std::clamp(std::chrono::duration_cast<tmcl::Duration>(std::min(to_limit, {1s})),
                    shortest_watch_pause, longest_watch_pause);
}

/// Nothing where nothing bounds it, and when it has ended before that was known.
boost::asio::awaitable<SearchLimit> limit_of(GatewayAxis& axis, Permit permit) {
  if (const auto given = axis.search_limit_of(permit)) co_return *given;
  while (axis.searches_for(permit)) {
    const auto limit = co_await axis.search_limit();
    if (limit) co_return *limit;
    if (limit.error().code == tmcl::Errc::bad_argument) {
      axis.bus().log(LogLevel::warning, axis.bus().name() +
                                            ": nothing bounds the search of axis '" + axis.name() +
                                            "': " + limit.error().message);
      co_return std::nullopt;
    }
    co_await rest(longest_watch_pause);
  }
  co_return std::nullopt;
}

boost::asio::awaitable<void> stop_at_limit(std::shared_ptr<GatewayAxis> axis, Permit permit,
                                           tmcl::Microsteps limit) {
  const auto stopped = co_await axis->stop_search(permit, limit);
  if (!stopped) stop_until_it_stands(axis);
}

boost::asio::awaitable<void> watch(std::shared_ptr<GatewayAxis> axis, Permit permit) {
  SearchTravel travel(axis->bus().clock().now());
  const auto limit = co_await limit_of(*axis, permit);
  if (!limit) co_return;
  int ended = 0;
  while (axis->searches_for(permit) && !axis->bus().is_closed() && ended < looks_to_end) {
    const auto units = co_await axis->module_units();
    auto look = look_at_search(axis->address(), units.value_or(std::nullopt));
    const auto seen = co_await axis->perform(std::move(look), RunOptions{});
    if (!axis->searches_for(permit)) co_return;
    ended = seen && !seen->searches ? ended + 1 : 0;
    if (!seen) {
      co_await rest(longest_watch_pause);
      continue;
    }
    travel.note(seen->look);
    if (travel.gone() > limit->value) co_return co_await stop_at_limit(axis, permit, *limit);
    co_await rest(pause_before(limit->value, travel.gone(), seen->look));
  }
}

}  // namespace

void SearchTravel::note(const Look& look) {
  // How it began was not seen: evenly, from a standstill.
  const auto last = std::exchange(last_, look).value_or(Look{began_, look.position, 0, false});
  const int before = direction_;
  if (look.speed != 0) direction_ = look.speed > 0 ? 1 : -1;
  if (before != 0 && direction_ != before) {
    gone_ = 0;
  } else {
    gone_ += way_since(last, look);
  }
}

/// By the counter, if it has gone the same way about as far as the speed says; else by the speed.
double SearchTravel::way_since(const Look& last, const Look& look) const {
  const double way = (static_cast<double>(look.position) - last.position) * direction_;
  if (!look.speed_is_known) return std::max(way, 0.0);
  const double time = tmcl::seconds(look.at - last.at);
  const double one = std::abs(last.speed);
  const double other = std::abs(look.speed);
  const double most = 2 * std::max(one, other) * (time + time_of_answer_s);
  const double least = std::min(one, other) * std::max(time - time_of_answer_s, 0.0) / 2;
  return way >= least && way <= most ? way : (one + other) / 2 * time;
}

void watch_search(const std::shared_ptr<GatewayAxis>& axis, Permit permit) {
  spawn(axis->bus().executor(), watch(axis, permit));
}

}  // namespace tmcld
