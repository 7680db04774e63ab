/// What the methods do; their rows are in method_table.cpp.
#pragma once

#include <boost/asio/awaitable.hpp>

#include "api/call.hpp"
#include "api/rpc_error.hpp"

namespace tmcld::handlers {

using Answer = boost::asio::awaitable<RpcResult>;

Answer discover(Call& call);

Answer list_buses(Call& call);
Answer scan(Call& call);

Answer list_modules(Call& call);
Answer execute(Call& call);

Answer list_axes(Call& call);
Answer move_to(Call& call);
Answer move_by(Call& call);
Answer rotate(Call& call);
Answer stop(Call& call);
Answer wait(Call& call);
Answer get_state(Call& call);
Answer get_units(Call& call);

Answer move_line(Call& call);

Answer stage_path(Call& call);
Answer plan_path(Call& call);
Answer run_path(Call& call);
Answer pause_path(Call& call);
Answer resume_path(Call& call);
Answer stop_path(Call& call);

Answer run_mint(Call& call);

Answer home(Call& call);
Answer start_home(Call& call);
Answer stop_home(Call& call);

Answer get_coordinate(Call& call);
Answer set_coordinate(Call& call);
Answer capture_coordinate(Call& call);
Answer move_to_coordinate(Call& call);
Answer start_coordinate(Call& call);
Answer store_coordinates(Call& call);
Answer load_coordinates(Call& call);

Answer get_global(Call& call);
Answer set_global(Call& call);
Answer store_global(Call& call);
Answer restore_global(Call& call);
Answer get_io(Call& call);
Answer set_io(Call& call);
Answer module_info(Call& call);
Answer report_arrivals(Call& call);
Answer reset_module(Call& call);
Answer factory_reset(Call& call);

Answer load_program(Call& call);
Answer compare_program(Call& call);
Answer read_program(Call& call);
Answer run_program(Call& call);
Answer stop_program(Call& call);
Answer step_program(Call& call);
Answer reset_program(Call& call);
Answer program_status(Call& call);
Answer set_breakpoint(Call& call);
Answer clear_breakpoint(Call& call);
Answer clear_breakpoints(Call& call);

Answer firmware_status(Call& call);
Answer stage_firmware(Call& call);
Answer upload_firmware(Call& call);

Answer get_parameter(Call& call);
Answer set_parameter(Call& call);
Answer store_parameter(Call& call);
Answer restore_parameter(Call& call);
Answer list_parameters(Call& call);

Answer stop_all(Call& call);

Answer subscribe(Call& call);
Answer unsubscribe(Call& call);

}  // namespace tmcld::handlers
