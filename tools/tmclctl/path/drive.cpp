#include "path/drive.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "following.hpp"
#include "progress_line.hpp"
#include "together.hpp"

namespace tmclctl::path {
namespace {

constexpr int bar_width = 30;
constexpr tmcl::Duration follow_interval = std::chrono::milliseconds(20);
constexpr tmcl::Duration longest_way_to_rest = std::chrono::seconds(10);

}  // namespace

void show(const PathProgress& now, ProgressLine& line) {
  if (!line.visible()) return;
  const double done = now.duration_s > 0 ? std::clamp(now.passed_s / now.duration_s, 0.0, 1.0) : 1;
  line.show(fmt::format("{} {:3}%  {:.1f} s left  {}", bar(done, bar_width, line.screen().utf8),
                        static_cast<int>(done * 100), (1 - done) * now.duration_s, now.phase));
}

void stop_axes(const std::vector<std::string>& axes, Context& context) {
  context.host.take_signal();
  for (const auto& axis : axes) {
    if (const auto stopped = context.target.stop(axis); !stopped)
      context.output.err << "tmclctl: " << axis << " NOT stopped: " << describe(stopped.error())
                         << '\n';
  }
  const auto host = context.host.now() + longest_way_to_rest;
  for (const auto& axis : axes) {
    while (context.host.now() < host) {
      const auto state = context.target.state(axis);
      if (!state || !state->moving) break;
      context.target.sleep(follow_interval);
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
                               Context& context) {
  if (auto interrupted = interrupted_before_move(context)) return tl::unexpected(*interrupted);
  const auto begin = context.host.now();
  const auto give_up = [&](const Failure& failure) -> Attempt<void> {
    const int signal = context.host.signal();
    stop_axes(axes, context);
    if (signal == 0) return tl::unexpected(failure);
    return tl::unexpected(interrupted_failure(signal, "stopped " + what, ""));
  };
  if (const auto started = start(axes, positions, context.target); !started)
    return give_up(started.error());
  ProgressLine progress(context.output);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const Journey journey{axes[i], positions[i], begin, follow_interval, {}};
    const auto arrived = follow(journey, context, [&](const AxisReading& reading) {
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
                    Context& context) {
  return start_and_follow(axes, positions, what, start_one_by_one, context);
}

Attempt<void> go_together(const std::vector<std::string>& axes,
                          const std::vector<tmcl::Microsteps>& positions, const std::string& what,
                          Context& context) {
  auto& start = axes.size() > 1 ? start_together : start_one_by_one;
  return start_and_follow(axes, positions, what, start, context);
}

}  // namespace tmclctl::path
