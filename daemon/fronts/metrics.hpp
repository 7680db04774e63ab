/// What Prometheus is told of a gateway.
#pragma once

#include <cstddef>
#include <string>

#include "fronts/latency.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// In its text form. `stops`: how long they took; `clients`: that are connected by HTTP now.
std::string metrics_text(const Gateway& gateway, const Latency& stops, std::size_t clients);

}  // namespace tmcld
