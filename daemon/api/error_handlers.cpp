// What modules know about themselves.
#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/views.hpp"

namespace tmcld::handlers {

Answer<axis::GetErrors> get_errors(Call& call, const axis::GetErrors& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  const auto report = co_await must(axis->read_faults(call.permit.client), *axis);
  axis::Errors errors{axis->name(), texts(report.flags), texts(axis->unproven_faults()),
                      texts(report.switches)};
  if (const auto cause = axis->stop_cause()) errors.stop_cause = name_of(*cause);
  errors.supply_volts = report.supply_volts;
  errors.temperature_celsius = report.temperature_celsius;
  co_return errors;
}

}  // namespace tmcld::handlers
