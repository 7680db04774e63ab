/// The text of messages of Sparkplug B 3.0, in Protocol Buffers. Does no I/O. The only files that
/// know protozero.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json/value.hpp>

#include "tmcl/clock.hpp"

namespace tmclmqtt {

/// Of a metric, by the numbers of Sparkplug.
enum class MetricType : std::uint32_t { int64 = 4, floating = 10, boolean = 11, text = 12 };

struct Metric {
  std::string name;
  MetricType type;
  boost::json::value value{};  ///< Of that type, or null: not known.
  std::string unit{};          ///< Property engUnit; empty: none.
};

constexpr std::string_view rebirth_metric = "Node Control/Rebirth";

/// `utc` becomes the time of the message and of each metric. `sequence`: none for an NDEATH.
std::string sparkplug_payload(const std::vector<Metric>& metrics, tmcl::UtcTime utc,
                              std::optional<std::uint8_t> sequence);
/// Of an NCMD. False for what is no payload of Sparkplug's.
bool asks_for_rebirth(std::string_view payload);

}  // namespace tmclmqtt
