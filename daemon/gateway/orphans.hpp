/// Axes that another run of the daemon led when it ended without being asked to.
#pragma once

#include <memory>

#include "gateway/axis/axis.hpp"
#include "gateway/store/journal.hpp"

namespace tmcld {

class Gateway;

/// Stops the axis until it stands, sets back what was changed, unless its module has started again
/// since, and tells that (event orphan_stopped). No client moves it meanwhile. What turned
/// unattended goes on, and is known as such. Returns at once.
void take_over(const std::shared_ptr<GatewayAxis>& axis, Holding holding);

/// Where it is not known what another run led: stops every motor of the bus that turns by velocity,
/// once its module answers, and tells that (event orphan_stopped). No client moves an axis of
/// the configuration before that is known. What goes to a position ends by itself, and goes on
/// where the module tells that it does. Returns at once.
void stop_what_turns(const std::shared_ptr<Gateway>& gateway,
                     const std::shared_ptr<GatewayBus>& bus);

/// What the module said last by which it is noticed that it starts again.
std::optional<Holding::Seen> last_seen(const GatewayAxis& axis);

}  // namespace tmcld
