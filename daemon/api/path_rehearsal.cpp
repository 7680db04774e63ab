#include "api/path_rehearsal.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "api/course_view.hpp"
#include "tmcl/drive_report.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcld {
namespace {

namespace plan = tmcl::plan;
using api::path::Expected;
using plan::StreamMode;

constexpr std::array all_modes{StreamMode::velocity, StreamMode::segments, StreamMode::position};

Expected told(const plan::Rehearsal& rehearsal, StreamMode mode, const Cast& cast,
              double tolerance) {
  Expected expected;
  expected.mode = name_of(mode);
  if (rehearsal.fault) expected.refused = tmcl::text_of(*rehearsal.fault, cast.names);
  expected.off_path = rehearsal.farthest;
  expected.off_path_at_s = rehearsal.at_s;
  expected.off_path_at = to_list(rehearsal.position, cast.axes.size());
  expected.lag_s = rehearsal.lag_s;
  expected.foreseen_s = rehearsal.passed_s;
  expected.keeps_tolerance = !rehearsal.fault && rehearsal.farthest <= tolerance;
  return expected;
}

}  // namespace

Task<Cast> cast_of(const std::vector<std::shared_ptr<GatewayAxis>>& axes,
                   const std::vector<plan::PathAxis>& known) {
  Cast cast;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    auto twin = co_await must(axes[i]->twin({}), *axes[i]);
    if (!twin) co_return Cast{};
    auto stream = known[i].stream;
    stream.encoder.reset();  // A twin has none.
    cast.axes.push_back({std::move(stream), std::move(*twin), axes[i]->ramp_settings()});
    cast.names.push_back(axes[i]->name());
    cast.command = std::max(cast.command, known[i].command);
  }
  co_return cast;
}

std::vector<Expected> expected_of(const plan::Course& course, const Cast& cast,
                                  const plan::PathRequest& request) {
  std::vector<Expected> all;
  if (cast.axes.empty()) return all;
  auto modes = all_modes;
  std::ranges::stable_partition(modes, [&](StreamMode mode) { return mode == request.mode; });
  for (const auto mode : modes) {
    auto options = options_of(request);
    options.mode = mode;
    const auto rehearsal = plan::rehearse(course, cast.axes, options, cast.command);
    all.push_back(told(rehearsal, mode, cast, request.tolerance));
  }
  return all;
}

std::string warning_of(const std::vector<Expected>& expected, double tolerance) {
  if (expected.empty() || expected.front().keeps_tolerance) return {};
  const auto& asked = expected.front();
  const auto other = std::ranges::find_if(expected, &Expected::keeps_tolerance);
  const auto instead =
      other != expected.end()
          ? fmt::format("mode {} is expected to stay within {}", other->mode,
                        tmcl::plain_number(other->off_path, 3))
          : "a lower velocity, acceleration or corner_jump keeps nearer to the path";
  if (asked.refused)
    return fmt::format("mode {} cannot pass this path: {}; {}", asked.mode, *asked.refused,
                       instead);
  return fmt::format(
      "mode {} is expected to leave the path by {} at {} s, more than the tolerance of {}; {}",
      asked.mode, tmcl::plain_number(asked.off_path, 3), tmcl::plain_number(asked.off_path_at_s, 4),
      tmcl::plain_number(tolerance, 6), instead);
}

}  // namespace tmcld
