/// Modules as methods name them: a bus and an address, whether an axis is configured there or not.
#pragma once

#include <concepts>
#include <type_traits>
#include <utility>

#include "api/lookup.hpp"
#include "tmcl/api/module.hpp"

namespace tmcld {

struct ModuleChoice {
  std::shared_ptr<GatewayBus> bus;
  tmcl::ModuleAddress address{};
  Deadline deadline{};  ///< Of the call.
};

inline tmcl::ModuleAddress address_of(const api::OnModule& params) {
  return tmcl::ModuleAddress{params.address};
}

Result<ModuleChoice> module_of(const Call& call, const api::OnModule& params, Deadline deadline);
template <class Params>
Result<ModuleChoice> module_of(const Call& call, const Params& params) {
  return module_of(call, params, call.deadline(params));
}

/// What is known about the module is old now.
void expect_news(const ModuleChoice& module);

/// Runs a verb on a module, within the call's deadline.
template <class T>
Task<T> run_on(const ModuleChoice& module, const Call& call, tmcl::Script<tmcl::Result<T>> script) {
  RunOptions options;
  options.deadline = module.deadline;
  options.permit = call.permit;
  auto result = co_await module.bus->run(std::move(script), std::move(options));
  if (!result && result.error().bus.empty()) result.error().bus = module.bus->name();
  if constexpr (std::is_void_v<T>) {
    co_await must(std::move(result));
  } else {
    auto value = co_await must(std::move(result));
    co_return value;
  }
}

/// What is known about the module is old afterwards.
constexpr bool makes_news = true;

/// The same for a verb that gives nothing.
Task<api::Nothing> act_on(const Call& call, Result<ModuleChoice> module,
                          tmcl::Script<tmcl::Result<void>> script, bool news = false);
template <std::derived_from<api::OnModule> Params>
auto act_on(const Call& call, const Params& params, tmcl::Script<tmcl::Result<void>> script,
            bool news = false) {
  return act_on(call, module_of(call, params), std::move(script), news);
}

}  // namespace tmcld
