/// What the method does by which a relay names the user that it speaks for.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/relay.hpp"

namespace tmcld::handlers {

Answer<relay::SpeakFor> speak_for(Call& call, const relay::SpeakFor& params);

}  // namespace tmcld::handlers
