#include <algorithm>
#include <array>

#include "api/handlers.hpp"
#include "api/method.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;

template <class R>
awaitable<RpcResult> written(awaitable<Lookup<R>> answer) {
  auto result = co_await std::move(answer);
  if (!result) co_return tl::unexpected(std::move(result.error()));
  co_return api::to_json(*result);
}

template <class>
struct ParamsOf;
template <class R, class Params>
struct ParamsOf<awaitable<Lookup<R>> (*)(Call&, const Params&)> {
  using Type = Params;
};

template <class Params>
constexpr MethodInfo described(awaitable<RpcResult> (*handler)(Call&)) {
  const auto& method = Params::method;
  return {method.name,   method.summary, api::rows<Params>, api::rows<typename Params::Result>,
          method.effect, handler};
}

template <auto handler>
constexpr MethodInfo method() {
  using Params = typename ParamsOf<decltype(handler)>::Type;
  return described<Params>([](Call& call) { return written(handler(call, call.read<Params>())); });
}

constexpr auto table = std::to_array<MethodInfo>({
    method<handlers::discover>(),
    method<handlers::list_buses>(),
    method<handlers::scan>(),
    method<handlers::list_modules>(),
    method<handlers::execute>(),
    method<handlers::list_axes>(),
    method<handlers::move_to>(),
    method<handlers::move_by>(),
    method<handlers::rotate>(),
    method<handlers::stop>(),
    method<handlers::wait>(),
    method<handlers::acquire_lease>(),
    method<handlers::renew_lease>(),
    method<handlers::release_lease>(),
    method<handlers::list_leases>(),
    method<handlers::break_lease>(),
    method<handlers::move_line>(),
    method<handlers::stage_path>(),
    described<api::path::Plan>(handlers::plan_path),
    described<api::path::Run>(handlers::run_path),
    described<api::path::Pause>(handlers::pause_path),
    described<api::path::Resume>(handlers::resume_path),
    described<api::path::Stop>(handlers::stop_path),
    described<api::mint::Run>(handlers::run_mint),
    method<handlers::home>(),
    method<handlers::start_home>(),
    method<handlers::stop_home>(),
    method<handlers::recover>(),
    method<handlers::get_state>(),
    method<handlers::get_units>(),
    method<handlers::get_parameter>(),
    method<handlers::set_parameter>(),
    method<handlers::store_parameter>(),
    method<handlers::restore_parameter>(),
    method<handlers::list_parameters>(),
    method<handlers::get_coordinate>(),
    method<handlers::set_coordinate>(),
    method<handlers::capture_coordinate>(),
    method<handlers::move_to_coordinate>(),
    method<handlers::start_coordinate>(),
    method<handlers::store_coordinates>(),
    method<handlers::load_coordinates>(),
    method<handlers::get_global>(),
    method<handlers::set_global>(),
    method<handlers::store_global>(),
    method<handlers::restore_global>(),
    method<handlers::get_io>(),
    method<handlers::set_io>(),
    method<handlers::module_info>(),
    method<handlers::report_arrivals>(),
    method<handlers::reset_module>(),
    method<handlers::factory_reset>(),
    method<handlers::load_program>(),
    method<handlers::compare_program>(),
    method<handlers::read_program>(),
    method<handlers::run_program>(),
    method<handlers::stop_program>(),
    method<handlers::step_program>(),
    method<handlers::reset_program>(),
    method<handlers::program_status>(),
    method<handlers::set_breakpoint>(),
    method<handlers::clear_breakpoint>(),
    method<handlers::clear_breakpoints>(),
    method<handlers::firmware_status>(),
    method<handlers::stage_firmware>(),
    method<handlers::upload_firmware>(),
    method<handlers::stop_all>(),
    method<handlers::subscribe>(),
    method<handlers::unsubscribe>(),
});

}  // namespace

std::span<const MethodInfo> method_table() { return table; }

const MethodInfo* find_method(std::string_view name) {
  const auto* row = std::ranges::find(table, name, &MethodInfo::name);
  return row == table.end() ? nullptr : row;
}

}  // namespace tmcld
