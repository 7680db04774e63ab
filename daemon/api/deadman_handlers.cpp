#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "config/feeding.hpp"
#include "gateway/module/deadman_measurement.hpp"

namespace tmcld::handlers {
namespace {

/// Empty if all modules of the bus can be fed, with this one.
std::string fault_of(std::int32_t ms, const GatewayAxis& axis) {
  if (auto fault = fault_of_deadman(ms); !fault.empty()) return fault;
  auto bus = axis.bus().config();
  bus.modules.clear();
  for (const auto& [address, module] : axis.bus().modules()) {
    const bool is_this = module.get() == &axis.module();
    bus.modules.push_back({address, {}, is_this ? ms : module->deadman().set_ms()});
  }
  return fault_of_feeding(bus);
}

}  // namespace

Answer<axis::SetDeadman> set_deadman(Call& call, const axis::SetDeadman& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  if (const auto fault = fault_of(params.ms, *axis); !fault.empty())
    co_return param_error<&axis::SetDeadman::ms>("out_of_range", "'ms' " + fault);
  co_await must(axis->be_ready(), *axis);
  auto& deadman = axis->module().deadman();
  RunOptions options;
  options.permit = call.permit;
  co_await must(axis->perform(deadman.change(params.ms), std::move(options)), *axis);
  // It is fed from the next start on, whatever the configuration says.
  if (!deadman.stops_after_ms()) deadman.remember({});
  co_await DeadmanMemory::write(call.gateway->deadmen());
  co_return axis::DeadmanSetting{params.ms};
}

Answer<axis::TestDeadman> test_deadman(Call& call, const axis::TestDeadman& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  const auto tell = [reporter = call.progress_reporter(),
                     name = axis->name()](const DeadmanPlan& plan) {
    const auto way = std::abs(std::int64_t{plan.target.value} - plan.from.value);
    reporter(DeadmanProgress{name, plan.target.value, static_cast<std::int32_t>(way),
                             plan.silence / std::chrono::milliseconds(1)});
  };
  const auto found = co_await must(measure_deadman(call.gateway, axis, call.permit, tell), *axis);
  axis::TestedDeadman result;
  result.deadman.said = "none";
  if (found.stops_after_ms)
    result.deadman.said = axis::Deadman{found.set_ms, *found.stops_after_ms};
  if (!found.reason.empty()) result.reason = found.reason;
  result.way_microsteps = found.way.value;
  co_return result;
}

}  // namespace tmcld::handlers
