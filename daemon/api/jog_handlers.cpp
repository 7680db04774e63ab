// Jogs.
#include <utility>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "api/views.hpp"
#include "gateway/journey/jog.hpp"

namespace tmcld::handlers {

Answer<axis::Jog> jog(Call& call, const axis::Jog& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  const auto said = raw_or_quantity<&axis::Jog::velocity_internal, &axis::Jog::velocity>(params);
  const auto velocity = co_await must(velocity_of(axis, said));
  // What goes on is in the audit once, and not with each call.
  call.goes_on = axis.claim_kind() == ClaimKind::jog && velocity.value != 0;
  const std::chrono::milliseconds hold(params.hold_ms);
  JogOrder order{ready.axis, ready.moves, {{velocity.value}, hold}};
  const auto started = co_await must(tmcld::jog(std::move(order)), axis);
  auto target = co_await in_unit(axis, started.goal.target);
  const auto until =
      std::chrono::floor<std::chrono::milliseconds>(started.goal.until.time_since_epoch());
  axis::Jogging result{started.goal.target.value, std::move(target.unit), target.number,
                       until.count(), std::vector<std::string>{}};
  if (!started.journal_failure.empty())
    result.warnings->push_back(journal_warning(started.journal_failure));
  co_return result;
}

}  // namespace tmcld::handlers
