/// What a section of each kind adds to a configuration. Modules, axes and ports name a bus, which
/// must have been added before.
#pragma once

#include "config/draft.hpp"

namespace tmcld {

void add_daemon(Draft& draft, const ConfigSection& section);
void add_access(Draft& draft, const ConfigSection& section);
void add_bus(Draft& draft, const ConfigSection& section);
void add_module(Draft& draft, const ConfigSection& section);
void add_axis(Draft& draft, const ConfigSection& section);
void add_port(Draft& draft, const ConfigSection& section);

}  // namespace tmcld
