#include "fleet/fleet_picture.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "axis/axis_rows.hpp"
#include "broker/topic_levels.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr std::array<std::string_view, 2> news{"state", "telemetry"};
constexpr int least_name_width = 8;

AxisReading reading_in(const json::object& state) {
  AxisReading reading;
  static_cast<tmcl::api::axis::State&>(reading) =
      tmcl::api::from_json<tmcl::api::axis::State>(state);
  std::erase_if(reading.faults, [](const auto& fault) { return !is_printable(fault); });
  return reading;
}

}  // namespace

/// Of a gateway.
struct FleetPicture::Count {
  std::string name;
  const FleetGateway* gateway;
  std::size_t moving = 0;
  std::vector<std::string> remarks{};  ///< What is wrong with axes.

  bool is_there() const { return gateway->online && !gateway->daemon.empty(); }
  /// The smaller, the higher it stands.
  int rank() const {
    if (!is_there()) return 0;
    if (!remarks.empty()) return 1;
    return moving > 0 ? 2 : 3;
  }
  std::string text() const {
    if (!gateway->online) return "AWAY";
    if (gateway->daemon.empty()) return "online, but tmcld is not there";
    auto text = fmt::format("{} axes", gateway->axes.size());
    if (moving > 0) text += fmt::format(", {} moving", moving);
    for (const auto& remark : remarks) text += "; " + remark;
    return text;
  }
};

std::vector<std::string> FleetPicture::filters() const {
  auto levels = gateways_.named();
  if (levels.empty() || !gateways_.has_only_names()) levels = {"+"};
  std::vector<std::string> filters;
  for (const auto& level : levels)
    for (const auto kind : news)
      filters.push_back(fmt::format("{}{}/{}/+", tmclmqtt::topic_root, level, kind));
  return filters;
}

void FleetPicture::hear(const tmclmqtt::Message& message) {
  std::string_view rest;
  const auto gateway = gateway_in(message.topic, rest);
  if (gateway.empty() || !gateways_.is_meant(gateway)) return;
  const auto levels = tmclmqtt::levels_of(rest);
  if (levels.size() != 2 || std::ranges::count(news, levels[0]) == 0) return;
  auto& state = told_[gateway][std::string(levels[1])];
  const bool is_whole = levels[0] == news[0];
  if (is_whole) state.clear();
  for (const auto& [name, value] : object_in(message.payload)) state[name] = value;
}

FleetPicture::Count FleetPicture::count(const std::string& gateway) const {
  Count count{gateway, &gateways_.all().at(gateway)};
  const auto told = told_.find(gateway);
  if (told == told_.end() || !count.is_there()) return count;
  for (const auto& axis : count.gateway->axes) {
    const auto state = told->second.find(axis);
    if (state == told->second.end()) continue;
    const auto reading = reading_in(state->second);
    if (reading.moving) ++count.moving;
    if (const auto flags = flags_text(reading); !reading.faults.empty() || reading.latched)
      count.remarks.push_back(axis + ' ' + flags);
  }
  return count;
}

std::vector<std::string> FleetPicture::lines_of_axes(const std::string& gateway, int width,
                                                     bool internal) const {
  std::vector<AxisLine> axes;
  const auto told = told_.find(gateway);
  for (const auto& name : gateways_.all().at(gateway).axes) {
    AxisLine axis{name, {}};
    if (told != told_.end()) {
      const auto state = told->second.find(name);
      if (state != told->second.end()) axis.reading = reading_in(state->second);
    }
    axes.push_back(std::move(axis));
  }
  if (axes.empty()) return {};
  constexpr std::size_t indent = 2;
  auto lines = tmclctl::lines_of(axes, width - static_cast<int>(indent), internal);
  lines.erase(lines.begin());
  for (auto& line : lines) line.insert(0, indent, ' ');
  return lines;
}

std::vector<std::string> FleetPicture::lines(int width, bool axes, bool internal) const {
  std::vector<Count> counts;
  std::size_t name_width = least_name_width;
  std::size_t away = 0;
  std::size_t moving = 0;
  std::size_t wrong = 0;
  for (const auto& [name, gateway] : gateways_.all()) {
    counts.push_back(count(name));
    name_width = std::max(name_width, name.size());
    away += counts.back().is_there() ? 0U : 1U;
    moving += counts.back().moving;
    wrong += counts.back().remarks.size();
  }
  std::ranges::stable_sort(counts, {}, &Count::rank);
  std::vector<std::string> lines{
      fmt::format("{} gateways, {} away; {} axes moving, {} with something wrong; q ends this, the "
                  "axes go on",
                  counts.size(), away, moving, wrong),
      ""};
  for (const auto& one : counts) {
    lines.push_back(fmt::format("{:<{}}  {}", one.name, name_width, one.text()));
    if (axes && one.is_there())
      std::ranges::move(lines_of_axes(one.name, width, internal), std::back_inserter(lines));
  }
  return lines;
}

}  // namespace tmclctl
