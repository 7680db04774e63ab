/// Verbs on many gateways at once.
#pragma once

#include "command_line/options.hpp"
#include "fleet/fleet.hpp"

namespace tmclctl {

Result<ExitCode> run_in_fleet(const verb::Axes& verb, Fleet& fleet);
Result<ExitCode> run_in_fleet(const verb::State& verb, Fleet& fleet);
Result<ExitCode> run_in_fleet(const verb::Stop& verb, Fleet& fleet);
Result<ExitCode> run_in_fleet(const verb::FleetGateways& verb, Fleet& fleet);

}  // namespace tmclctl
