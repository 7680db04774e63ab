/// The methods of the daemon itself, and what it tells unasked.
#pragma once

#include "tmcl/api/parameter.hpp"

namespace tmcl::api {

namespace rpc {

struct FieldInfo {
  TMCL_STRUCT(FieldInfo);
  static constexpr bool omits_absent = true;
  TMCL_FIELD(std::string, name, "what it is called");
  TMCL_FIELD(std::string, type, "what it is in JSON");
  TMCL_FIELD(std::optional<bool>, required, "of a parameter");
  TMCL_FIELD(std::optional<std::int64_t>, minimum, "of a parameter that is an integer");
  TMCL_FIELD(std::optional<std::int64_t>, maximum, "of a parameter that is an integer");
  TMCL_FIELD(std::string, summary, "what it means");
  TMCL_FIELD(std::optional<std::vector<FieldInfo>>, members,
             "of an object, or of each object of an array");
};
struct MethodInfo {
  TMCL_STRUCT(MethodInfo);
  TMCL_FIELD(std::string, name, "what it is called");
  TMCL_FIELD(std::string, summary, "what it does");
  TMCL_FIELD(std::string, effect,
             "what it does to a machine at most: reads, writes, moves or stops");
  TMCL_FIELD(std::string, role, "who may call it: stop, observe, operate or configure");
  TMCL_FIELD(std::vector<FieldInfo>, params, "what it takes");
  TMCL_FIELD(std::vector<FieldInfo>, result, "what it gives");
};
struct Methods {
  TMCL_STRUCT(Methods);
  TMCL_FIELD(std::vector<MethodInfo>, methods, "every method");
};
struct Discover {
  TMCL_METHOD("rpc.discover", reads, Methods, "every method, as this daemon has it", Discover);
};

}  // namespace rpc

struct FailedAxis {
  TMCL_STRUCT(FailedAxis);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(boost::json::object, error, "what went wrong");
};

namespace system {

struct StoppedAxis {
  TMCL_STRUCT(StoppedAxis);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(double, milliseconds, "passed until its module had confirmed");
};
struct StoppedAxes {
  TMCL_STRUCT(StoppedAxes);
  TMCL_FIELD(std::vector<StoppedAxis>, stopped, "those that confirmed");
  TMCL_FIELD(std::vector<FailedAxis>, failed, "those that did not");
};
struct StopAll {
  TMCL_METHOD("system.stop_all", stops, StoppedAxes, "stops all axes at once", StopAll);
};

}  // namespace system

// ---- subscriptions ----

/// Of one subscription.
constexpr std::size_t most_sampled_parameters = 8;

/// An axis parameter that a subscription names, as it was read last.
struct Sample : parameter::Value {
  TMCL_STRUCT(Sample, parameter::Value);
  TMCL_FIELD(std::int64_t, age_ms, "how old the value is");
};
/// A state as subscribers are told it.
struct PublishedState : axis::State {
  TMCL_STRUCT(PublishedState, axis::State);
  TMCL_FIELD(std::uint64_t, seq, "counts the states of the axis");
  TMCL_FIELD(std::int64_t, event_time_ms, "when it was read, on the daemon's monotonic clock");
  TMCL_FIELD(std::vector<Sample>, samples,
             "the parameters that the subscription names, as they were read last");
};
struct Subscription {
  TMCL_STRUCT(Subscription);
  TMCL_FIELD(std::uint64_t, subscription, "what unsubscribe takes");
  TMCL_FIELD(std::vector<PublishedState>, states, "the state of each axis now");
  TMCL_FIELD(std::vector<FailedAxis>, failed, "those that do not answer now");
};
struct Subscribe {
  TMCL_METHOD("subscribe", reads, Subscription,
              "tells of states by notify_state whenever they change, and of events", Subscribe);
  TMCL_FIELD(std::optional<std::vector<std::string>>, axes,
             "names of the axes; all of them if absent");
  TMCL_FIELD(std::optional<std::int32_t>, interval_ms,
             "least time between two states; 50 if absent", {5, 60000});
  TMCL_FIELD(std::optional<std::vector<std::string>>, parameters,
             "names or numbers of axis parameters that are read as well, 8 at most");
  TMCL_FIELD(std::optional<bool>, every_look,
             "tells of each look at an axis, whether anything has changed or not");
};
struct Unsubscribe {
  TMCL_METHOD("unsubscribe", reads, Nothing, "ends a subscription", Unsubscribe);
  TMCL_FIELD(std::int32_t, subscription, "what subscribe gave", {.minimum = 0});
};

// ---- what is told unasked: the notifications ----

/// A state that has changed, to its subscribers.
struct NewState : PublishedState {
  TMCL_STRUCT(NewState, PublishedState);
  static constexpr std::string_view notification = "notify_state";
  TMCL_FIELD(std::uint64_t, subscription, "which one");
  TMCL_FIELD(std::uint64_t, dropped, "states that were replaced by newer ones");
};

/// How far a call has come, to the client that made it; together with the id of the request.
constexpr std::string_view progress_notification = "notify_progress";

struct ScanProgress {
  TMCL_STRUCT(ScanProgress);
  TMCL_FIELD(std::string, bus, "which one");
  TMCL_FIELD(std::uint64_t, asked, "how many addresses were asked");
  TMCL_FIELD(std::uint64_t, of, "how many there are");
  TMCL_FIELD(std::optional<bus::FoundModule>, found, "a module that was just found; null if none");
};
struct SearchProgress {
  TMCL_STRUCT(SearchProgress);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::int32_t, step, "of the search, as the module counts them");
};
struct DeadmanProgress {
  TMCL_STRUCT(DeadmanProgress);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::int32_t, target_microsteps, "it goes there at most");
  TMCL_FIELD(std::int32_t, way_microsteps, "how far that is");
  TMCL_FIELD(std::int64_t, silence_ms, "its module is sent nothing for so long");
};
/// Of a program or of firmware.
struct LoadProgress {
  TMCL_STRUCT(LoadProgress);
  TMCL_FIELD(std::string, bus, "name of the bus");
  TMCL_FIELD(std::uint16_t, address, "address of the module");
  TMCL_FIELD(std::string, phase, "such as writing or comparing");
  TMCL_FIELD(std::uint64_t, done, "commands of a program, bytes of firmware");
  TMCL_FIELD(std::uint64_t, of, "how many there are");
};
struct PathProgress {
  TMCL_STRUCT(PathProgress);
  TMCL_FIELD(std::string, phase, "measuring, running, pausing or ending");
  TMCL_FIELD(double, passed_s, "how much of it has been passed");
  TMCL_FIELD(double, duration_s, "how long all of it takes");
};
struct MintProgress {
  TMCL_STRUCT(MintProgress);
  TMCL_FIELD(std::string, phase, "running, or stands: at the end of a group");
  TMCL_FIELD(std::uint64_t, line, "of the GO of the group");
  TMCL_FIELD(double, passed_s, "how much of the group has been passed");
  TMCL_FIELD(double, duration_s, "how long it was to take");
};
struct MintAxis {
  TMCL_STRUCT(MintAxis);
  TMCL_FIELD(std::uint8_t, number, "in the program");
  TMCL_FIELD(std::string, axis, axis::axis_summary);
};
/// Once, before anything moves.
struct MintChecked {
  TMCL_STRUCT(MintChecked);
  TMCL_FIELD(std::string, phase, "checked");
  TMCL_FIELD(std::vector<MintAxis>, axes, "those that the program moves");
  TMCL_FIELD(std::vector<std::string>, remarks, "what else is to be said of the program");
};

/// What happened to a bus, a module or an axis, to all subscribers.
struct Event {
  TMCL_STRUCT(Event);
  static constexpr std::string_view notification = "notify_event";
  TMCL_FIELD(std::string, kind, "such as target_reached");
  TMCL_FIELD(std::string, bus, "where it happened");
  TMCL_FIELD(std::optional<std::uint16_t>, address, "of the module; null for a whole bus");
  TMCL_FIELD(std::optional<std::vector<std::uint8_t>>, motors, "which motors, where that matters");
  TMCL_FIELD(std::optional<std::string>, cause, "who has stopped the axis, where that matters");
  TMCL_FIELD(std::optional<std::string>, reason,
             "why a lease was lost: expired, closed or broken; only then");
  TMCL_FIELD(std::optional<std::vector<axis::RampSetting>>, unrestored,
             "settings of the axis as they were before, which are set back as soon as its module "
             "takes them; only then");
  TMCL_FIELD(std::string, text, "for people");
};

}  // namespace tmcl::api
