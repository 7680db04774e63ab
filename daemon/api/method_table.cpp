#include <algorithm>
#include <array>

#include "api/client_handlers.hpp"
#include "api/comparison_handlers.hpp"
#include "api/configuration_handlers.hpp"
#include "api/doctor_handlers.hpp"
#include "api/handlers.hpp"
#include "api/method.hpp"
#include "api/page_handlers.hpp"
#include "api/profile_handlers.hpp"
#include "api/relay_handlers.hpp"
#include "api/resonance_handlers.hpp"
#include "api/settings_handlers.hpp"
#include "api/token_handlers.hpp"
#include "api/tune_handlers.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using enum Role;

template <class R>
awaitable<Result<boost::json::object>> written(Task<R> answer) {
  co_await answer.promise().run();
  co_return answer.take().map(api::to_json<R>);
}

template <class>
struct ParamsOf;
template <class R, class Params>
struct ParamsOf<Task<R> (*)(Call&, const Params&)> {
  using Type = Params;
};

template <auto handler>
constexpr MethodInfo method(Role role) {
  using Params = typename ParamsOf<decltype(handler)>::Type;
  const auto& method = Params::method;
  return {method.name,
          method.summary,
          api::rows<Params>,
          api::rows<typename Params::Result>,
          method.effect,
          role,
          [](Call& call) { return written(handler(call, call.read<Params>())); }};
}

constexpr auto table = std::to_array<MethodInfo>({
    method<handlers::discover>(observe),
    method<handlers::list_buses>(observe),
    method<handlers::trace>(observe),
    method<handlers::scan>(observe),
    method<handlers::examine>(observe),
    method<handlers::list_modules>(observe),
    method<handlers::execute>(stop),
    method<handlers::list_axes>(observe),
    method<handlers::move_to>(operate),
    method<handlers::move_by>(operate),
    method<handlers::rotate>(operate),
    method<handlers::jog>(operate),
    method<handlers::measure_resonance>(operate),
    method<handlers::stop>(stop),
    method<handlers::wait>(observe),
    method<handlers::acquire_lease>(operate),
    method<handlers::renew_lease>(operate),
    method<handlers::release_lease>(stop),
    method<handlers::list_leases>(observe),
    method<handlers::break_lease>(configure),
    method<handlers::add_token>(configure),
    method<handlers::list_tokens>(configure),
    method<handlers::invite_by_token>(configure),
    method<handlers::revoke_token>(configure),
    method<handlers::list_clients>(configure),
    method<handlers::tail_audit>(configure),
    method<handlers::find_page>(observe),
    method<handlers::get_configuration>(configure),
    method<handlers::set_configuration>(configure),
    method<handlers::speak_for>(stop),
    method<handlers::move_line>(operate),
    method<handlers::stage_path>(operate),
    method<handlers::plan_path>(operate),
    method<handlers::run_path>(operate),
    method<handlers::pause_path>(operate),
    method<handlers::resume_path>(operate),
    method<handlers::status_of_paths>(observe),
    method<handlers::feed_path>(operate),
    method<handlers::stop_path>(stop),
    method<handlers::run_mint>(operate),
    method<handlers::get_ramp>(observe),
    method<handlers::plan_ramp>(observe),
    method<handlers::set_ramp>(operate),
    method<handlers::compare_ramps>(observe),
    method<handlers::find_ramp>(observe),
    method<handlers::simulate_profile>(observe),
    method<handlers::solve_profile>(observe),
    method<handlers::home>(operate),
    method<handlers::start_home>(operate),
    method<handlers::stop_home>(stop),
    method<handlers::recover>(operate),
    method<handlers::set_deadman>(configure),
    method<handlers::test_deadman>(configure),
    method<handlers::tune>(configure),
    method<handlers::verify>(configure),
    method<handlers::start_capture>(operate),
    method<handlers::capture_state>(observe),
    method<handlers::read_capture>(observe),
    method<handlers::end_capture>(operate),
    method<handlers::get_state>(observe),
    method<handlers::get_errors>(observe),
    method<handlers::get_units>(observe),
    method<handlers::get_parameter>(observe),
    method<handlers::set_parameter>(operate),
    method<handlers::store_parameter>(configure),
    method<handlers::restore_parameter>(configure),
    method<handlers::list_parameters>(observe),
    method<handlers::read_all_settings>(observe),
    method<handlers::compare_with_file>(observe),
    method<handlers::load_file>(configure),
    method<handlers::store_axis>(configure),
    method<handlers::get_coordinate>(observe),
    method<handlers::set_coordinate>(configure),
    method<handlers::capture_coordinate>(configure),
    method<handlers::move_to_coordinate>(operate),
    method<handlers::start_coordinate>(operate),
    method<handlers::store_coordinates>(configure),
    method<handlers::load_coordinates>(configure),
    method<handlers::get_global>(observe),
    method<handlers::set_global>(configure),
    method<handlers::store_global>(configure),
    method<handlers::restore_global>(configure),
    method<handlers::get_io>(observe),
    method<handlers::set_io>(operate),
    method<handlers::module_info>(observe),
    method<handlers::report_arrivals>(operate),
    method<handlers::reset_module>(configure),
    method<handlers::factory_reset>(configure),
    method<handlers::assemble_program>(observe),
    method<handlers::load_program>(configure),
    method<handlers::compare_program>(observe),
    method<handlers::read_program>(observe),
    method<handlers::run_program>(operate),
    method<handlers::stop_program>(operate),
    method<handlers::step_program>(operate),
    method<handlers::step_program_to>(operate),
    method<handlers::reset_program>(operate),
    method<handlers::program_status>(observe),
    method<handlers::set_breakpoint>(configure),
    method<handlers::clear_breakpoint>(configure),
    method<handlers::clear_breakpoints>(configure),
    method<handlers::firmware_status>(observe),
    method<handlers::stage_firmware>(configure),
    method<handlers::upload_firmware>(configure),
    method<handlers::stop_all>(stop),
    method<handlers::subscribe>(observe),
    method<handlers::unsubscribe>(observe),
});

}  // namespace

std::span<const MethodInfo> method_table() { return table; }

const MethodInfo* find_method(std::string_view name) {
  const auto* row = std::ranges::find(table, name, &MethodInfo::name);
  return row == table.end() ? nullptr : row;
}

}  // namespace tmcld
