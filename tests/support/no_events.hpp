/// For whoever gives a simulated module a command, and waits for no event of it.
#pragma once

#include <cstdint>

#include "sim/module/event_sink.hpp"

namespace tmcl::test {

struct NoEvents final : sim::EventSink {
  void target_reached(const sim::Module&, std::int32_t) override {}
};

}  // namespace tmcl::test
