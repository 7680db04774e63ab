/// What tmclctl can do: one function for each verb.
#pragma once

#include "gateway.hpp"
#include "module_lists.hpp"
#include "options.hpp"
#include "readings.hpp"
#include "typed.hpp"

namespace tmclctl {

using VerbResult = Result<ExitCode>;

VerbResult run(const verb::Scan& verb, Context& context);
VerbResult run(const verb::Modules& verb, Context& context);
VerbResult run(const verb::Axes& verb, Context& context);
VerbResult run(const verb::Params& verb, Context& context);
VerbResult run(const verb::Get& verb, Context& context);
VerbResult run(const verb::Set& verb, Context& context);
VerbResult run(const verb::Move& verb, Context& context);
VerbResult run(const verb::Wait& verb, Context& context);
VerbResult run(const verb::Line& verb, Context& context);
VerbResult run(const verb::Rotate& verb, Context& context);
VerbResult run(const verb::Stop& verb, Context& context);
VerbResult run(const verb::State& verb, Context& context);
VerbResult run(const verb::Watch& verb, Context& context);
VerbResult run(const verb::Top& verb, Context& context);
VerbResult run(const verb::Buses& verb, Context& context);
VerbResult run(const verb::Trace& verb, Context& context);
VerbResult run(const verb::Plot& verb, Context& context);
VerbResult run(const verb::Capture& verb, Context& context);
VerbResult run(const verb::Raw& verb, Context& context);
VerbResult run(const verb::CheckFirmware& verb, Context& context);
VerbResult run(const verb::UploadFirmware& verb, Context& context);
VerbResult run(const verb::Ramp& verb, Context& context);
VerbResult run(const verb::Ask& verb, Context& context);
/// Whether a method of tmcld changes nothing.
bool only_reads(std::string_view method);
VerbResult run(const verb::Arrivals& verb, Context& context);
VerbResult run(const verb::Home& verb, Context& context);
VerbResult run(const verb::Recover& verb, Context& context);
VerbResult run(const verb::Errors& verb, Context& context);
VerbResult run(const verb::SetDeadman& verb, Context& context);
VerbResult run(const verb::TestDeadman& verb, Context& context);
VerbResult run(const verb::Verify& verb, Context& context);
VerbResult run(const verb::Upload& verb, Context& context);
VerbResult run(const verb::Download& verb, Context& context);
VerbResult run(const verb::RunLeased& verb, Context& context);
VerbResult run(const verb::Leases& verb, Context& context);
VerbResult run(const verb::BreakLease& verb, Context& context);
VerbResult run(const verb::AddToken& verb, Context& context);
VerbResult run(const verb::Tokens& verb, Context& context);
VerbResult run(const verb::RevokeToken& verb, Context& context);
VerbResult run(const verb::RunPath& verb, Context& context);
VerbResult run(const verb::RunMint& verb, Context& context);

VerbResult run(const verb::Complete& verb, Context& context);

/// These need no gateway.
VerbResult run(const verb::Simulate& verb, Output& output);
VerbResult run(const verb::SolveProfile& verb, Output& output);
VerbResult run(const verb::CheckMint& verb, Output& output);
VerbResult run(const verb::CheckPath& verb, Output& output);
VerbResult run(const verb::Assemble& verb, Output& output);
VerbResult run(const verb::Disassemble& verb, Output& output);
VerbResult run(const verb::FirmwareInfo& verb, Output& output);
VerbResult run(const verb::Convert& verb, Output& output);
VerbResult run(const verb::Models& verb, Output& output);
VerbResult run(const verb::Ports& verb, Output& output);
VerbResult run_on_model(const verb::Params& verb, Output& output);
VerbResult run_on_file(const verb::Trace& verb, Output& output);

}  // namespace tmclctl
