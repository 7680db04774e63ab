/// A stop that repeats itself, for an axis that did not stop when it should have.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gateway/axis/axis.hpp"
#include "gateway/event.hpp"

namespace tmcld {

/// Stops the axis again and again until its module has taken a stop and says that it stands,
/// however long that takes: across silence, lost links, and restarts of the module. Then sets back
/// what GatewayAxis::before() says, unless the module has started again meanwhile. Until then
/// no other call moves it (Errc::axis_claimed); the event axis_stopped tells the end. Only the
/// end of the gateway ends it before that. Takes over the claim of the axis. Returns at once.
void stop_until_it_stands(const std::shared_ptr<GatewayAxis>& axis);

/// Such a stop, which the caller waits for. The axis must be claimed.
boost::asio::awaitable<void> be_stopped(GatewayAxis& axis);

/// Until the module answers; false if the gateway ends before.
boost::asio::awaitable<bool> meet(GatewayAxis& axis);
/// Sets a setting to what GatewayAxis::before() says, however long that takes. False if the module
/// refuses it, or the gateway ends; nothing if it is not to be set back any more. The axis must be
/// claimed.
boost::asio::awaitable<std::optional<bool>> set_back(GatewayAxis& axis, std::uint8_t parameter);

/// What GatewayAxis::before() says, in the reverse of the order in which it was changed. Gives what
/// became of it, in words. The axis must be claimed.
boost::asio::awaitable<std::string> set_all_back(GatewayAxis& axis);

/// Of an axis that is given such a stop: a sentence without a full stop.
std::string not_stopped(const std::string& axis);
/// What of the axis is to be set back when its module takes it; empty if nothing is.
std::vector<UnrestoredSetting> unrestored_of(const GatewayAxis& axis);
/// An event about one axis.
GatewayEvent event_of(const GatewayAxis& axis, GatewayEvent::Kind kind, std::string text);

}  // namespace tmcld
