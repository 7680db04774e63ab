/// A simulated module in a time of its own, without any wire: it is looked at only when somebody
/// says so.
#pragma once

#include <cstdint>

#include "sim/module/module.hpp"
#include "support/no_events.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::test {

struct LoneModule {
  VirtualClock clock;
  NoEvents events;
  sim::Module module;

  LoneModule(std::uint16_t model, const sim::StageSettings& stage,
             const sim::ModuleSettings& settings = {})
      : module(*find_model(model), ModuleAddress{1}, clock, settings) {
    module.mount(0, stage);
  }
  sim::Answer ask(const Request& request) {
    return module.execute(request, sim::Medium::serial, events);
  }
  sim::Answer ask(Command command, std::uint8_t type, std::int32_t value) {
    return ask({ModuleAddress{1}, command, type, 0, value});
  }
  void look_at(TimePoint time) {
    clock.advance_to(time);
    module.run_due();
  }
};

}  // namespace tmcl::test
