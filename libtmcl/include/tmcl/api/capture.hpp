/// The methods of data loggers: a module records values of an axis at the ticks of its own clock,
/// and is read afterwards. See tmcl/data_logger.hpp.
#pragma once

#include "tmcl/api/parameter.hpp"

namespace tmcl::api::capture {

/// Of one call of capture.read: a quarter of a second at 115200 baud.
constexpr std::int32_t most_values = 128;
constexpr std::string_view capture_summary = "which capture: the number that capture.start gave";

struct Channel : parameter::Number {
  TMCL_STRUCT(Channel, parameter::Number);
  TMCL_FIELD(std::optional<std::string>, unit, "what its values count; null if that has no name");
};

struct Started {
  TMCL_STRUCT(Started);
  TMCL_FIELD(std::int32_t, capture, "its number, for the other methods");
  TMCL_FIELD(std::vector<Channel>, channels, "what is recorded, in the order of the values");
  TMCL_FIELD(std::int32_t, samples, "how many of each channel");
  TMCL_FIELD(std::int32_t, pretrigger, "how many of them lie before the trigger");
  TMCL_FIELD(double, rate_hz, "how many a second");
};
struct Start {
  TMCL_METHOD("capture.start", writes, Started,
              "has the module of an axis record parameters of it, by command 142", Start);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::vector<std::string>, channels,
             "names or numbers of the axis parameters to record");
  TMCL_FIELD(std::optional<double>, rate_hz,
             "how many samples a second; as many as the module can if it is not given");
  TMCL_FIELD(std::optional<std::int32_t>, samples,
             "how many of each channel; as many as there is room for if it is not given",
             {1, 1 << 30});
  TMCL_FIELD(std::optional<std::string>, trigger_parameter,
             "name or number of the axis parameter that is waited for; none: it begins at once");
  TMCL_FIELD(std::optional<std::string>, trigger_edge,
             "rising: it becomes greater than the value; falling: it no longer is; or both");
  TMCL_FIELD(std::optional<std::int32_t>, trigger_value, "as the module counts it");
  TMCL_FIELD(std::optional<std::int32_t>, pretrigger_percent,
             "how much of the recording lies before the trigger", {0, 100});
  TMCL_FIELD(std::optional<bool>, resume,
             "goes on with what the module records already, or has recorded, if that is this");
};

struct Progress {
  TMCL_STRUCT(Progress);
  TMCL_FIELD(std::string, state, "idle, pretrigger, trigger, capture, complete or error");
};
struct GetState {
  TMCL_METHOD("capture.state", reads, Progress, "how far a capture has come", GetState);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::int32_t, capture, capture_summary);
};

struct Values {
  TMCL_STRUCT(Values);
  TMCL_FIELD(std::vector<std::int32_t>, values, "one of each channel after the other");
};
struct Read {
  TMCL_METHOD("capture.read", reads, Values, "reads what a module has recorded", Read);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::int32_t, capture, capture_summary);
  TMCL_FIELD(std::int32_t, first, "index of the first value, of all channels together",
             {0, 1 << 30});
  TMCL_FIELD(std::int32_t, count, "how many", {1, most_values});
};

struct End {
  TMCL_METHOD("capture.end", writes, Nothing,
              "the module records nothing any more, and forgets what it has", End);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::optional<std::int32_t>, capture,
             "only this one; nothing happens to another one that was begun since");
};

}  // namespace tmcl::api::capture
