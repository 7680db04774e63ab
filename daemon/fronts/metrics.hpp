/// What Prometheus is told of a gateway.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "fronts/latency.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// What an axis does, for one page.
struct AxisMeasurements {
  std::shared_ptr<GatewayAxis> axis;
  std::optional<AxisReading> reading{};         ///< Nothing if its module does not answer.
  std::optional<double> temperature_celsius{};  ///< Of its module, told of its first axis.
};

/// Reads the configured axes, unless that was done within the last second, and the temperature of
/// each module.
boost::asio::awaitable<std::vector<AxisMeasurements>> measure_axes(
    std::shared_ptr<Gateway> gateway);

/// In its text form. `stops`: how long they took; `clients`: that are connected by HTTP now.
std::string metrics_text(const Gateway& gateway, const std::vector<AxisMeasurements>& axes,
                         const Latency& stops, std::size_t clients);

}  // namespace tmcld
