// Commands about the module itself.
#include "sim/module/module.hpp"

namespace tmcl::sim {
namespace {

constexpr std::uint8_t event_once = 0;
constexpr std::uint8_t event_always = 1;
/// The value that makes sure that a reset is meant.
constexpr std::int32_t reset_code = 1234;

}  // namespace

Answer Module::tell_version(const Request& request) const {
  switch (static_cast<VersionForm>(request.type)) {
    case VersionForm::text: return {Answer::Form::version_text, Status::ok, 0};
    case VersionForm::binary: return {Answer::Form::reply, Status::ok, to_value(version())};
  }
  return echo(request, Status::wrong_type);
}

Answer Module::arm_event(const Request& request, EventSink& from) {
  if (request.type != event_once && request.type != event_always) {
    return echo(request, Status::wrong_type);
  }
  const auto motors = static_cast<std::uint32_t>(request.value);
  if (motors >> axes_.size() != 0) return echo(request, Status::invalid_value);
  if (request.type == event_once) {
    events_.arm_once(motors, from);
  } else {
    events_.arm_always(motors, from);
  }
  return echo(request);
}

Answer Module::restart_after_reply(const Request& request) {
  if (request.value != reset_code) return echo(request, Status::invalid_value);
  restarts_ = true;
  return echo(request);
}

Answer Module::reset_to_factory_settings(const Request& request) {
  if (request.value != reset_code) return echo(request, Status::invalid_value);
  if (globals_.eeprom_locked()) return echo(request, Status::eeprom_locked);
  eeprom_.erase();
  restarts_ = true;
  return no_answer;
}

}  // namespace tmcl::sim
