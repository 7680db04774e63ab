#include "measured_travel.hpp"

#include <fmt/format.h>

#include "verbs.hpp"

namespace tmclctl {
namespace {

std::string where_to(const MeasuredTravel& travel) {
  if (travel.from.empty()) return "within its soft limits";
  return fmt::format("between {} and {} from where it stands", travel.from, travel.to);
}

}  // namespace

Reading read_travel(const std::string& said, MeasuredTravel& travel) {
  constexpr std::string_view between = "..";
  const auto at = said.find(between);
  const auto end = at == std::string::npos ? at : at + between.size();
  if (at == std::string::npos || at == 0 || end == said.size())
    return tl::unexpected("'" + said + "' is no travel, such as -2mm..2mm");
  travel = {said.substr(0, at), said.substr(end)};
  return {};
}

Result<bool> may_be_measured(const std::string& axis, const MeasuredTravel& travel, bool yes,
                             Context& context) {
  if (yes) return true;
  const auto question = fmt::format("{} will move, {}. Nothing may be in its way. Go on? [y/N] ",
                                    axis, where_to(travel));
  const auto said = context.host.confirm(question);
  if (said) return *said;
  return tl::unexpected(
      usage_error("bad_argument", "the axis would move, and there is no terminal to confirm it at",
                  "--yes says that it may"));
}

}  // namespace tmclctl
