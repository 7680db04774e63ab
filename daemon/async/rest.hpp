/// A pause of one coroutine: the reactor goes on meanwhile.
#pragma once

#include <boost/asio/awaitable.hpp>

#include "tmcl/context_clock.hpp"

namespace tmcld {

boost::asio::awaitable<void> rest(tmcl::Duration duration);

}  // namespace tmcld
