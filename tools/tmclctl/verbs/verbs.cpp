#include "verbs.hpp"

namespace tmclctl {

void add_verbs(Grammar& grammar) {
  add_ports(grammar);
  add_scan(grammar);
  add_lists(grammar);
  add_models(grammar);
  add_parameters(grammar);
  add_move(grammar);
  add_line(grammar);
  add_rotate(grammar);
  add_jog(grammar);
  add_stop(grammar);
  add_leases(grammar);
  add_state(grammar);
  add_watch(grammar);
  add_top(grammar);
  add_buses(grammar);
  add_trace(grammar);
  add_plot(grammar);
  add_capture(grammar);
  add_scan_positions(grammar);
  add_home(grammar);
  add_recover(grammar);
  add_errors(grammar);
  add_doctor(grammar);
  add_deadman(grammar);
  add_tokens(grammar);
  add_clients(grammar);
  add_page(grammar);
  add_verify(grammar);
  add_tune(grammar);
  add_coordinates(grammar);
  add_arrivals(grammar);
  add_eeprom(grammar);
  add_globals(grammar);
  add_settings(grammar);
  add_inputs(grammar);
  add_module(grammar);
  add_raw(grammar);
  add_call(grammar);
  add_firmware(grammar);
  add_solve(grammar, add_profile(grammar));
  add_mint_run(grammar, add_mint(grammar));
  const auto path = add_path(grammar);
  add_path_run(grammar, path);
  add_path_feed(grammar, path);
  add_path_steering(grammar, path);
  const auto program = add_program(grammar);
  add_module_programs(grammar, program);
  add_program_debug(grammar, program);
  add_fleet_apply(grammar, add_fleet(grammar));
  add_ramp(grammar);
  add_resonance(grammar);
  add_convert(grammar);
}

}  // namespace tmclctl
