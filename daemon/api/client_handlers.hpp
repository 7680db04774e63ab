/// What the methods about clients and the audit do.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/client.hpp"

namespace tmcld::handlers {

Answer<clients::List> list_clients(Call& call, const clients::List& params);
Answer<audit::Tail> tail_audit(Call& call, const audit::Tail& params);

}  // namespace tmcld::handlers
