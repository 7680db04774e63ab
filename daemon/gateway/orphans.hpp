/// Axes that another run of the daemon led when it ended without being asked to.
#pragma once

#include <memory>

#include "gateway/axis.hpp"
#include "gateway/journal.hpp"

namespace tmcld {

/// Stops the axis until it stands, sets back what was changed, unless its module has started again
/// since, and tells that (event orphan_stopped). Nobody else moves it meanwhile. What turned
/// unattended goes on, and is known as such. Returns at once.
void take_over(const std::shared_ptr<GatewayAxis>& axis, Holding holding);

/// Sets a setting to what it was, however long that takes. False if the module refuses it, or the
/// gateway ends. The axis must be claimed.
boost::asio::awaitable<bool> set_back(GatewayAxis& axis, tmcl::plan::Setting setting);

/// What the module said last by which it is noticed that it starts again.
std::optional<Holding::Seen> last_seen(const GatewayAxis& axis);

}  // namespace tmcld
