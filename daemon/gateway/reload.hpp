/// Another configuration for a gateway that runs: all of it, or nothing.
///
/// A bus about which it says the same goes on untouched. One about which it says something else, or
/// nothing any more, is closed, and opened anew with all of its modules and axes, as if tmcld had
/// been started again for it. So all of its motors must rest, and belong to no client.
#pragma once

#include <memory>
#include <string>

#include <boost/asio/awaitable.hpp>
#include <tl/expected.hpp>

#include "config/config.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// What would become of the buses by reload(), in words, or why it would refuse. Modules are asked
/// whether their motors stand; nothing changes. The configuration must outlive it.
boost::asio::awaitable<tl::expected<std::string, std::string>> foresee_reload(
    std::shared_ptr<Gateway> gateway, const Config& config);

/// What has become of the buses, in words.
/// Errors: why all stays as it was, with the axis or bus that it is for.
boost::asio::awaitable<tl::expected<std::string, std::string>> reload(
    std::shared_ptr<Gateway> gateway, Config config);

}  // namespace tmcld
