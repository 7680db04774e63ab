/// What tmclctl can do: one function for each verb.
#pragma once

#include "gateway.hpp"
#include "module_lists.hpp"
#include "options.hpp"
#include "readings.hpp"
#include "typed.hpp"

namespace tmclctl {

Result<ExitCode> run(const verb::Scan& verb, Context& context);
Result<ExitCode> run(const verb::Modules& verb, Context& context);
Result<ExitCode> run(const verb::Axes& verb, Context& context);
Result<ExitCode> run(const verb::Params& verb, Context& context);
Result<ExitCode> run(const verb::Get& verb, Context& context);
Result<ExitCode> run(const verb::Set& verb, Context& context);
Result<ExitCode> run(const verb::Move& verb, Context& context);
Result<ExitCode> run(const verb::Wait& verb, Context& context);
Result<ExitCode> run(const verb::Line& verb, Context& context);
Result<ExitCode> run(const verb::Rotate& verb, Context& context);
Result<ExitCode> run(const verb::Stop& verb, Context& context);
Result<ExitCode> run(const verb::State& verb, Context& context);
Result<ExitCode> run(const verb::Watch& verb, Context& context);
Result<ExitCode> run(const verb::Top& verb, Context& context);
Result<ExitCode> run(const verb::Buses& verb, Context& context);
Result<ExitCode> run(const verb::Trace& verb, Context& context);
Result<ExitCode> run(const verb::Plot& verb, Context& context);
Result<ExitCode> run(const verb::Capture& verb, Context& context);
Result<ExitCode> run(const verb::Raw& verb, Context& context);
Result<ExitCode> run(const verb::CheckFirmware& verb, Context& context);
Result<ExitCode> run(const verb::UploadFirmware& verb, Context& context);
Result<ExitCode> run(const verb::Ramp& verb, Context& context);
Result<ExitCode> run(const verb::Ask& verb, Context& context);
/// Whether a method of tmcld changes nothing.
bool only_reads(std::string_view method);
Result<ExitCode> run(const verb::Arrivals& verb, Context& context);
Result<ExitCode> run(const verb::Home& verb, Context& context);
Result<ExitCode> run(const verb::Recover& verb, Context& context);
Result<ExitCode> run(const verb::Errors& verb, Context& context);
Result<ExitCode> run(const verb::SetDeadman& verb, Context& context);
Result<ExitCode> run(const verb::TestDeadman& verb, Context& context);
Result<ExitCode> run(const verb::Verify& verb, Context& context);
Result<ExitCode> run(const verb::Upload& verb, Context& context);
Result<ExitCode> run(const verb::Download& verb, Context& context);
Result<ExitCode> run(const verb::RunLeased& verb, Context& context);
Result<ExitCode> run(const verb::Leases& verb, Context& context);
Result<ExitCode> run(const verb::BreakLease& verb, Context& context);
Result<ExitCode> run(const verb::AddToken& verb, Context& context);
Result<ExitCode> run(const verb::Tokens& verb, Context& context);
Result<ExitCode> run(const verb::RevokeToken& verb, Context& context);
Result<ExitCode> run(const verb::RunPath& verb, Context& context);
Result<ExitCode> run(const verb::RunMint& verb, Context& context);

Result<ExitCode> run(const verb::Complete& verb, Context& context);

/// These need no gateway.
Result<ExitCode> run(const verb::Simulate& verb, Output& output);
Result<ExitCode> run(const verb::SolveProfile& verb, Output& output);
Result<ExitCode> run(const verb::CheckMint& verb, Output& output);
Result<ExitCode> run(const verb::CheckPath& verb, Output& output);
Result<ExitCode> run(const verb::Assemble& verb, Output& output);
Result<ExitCode> run(const verb::Disassemble& verb, Output& output);
Result<ExitCode> run(const verb::FirmwareInfo& verb, Output& output);
Result<ExitCode> run(const verb::Convert& verb, Output& output);
Result<ExitCode> run(const verb::Models& verb, Output& output);
Result<ExitCode> run(const verb::Ports& verb, Output& output);
Result<ExitCode> run_on_model(const verb::Params& verb, Output& output);
Result<ExitCode> run_on_file(const verb::Trace& verb, Output& output);

}  // namespace tmclctl
