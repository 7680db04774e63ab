#include <algorithm>

#include "tmcl/client.hpp"

namespace tmcl::client {
namespace {

using namespace api::axis;

// What a daemon may take to say that the time is over.
constexpr auto time_for_the_answer = std::chrono::seconds(15);

}  // namespace

template <class Method>
Result<typename Method::Result> Axis::call_in_time(Method params, Duration at_most) {
  const auto asked = std::chrono::ceil<std::chrono::milliseconds>(at_most);
  if (asked.count() > 0) params.timeout_ms = std::min<std::int64_t>(asked.count(), longest_ms);
  const std::chrono::milliseconds longest(params.timeout_ms.value_or(longest_ms));
  return caller_.call(params, {.timeout = longest + time_for_the_answer});
}

Result<StartedMove> Axis::move_to(api::Amount position) {
  return caller_.call(MoveTo{.axis = name_, .position = std::move(position)});
}
Result<StartedMove> Axis::move_to(Microsteps position) {
  return caller_.call(MoveTo{.axis = name_, .position_microsteps = position.value});
}
Result<StartedMove> Axis::move_by(api::Amount distance) {
  return caller_.call(MoveBy{.axis = name_, .distance = std::move(distance)});
}
Result<StartedMove> Axis::move_by(Microsteps distance) {
  return caller_.call(MoveBy{.axis = name_, .distance_microsteps = distance.value});
}
Result<Turning> Axis::rotate(api::Amount velocity) {
  return caller_.call(Rotate{.axis = name_, .velocity = std::move(velocity)});
}
Result<void> Axis::stop() {
  return caller_.call(Stop{name_}).map([](const api::Nothing&) {});
}
Result<Place> Axis::wait(Duration at_most) { return call_in_time(Wait{name_}, at_most); }
Result<HomedAxis> Axis::home(std::optional<std::uint8_t> mode, Duration at_most) {
  return call_in_time(Home{name_, mode}, at_most);
}
Result<State> Axis::state() { return caller_.call(GetState{name_}); }
Result<Units> Axis::units() { return caller_.call(GetUnits{name_}); }

Result<api::parameter::Value> Axis::get(api::NameOrNumber parameter) {
  return caller_.call(api::parameter::Get{{name_, std::move(parameter)}});
}
Result<api::parameter::Value> Axis::set(api::NameOrNumber parameter, std::int32_t value) {
  return caller_.call(api::parameter::Set{{name_, std::move(parameter)}, value});
}
Result<api::parameter::Value> Axis::set(api::NameOrNumber parameter, api::Amount value) {
  return caller_.call(api::parameter::Set{{name_, std::move(parameter)}, {}, std::move(value)});
}

}  // namespace tmcl::client
