/// What the methods do; their rows are in method_table.cpp.
#pragma once

#include <boost/asio/awaitable.hpp>

#include "api/call.hpp"
#include "api/rpc_error.hpp"

namespace tmcld::handlers {

using Answer = boost::asio::awaitable<RpcResult>;

Answer discover(Call& call);

Answer list_buses(Call& call);
Answer scan(Call& call);

Answer list_modules(Call& call);
Answer execute(Call& call);

Answer list_axes(Call& call);
Answer move_to(Call& call);
Answer move_by(Call& call);
Answer rotate(Call& call);
Answer stop(Call& call);
Answer wait(Call& call);
Answer get_state(Call& call);
Answer get_units(Call& call);

Answer get_parameter(Call& call);
Answer set_parameter(Call& call);
Answer list_parameters(Call& call);

Answer stop_all(Call& call);

Answer subscribe(Call& call);
Answer unsubscribe(Call& call);

}  // namespace tmcld::handlers
