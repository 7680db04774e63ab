// arrivals.
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "names.hpp"
#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using Motors = std::vector<std::uint8_t>;

json::array to_json(const Motors& motors) { return json::array(motors.begin(), motors.end()); }

json::object params_of(const ModuleName& module, const verb::Arrivals& verb) {
  json::object params{{"address", module.address}, {"motors", to_json(verb.motors)}};
  if (!module.bus.empty()) params["bus"] = module.bus;
  if (!verb.next) params["every"] = true;
  return params;
}

void print(const ModuleName& module, const Motors& motors, double at_s, Output& output) {
  if (output.json) {
    return print_json({{"address", module.address}, {"motors", to_json(motors)}, {"time_s", at_s}},
                      output);
  }
  output.out << fmt::format("{:9.3f} s  module {}: motor {} arrived", at_s, module.address,
                            fmt::join(motors, " and motor "))
             << std::endl;
}

}  // namespace

VerbResult run(const verb::Arrivals& verb, Context& context) {
  const auto module = parse_module(verb.module);
  if (!module) return tl::unexpected(module.error());
  const auto ask = [&] {
    return context.target.perform("module.report_arrivals", params_of(*module, verb), {})
        .map([](const json::object&) {});
  };
  if (verb.off) {
    const auto off = ask();
    if (!off) return tl::unexpected(off.error());
    if (context.output.json)
      print_json({{"address", module->address}, {"motors", to_json(verb.motors)}, {"off", true}},
                 context.output);
    return ExitCode::done;
  }
  const auto begin = context.host.now();
  const auto elapsed_s = [&] {
    return std::chrono::duration<double>(context.host.now() - begin).count();
  };
  std::set<std::uint8_t> missing(verb.motors.begin(), verb.motors.end());
  const auto heard = context.target.hear_arrivals(*module, ask, [&](const Motors* motors) {
    if (motors != nullptr) {
      print(*module, *motors, elapsed_s(), context.output);
      for (const auto motor : *motors) missing.erase(motor);
    }
    // Ending it is what Ctrl-C is for here, so that is no failure.
    return context.host.signal() == 0 && !(verb.next && missing.empty()) &&
           !(verb.for_s && elapsed_s() >= *verb.for_s);
  });
  if (!heard && context.host.signal() == 0) return tl::unexpected(heard.error());
  return ExitCode::done;
}

}  // namespace tmclctl
