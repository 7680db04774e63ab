#include "protocol/axis_news.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "tmcl/json_text.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;

// They are about one subscription, or by the gateway's clock.
constexpr std::array<std::string_view, 6> of_the_telling{"subscription",  "seq",     "dropped",
                                                         "event_time_ms", "samples", "age_ms"};
constexpr std::array<std::string_view, 6> of_moving{
    "position_microsteps", "velocity_internal", "velocity_pps", "position", "velocity",
    "position_reached"};

bool is_one_of(std::span<const std::string_view> names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

bool is_moving(const json::object& state) {
  const auto* moving = state.if_contains("moving");
  return moving != nullptr && moving->is_bool() && moving->get_bool();
}

struct Change {
  bool any = false;
  bool is_news = false;  ///< Something else than where it is on its way.
};

/// Brings what is known of an axis to what lasts of that which is told.
Change take_over(const json::object& told, json::object& state) {
  bool is_more = false;
  bool any = false;
  std::size_t lasting = 0;
  for (const auto& [key, value] : told) {
    const std::string_view name(key.data(), key.size());
    if (is_one_of(of_the_telling, name)) continue;
    ++lasting;
    auto* known = state.if_contains(key);
    if (known != nullptr && *known == value) continue;
    any = true;
    is_more = is_more || !is_one_of(of_moving, name);
    if (known != nullptr) *known = value;
    if (known == nullptr) state.emplace(key, value);
  }
  any = any || state.size() != lasting;
  for (auto one = state.begin(); state.size() != lasting;)
    one = told.contains(one->key()) ? one + 1 : state.stable_erase(one);
  return {any, is_moving(state) ? is_more : any};
}

std::string telemetry_text(const json::object& state) {
  json::object telemetry;
  for (const auto name : of_moving)
    if (const auto* value = state.if_contains(name)) telemetry.emplace(name, *value);
  return tmcl::json_text(telemetry);
}

}  // namespace

void AxisNews::wish(const std::string& user, tmcl::Duration time, tmcl::TimePoint now) {
  std::erase_if(wishes_, [&](const auto& one) { return one.second <= now; });
  wishes_.erase(user);
  if (time > tmcl::Duration{} && wishes_.size() < most_wishes) wishes_.emplace(user, now + time);
}

bool AxisNews::is_wanted(tmcl::TimePoint now) const {
  return std::ranges::any_of(wishes_, [&](const auto& one) { return one.second > now; });
}

Publication AxisNews::state_of(const std::string& axis, AxisTold& told, tmcl::TimePoint now) const {
  told.state_told = now;
  return {.topic = topics_.state(axis),
          .payload = tmcl::json_text(told.state),
          .retained = true,
          .expiry_s = static_cast<std::uint32_t>(state_expiry.count())};
}

void AxisNews::add_telemetry(const std::string& axis, AxisTold& told, tmcl::TimePoint now,
                             std::vector<Publication>& into) const {
  if (!told.is_untold_telemetry || !is_wanted(now)) return;
  if (told.telemetry_told && now - *told.telemetry_told < telemetry_interval) return;
  told.telemetry_told = now;
  told.is_untold_telemetry = false;
  into.push_back({.topic = topics_.telemetry(axis), .payload = telemetry_text(told.state)});
}

std::vector<Publication> AxisNews::hear(const json::object& told, tmcl::TimePoint now) {
  std::vector<Publication> news;
  const auto* name = told.if_contains("axis");
  if (name == nullptr || !name->is_string()) return news;
  const std::string axis(name->get_string());
  auto& known = axes_[axis];
  const auto change = take_over(told, known.state);
  known.is_untold_telemetry = known.is_untold_telemetry || change.any;
  if (change.is_news) news.push_back(state_of(axis, known, now));
  add_telemetry(axis, known, now, news);
  return news;
}

std::vector<Publication> AxisNews::due(tmcl::TimePoint now) {
  std::vector<Publication> news;
  for (auto& [axis, told] : axes_) {
    if (now - told.state_told > state_expiry / 2) news.push_back(state_of(axis, told, now));
    add_telemetry(axis, told, now, news);
  }
  return news;
}

std::vector<Publication> AxisNews::keep_only(const std::vector<std::string>& axes) {
  std::vector<Publication> cleared;
  std::erase_if(axes_, [&](const auto& axis) {
    const bool has_gone = std::ranges::count(axes, axis.first) == 0;
    if (has_gone) cleared.push_back({.topic = topics_.state(axis.first), .retained = true});
    return has_gone;
  });
  return cleared;
}

std::vector<Publication> AxisNews::all_states(tmcl::TimePoint now) {
  std::vector<Publication> news;
  for (auto& [axis, told] : axes_) news.push_back(state_of(axis, told, now));
  return news;
}

}  // namespace tmclmqtt
