/// What the methods about the configuration do.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/configuration.hpp"

namespace tmcld::handlers {

Answer<configuration::Get> get_configuration(Call& call, const configuration::Get& params);
Answer<configuration::Set> set_configuration(Call& call, const configuration::Set& params);

}  // namespace tmcld::handlers
