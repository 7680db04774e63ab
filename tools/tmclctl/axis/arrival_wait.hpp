/// Sends an axis on its way, and waits, until it has arrived or something else ends the move.
#pragma once

#include <functional>
#include <string>

#include "quantity_text.hpp"
#include "verbs/verbs.hpp"

namespace tmclctl {

/// A movement that had to wait longer than this for its turn is not what the user expects any more.
constexpr int move_deadline_ms = 5000;
/// `by`: a distance instead of a position.
Result<tmcl::api::axis::StartedMove> start_move(const std::string& axis, const Typed& where,
                                                bool by, Context& context);

/// Time between two readings of a moving axis.
constexpr tmcl::Duration follow_interval = std::chrono::milliseconds(20);

struct Journey {
  std::string axis;
  tmcl::Microsteps goal;
  tmcl::TimePoint started_at;
  tmcl::Duration interval;  ///< Between two readings.
  std::optional<tmcl::Duration> timeout{};
  /// The goal in the unit of the axis: then everything is told in that.
  std::optional<InUnit> goal_in_unit{};
  Beside beside{};
  std::function<Result<void>()> meanwhile{};  ///< As of Wait.
};

/// What the settings of the axis make of moves, once it stands at its goal and stays there, or why
/// it is not waited for any longer: interrupted by someone else, by a signal, by the time
/// limit, or because it does not answer. Readings of other axes are told, too.
Result<Warnings> follow(const Journey& journey, Context& context,
                        const std::function<void(const AxisReading&)>& on_reading);

/// Of a stop that has stopped nothing.
constexpr std::string_view everything_moves =
    "Everything still moves: 'tmclctl stop --all' stops every axis. ";

/// What to do about an axis that stands for this cause: "Its left switch is closed; ..."
std::string advice_on_stop(const std::string& axis, const std::string& cause);

/// Ctrl-C came before the move went out: then it does not go out any more.
std::optional<Error> interrupted_before_move(Context& context);
/// "Stop it with: tmclctl --direct can:can0 stop 1/0"
std::string how_to_stop(const std::string& axis, const Context& context);

}  // namespace tmclctl
