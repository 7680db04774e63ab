#include "path/drive.hpp"

#include <algorithm>
#include <csignal>

#include <fmt/format.h>

#include "following.hpp"
#include "progress_line.hpp"
#include "tmcl/drive_report.hpp"
#include "together.hpp"

namespace tmclctl::path {
namespace {

namespace plan = tmcl::plan;
using plan::DriveCommand;
using plan::PathStream;

constexpr int bar_width = 30;
constexpr tmcl::Duration follow_interval = std::chrono::milliseconds(20);
constexpr tmcl::Duration longest_way_to_rest = std::chrono::seconds(10);
constexpr tmcl::Duration longest_sleep = std::chrono::milliseconds(100);

plan::DriveAnswer failed(const Failure& failure) {
  tmcl::Error error;
  error.message = failure.message;
  return tl::unexpected(std::move(error));
}

plan::DriveAnswer nothing(const Attempt<void>& done) {
  if (done) return 0;
  return failed(done.error());
}

plan::DriveAnswer carry_out(const DriveCommand& command, const std::string& axis, Target& target) {
  const auto parameter = std::to_string(command.parameter);
  switch (command.kind) {
    case DriveCommand::Kind::get: {
      const auto read = target.get(axis, parameter);
      if (!read) return failed(read.error());
      return read->value;
    }
    case DriveCommand::Kind::set:
      return nothing(target.set(axis, parameter, command.value).map([](const auto&) {}));
    case DriveCommand::Kind::rotate:
      return nothing(target.rotate(axis, counted(command.value)).map([](const auto&) {}));
    case DriveCommand::Kind::move_to:
      return nothing(target.move_to(axis, counted(command.value)).map([](const auto&) {}));
    case DriveCommand::Kind::stop: return nothing(target.stop(axis));
    default: return 0;  // of a line
  }
  return 0;
}

}  // namespace

void show(const PathProgress& now, ProgressLine& line) {
  if (!line.visible()) return;
  const double done = now.duration_s > 0 ? std::clamp(now.passed_s / now.duration_s, 0.0, 1.0) : 1;
  line.show(fmt::format("{} {:3}%  {:.1f} s left  {}", bar(done, bar_width, line.screen().utf8),
                        static_cast<int>(done * 100), (1 - done) * now.duration_s, now.phase));
}

int drive(PathStream& stream, const std::vector<std::string>& axes, double duration, Room& room) {
  ProgressLine progress(room.output);
  int signal = 0;
  while (true) {
    // Taken, so that the commands that stop the axes are not held up by it.
    if (const int caught = room.patience.take_signal(); caught != 0) {
      signal = caught;
      stream.stop();
    }
    stream.pause(room.patience.pause_asked());
    const auto step = stream.next(room.patience.now());
    if (std::holds_alternative<plan::DriveEnd>(step)) return signal;
    if (const auto* wait = std::get_if<plan::DriveWait>(&step)) {
      room.patience.sleep(std::min(wait->until - room.patience.now(), longest_sleep));
    }
    if (const auto* commands = std::get_if<plan::DriveCommands>(&step)) {
      for (const auto& command : *commands) {
        auto answer = carry_out(command, axes[command.axis], room.target);
        if (room.patience.signal() != 0) stream.stop();
        stream.answered(room.patience.now(), command.axis, std::move(answer));
      }
    }
    show({std::string(name_of(stream.phase())), stream.passed(), duration}, progress);
  }
}

Failure failure_from(const plan::StreamReport& report, const std::vector<std::string>& axes) {
  const auto& fault = *report.fault;
  const bool nothing_moved = plan::is_before_motion(fault.kind);
  const auto* hint = report.unstopped.empty() ? "All axes of the path were stopped"
                                              : "Some axes could not be stopped and may still move";
  return {nothing_moved ? ExitCode::refused : ExitCode::not_reached,
          std::string(name_of(fault.kind)),
          tmcl::text_of(fault, axes),
          nothing_moved ? "" : hint,
          {}};
}

void stop_axes(const std::vector<std::string>& axes, Room& room) {
  room.patience.take_signal();
  for (const auto& axis : axes) {
    if (const auto stopped = room.target.stop(axis); !stopped)
      room.output.err << "tmclctl: " << axis << " NOT stopped: " << describe(stopped.error())
                      << '\n';
  }
  const auto patience = room.patience.now() + longest_way_to_rest;
  for (const auto& axis : axes) {
    while (room.patience.now() < patience) {
      const auto state = room.target.state(axis);
      if (!state || !state->moving) break;
      room.patience.sleep(follow_interval);
    }
  }
}

namespace {

Attempt<void> start_one_by_one(const std::vector<std::string>& axes,
                               const std::vector<tmcl::Microsteps>& positions, Target& target) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto moved = target.move_to(axes[i], counted(positions[i].value));
    if (!moved) return tl::unexpected(moved.error());
  }
  return {};
}

Attempt<void> start_and_follow(const std::vector<std::string>& axes,
                               const std::vector<tmcl::Microsteps>& positions,
                               const std::string& what, decltype(start_one_by_one)& start,
                               Room& room) {
  if (auto interrupted = interrupted_before_move(room)) return tl::unexpected(*interrupted);
  const auto begin = room.patience.now();
  const auto give_up = [&](const Failure& failure) -> Attempt<void> {
    const int signal = room.patience.signal();
    stop_axes(axes, room);
    if (signal == 0) return tl::unexpected(failure);
    return tl::unexpected(interrupted_failure(signal, "stopped " + what, ""));
  };
  if (const auto started = start(axes, positions, room.target); !started)
    return give_up(started.error());
  ProgressLine progress(room.output);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const Journey journey{axes[i], positions[i], begin, follow_interval, {}};
    const auto arrived = follow(journey, room, [&](const AxisReading& reading) {
      progress.show(fmt::format("{}: {} at {} of {}", what, axes[i], reading.position.value,
                                positions[i].value));
    });
    if (!arrived) return give_up(arrived.error());
  }
  return {};
}

}  // namespace

Attempt<void> go_to(const std::vector<std::string>& axes,
                    const std::vector<tmcl::Microsteps>& positions, const std::string& what,
                    Room& room) {
  return start_and_follow(axes, positions, what, start_one_by_one, room);
}

Attempt<void> go_together(const std::vector<std::string>& axes,
                          const std::vector<tmcl::Microsteps>& positions, const std::string& what,
                          Room& room) {
  auto& start = axes.size() > 1 ? start_together : start_one_by_one;
  return start_and_follow(axes, positions, what, start, room);
}

}  // namespace tmclctl::path
