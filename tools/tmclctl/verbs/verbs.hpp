/// The verbs of the command line. Each file of this folder has some: their words, options and help,
/// and what carries them out.
#pragma once

#include "axis/module_lists.hpp"
#include "axis/readings.hpp"
#include "axis/typed.hpp"
#include "command_line/completion.hpp"
#include "command_line/grammar.hpp"
#include "connection/gateway.hpp"

namespace tmclctl {

/// All of them, in the order in which --help lists them.
void add_verbs(Grammar& grammar);

/// What `scan --bauds` and `scan --auto` do.
Result<ExitCode> scan_ports(const verb::Scan& verb, const Where& where, Output& output, Host& host);

void add_ports(Grammar& grammar);
void add_scan(Grammar& grammar);
void add_lists(Grammar& grammar);
void add_models(Grammar& grammar);
void add_parameters(Grammar& grammar);
void add_move(Grammar& grammar);
void add_line(Grammar& grammar);
void add_rotate(Grammar& grammar);
void add_jog(Grammar& grammar);
void add_stop(Grammar& grammar);
void add_leases(Grammar& grammar);
void add_state(Grammar& grammar);
void add_watch(Grammar& grammar);
void add_top(Grammar& grammar);
void add_buses(Grammar& grammar);
void add_trace(Grammar& grammar);
void add_plot(Grammar& grammar);
void add_call(Grammar& grammar);
Form add_fleet(Grammar& grammar);
void add_fleet_apply(Grammar& grammar, const Form& group);
void add_capture(Grammar& grammar);
void add_scan_positions(Grammar& grammar);
void add_home(Grammar& grammar);
void add_recover(Grammar& grammar);
void add_errors(Grammar& grammar);
void add_doctor(Grammar& grammar);
void add_deadman(Grammar& grammar);
void add_tokens(Grammar& grammar);
void add_clients(Grammar& grammar);
void add_page(Grammar& grammar);
void add_verify(Grammar& grammar);
void add_tune(Grammar& grammar);
void add_coordinates(Grammar& grammar);
void add_arrivals(Grammar& grammar);
void add_eeprom(Grammar& grammar);
void add_globals(Grammar& grammar);
void add_settings(Grammar& grammar);
void add_inputs(Grammar& grammar);
void add_module(Grammar& grammar);
void add_raw(Grammar& grammar);
void add_firmware(Grammar& grammar);
/// These return the group, for the files that add to it.
Form add_profile(Grammar& grammar);
void add_solve(Grammar& grammar, const Form& profile);
Form add_mint(Grammar& grammar);
void add_mint_run(Grammar& grammar, const Form& mint);
Form add_path(Grammar& grammar);
void add_path_run(Grammar& grammar, const Form& path);
void add_path_feed(Grammar& grammar, const Form& path);
void add_path_steering(Grammar& grammar, const Form& path);
Form add_program(Grammar& grammar);
void add_module_programs(Grammar& grammar, const Form& program);
void add_program_debug(Grammar& grammar, const Form& program);
void add_ramp(Grammar& grammar);
void add_resonance(Grammar& grammar);
void add_convert(Grammar& grammar);

/// --model, and what a turn of its motor is.
void add_offline_axis(Form& form, verb::OfflineAxis& into);
/// Why the words about it do not go together; empty if they do.
std::string objection_to(const verb::OfflineAxis& axis);

/// The parameters of a model that need not be there.
Result<ExitCode> run_on_model(const verb::Params& verb, Output& output);
/// Prints what the gateway has of a kind, one a line, for the shell's completion.
Result<ExitCode> complete_by_gateway(const Completion& completion, Context& context);

}  // namespace tmclctl
