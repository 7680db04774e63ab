/// What tmclctl can do: one function for each verb.
#pragma once

#include "options.hpp"
#include "patience.hpp"
#include "screen.hpp"
#include "target.hpp"

namespace tmclctl {

/// What a verb works with.
struct Room {
  Target& target;
  Output& output;
  Patience& patience;
};

using VerbResult = Attempt<ExitCode>;

VerbResult run(const verb::Scan& verb, Room& room);
VerbResult run(const verb::Modules& verb, Room& room);
VerbResult run(const verb::Axes& verb, Room& room);
VerbResult run(const verb::Params& verb, Room& room);
VerbResult run(const verb::Get& verb, Room& room);
VerbResult run(const verb::Set& verb, Room& room);
VerbResult run(const verb::Move& verb, Room& room);
VerbResult run(const verb::Wait& verb, Room& room);
VerbResult run(const verb::Line& verb, Room& room);
VerbResult run(const verb::Rotate& verb, Room& room);
VerbResult run(const verb::Stop& verb, Room& room);
VerbResult run(const verb::State& verb, Room& room);
VerbResult run(const verb::Watch& verb, Room& room);
VerbResult run(const verb::Plot& verb, Room& room);
VerbResult run(const verb::Raw& verb, Room& room);
VerbResult run(const verb::CheckFirmware& verb, Room& room);
VerbResult run(const verb::UploadFirmware& verb, Room& room);
VerbResult run(const verb::Ramp& verb, Room& room);
VerbResult run(const verb::Ask& verb, Room& room);
/// Whether a method of tmcld changes nothing.
bool only_reads(std::string_view method);
VerbResult run(const verb::Arrivals& verb, Room& room);
VerbResult run(const verb::Home& verb, Room& room);
VerbResult run(const verb::Upload& verb, Room& room);
VerbResult run(const verb::Download& verb, Room& room);
VerbResult run(const verb::RunPath& verb, Room& room);
VerbResult run(const verb::RunMint& verb, Room& room);

VerbResult run(const verb::Complete& verb, Room& room);

/// These need no target.
VerbResult run(const verb::Simulate& verb, Output& output);
VerbResult run(const verb::SolveProfile& verb, Output& output);
VerbResult run(const verb::CheckMint& verb, Output& output);
VerbResult run(const verb::CheckPath& verb, Output& output);
VerbResult run(const verb::Assemble& verb, Output& output);
VerbResult run(const verb::Disassemble& verb, Output& output);
VerbResult run(const verb::FirmwareInfo& verb, Output& output);
VerbResult run(const verb::Convert& verb, Output& output);
VerbResult run(const verb::Models& verb, Output& output);
VerbResult run_on_model(const verb::Params& verb, Output& output);

}  // namespace tmclctl
