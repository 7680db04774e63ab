/// What the methods of settings do.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/settings.hpp"

namespace tmcld::handlers {

Answer<settings::Read> read_all_settings(Call& call, const settings::Read& params);
Answer<settings::Compare> compare_with_file(Call& call, const settings::Compare& params);
Answer<settings::Load> load_file(Call& call, const settings::Load& params);
Answer<settings::Store> store_axis(Call& call, const settings::Store& params);

}  // namespace tmcld::handlers
