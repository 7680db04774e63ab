/// What the method about the page for browsers does.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/page.hpp"

namespace tmcld::handlers {

Answer<page::Find> find_page(Call& call, const page::Find& params);

}  // namespace tmcld::handlers
