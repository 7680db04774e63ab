/// What a section of each kind adds to a configuration. Modules, axes, ports and [path] name a bus,
/// which must have been added before.
#pragma once

#include "config/draft.hpp"

namespace tmcld {

void add_daemon(Draft& draft, const DaemonSection& section);
void add_access(Draft& draft, const AccessSection& section);
void add_bus(Draft& draft, const BusSection& section);
void add_module(Draft& draft, const ModuleSection& section);
void add_axis(Draft& draft, const AxisSection& section);
void add_port(Draft& draft, const PortSection& section);
void add_path(Draft& draft, const PathSection& section);

}  // namespace tmcld
