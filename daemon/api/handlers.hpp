/// What the methods do; the table of them is in method_table.cpp.
#pragma once

#include <boost/asio/awaitable.hpp>

#include "api/call.hpp"
#include "api/task.hpp"
#include "tmcl/api/axis.hpp"
#include "tmcl/api/capture.hpp"
#include "tmcl/api/errors.hpp"
#include "tmcl/api/lease.hpp"
#include "tmcl/api/module.hpp"
#include "tmcl/api/parameter.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/api/program.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/api/verify.hpp"

namespace tmcld::handlers {

using namespace tmcl::api;

template <class Params>
using Answer = Task<typename Params::Result>;

Answer<rpc::Discover> discover(Call& call, const rpc::Discover& params);

Answer<bus::List> list_buses(Call& call, const bus::List& params);
Answer<bus::Trace> trace(Call& call, const bus::Trace& params);
Answer<bus::Scan> scan(Call& call, const bus::Scan& params);

Answer<module::List> list_modules(Call& call, const module::List& params);
Answer<module::Execute> execute(Call& call, const module::Execute& params);
Answer<module::Info> module_info(Call& call, const module::Info& params);
Answer<module::ReportArrivals> report_arrivals(Call& call, const module::ReportArrivals& params);
Answer<module::Reset> reset_module(Call& call, const module::Reset& params);
Answer<module::FactoryReset> factory_reset(Call& call, const module::FactoryReset& params);

Answer<axis::List> list_axes(Call& call, const axis::List& params);
Answer<axis::MoveTo> move_to(Call& call, const axis::MoveTo& params);
Answer<axis::MoveBy> move_by(Call& call, const axis::MoveBy& params);
Answer<axis::Rotate> rotate(Call& call, const axis::Rotate& params);
Answer<axis::Jog> jog(Call& call, const axis::Jog& params);
Answer<axis::Stop> stop(Call& call, const axis::Stop& params);
Answer<axis::Wait> wait(Call& call, const axis::Wait& params);
Answer<axis::GetState> get_state(Call& call, const axis::GetState& params);
Answer<axis::GetUnits> get_units(Call& call, const axis::GetUnits& params);
Answer<axis::GetRamp> get_ramp(Call& call, const axis::GetRamp& params);
Answer<axis::PlanRamp> plan_ramp(Call& call, const axis::PlanRamp& params);
Answer<axis::SetRamp> set_ramp(Call& call, const axis::SetRamp& params);
Answer<axis::Home> home(Call& call, const axis::Home& params);
Answer<axis::StartHome> start_home(Call& call, const axis::StartHome& params);
Answer<axis::StopHome> stop_home(Call& call, const axis::StopHome& params);
Answer<axis::Recover> recover(Call& call, const axis::Recover& params);
Answer<axis::GetErrors> get_errors(Call& call, const axis::GetErrors& params);
Answer<axis::SetDeadman> set_deadman(Call& call, const axis::SetDeadman& params);
Answer<axis::TestDeadman> test_deadman(Call& call, const axis::TestDeadman& params);
Answer<axis::Verify> verify(Call& call, const axis::Verify& params);

Answer<capture::Start> start_capture(Call& call, const capture::Start& params);
Answer<capture::GetState> capture_state(Call& call, const capture::GetState& params);
Answer<capture::Read> read_capture(Call& call, const capture::Read& params);
Answer<capture::End> end_capture(Call& call, const capture::End& params);

Answer<lease::Acquire> acquire_lease(Call& call, const lease::Acquire& params);
Answer<lease::Renew> renew_lease(Call& call, const lease::Renew& params);
Answer<lease::Release> release_lease(Call& call, const lease::Release& params);
Answer<lease::List> list_leases(Call& call, const lease::List& params);
Answer<lease::Break> break_lease(Call& call, const lease::Break& params);

Answer<line::Move> move_line(Call& call, const line::Move& params);

Answer<path::Stage> stage_path(Call& call, const path::Stage& params);
Answer<path::Plan> plan_path(Call& call, const path::Plan& params);
Answer<path::Run> run_path(Call& call, const path::Run& params);
Answer<path::Pause> pause_path(Call& call, const path::Pause& params);
Answer<path::Resume> resume_path(Call& call, const path::Resume& params);
Answer<path::Status> status_of_paths(Call& call, const path::Status& params);
Answer<path::Feed> feed_path(Call& call, const path::Feed& params);
Answer<path::Stop> stop_path(Call& call, const path::Stop& params);
Answer<mint::Run> run_mint(Call& call, const mint::Run& params);

Answer<coordinate::Get> get_coordinate(Call& call, const coordinate::Get& params);
Answer<coordinate::Set> set_coordinate(Call& call, const coordinate::Set& params);
Answer<coordinate::Capture> capture_coordinate(Call& call, const coordinate::Capture& params);
Answer<coordinate::Move> move_to_coordinate(Call& call, const coordinate::Move& params);
Answer<coordinate::Start> start_coordinate(Call& call, const coordinate::Start& params);
Answer<coordinate::Store> store_coordinates(Call& call, const coordinate::Store& params);
Answer<coordinate::Load> load_coordinates(Call& call, const coordinate::Load& params);

Answer<global::Get> get_global(Call& call, const global::Get& params);
Answer<global::Set> set_global(Call& call, const global::Set& params);
Answer<global::Store> store_global(Call& call, const global::Store& params);
Answer<global::Restore> restore_global(Call& call, const global::Restore& params);
Answer<io::Get> get_io(Call& call, const io::Get& params);
Answer<io::Set> set_io(Call& call, const io::Set& params);

Answer<program::Assemble> assemble_program(Call& call, const program::Assemble& params);
Answer<program::Load> load_program(Call& call, const program::Load& params);
Answer<program::Compare> compare_program(Call& call, const program::Compare& params);
Answer<program::Read> read_program(Call& call, const program::Read& params);
Answer<program::Run> run_program(Call& call, const program::Run& params);
Answer<program::Stop> stop_program(Call& call, const program::Stop& params);
Answer<program::Step> step_program(Call& call, const program::Step& params);
Answer<program::StepTo> step_program_to(Call& call, const program::StepTo& params);
Answer<program::Reset> reset_program(Call& call, const program::Reset& params);
Answer<program::Status> program_status(Call& call, const program::Status& params);
Answer<program::SetBreakpoint> set_breakpoint(Call& call, const program::SetBreakpoint& params);
Answer<program::ClearBreakpoint> clear_breakpoint(Call& call,
                                                  const program::ClearBreakpoint& params);
Answer<program::ClearBreakpoints> clear_breakpoints(Call& call,
                                                    const program::ClearBreakpoints& params);

Answer<firmware::Status> firmware_status(Call& call, const firmware::Status& params);
Answer<firmware::Stage> stage_firmware(Call& call, const firmware::Stage& params);
Answer<firmware::Upload> upload_firmware(Call& call, const firmware::Upload& params);

Answer<parameter::Get> get_parameter(Call& call, const parameter::Get& params);
Answer<parameter::Set> set_parameter(Call& call, const parameter::Set& params);
Answer<parameter::Store> store_parameter(Call& call, const parameter::Store& params);
Answer<parameter::Restore> restore_parameter(Call& call, const parameter::Restore& params);
Answer<parameter::List> list_parameters(Call& call, const parameter::List& params);

Answer<system::StopAll> stop_all(Call& call, const system::StopAll& params);

Answer<Subscribe> subscribe(Call& call, const Subscribe& params);
Answer<Unsubscribe> unsubscribe(Call& call, const Unsubscribe& params);

}  // namespace tmcld::handlers
