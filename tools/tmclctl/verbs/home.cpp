// home.
#include <fmt/format.h>

#include "following.hpp"
#include "json_read.hpp"
#include "print.hpp"
#include "progress_line.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

std::string how_to_end(const verb::Home& verb, const Target& target) {
  return fmt::format("End it with: tmclctl{} home {} --stop", target.options(), verb.axis);
}

Error explained(Error failure, const verb::Home& verb, Context& context) {
  if (context.host.signal() != 0) {
    return interrupted_error(
        context.host.signal(),
        fmt::format("no longer waiting; {} goes on searching its reference", verb.axis),
        how_to_end(verb, context.target));
  }
  if (failure.name != "deadline_passed") return failure;
  failure.kind = ErrorKind::ended_early;
  failure.name = "timeout";
  if (verb.leave) failure.hint = "The motor goes on searching. " + how_to_end(verb, context.target);
  return failure;
}

// Nothing for a module that does not tell.
std::optional<std::string> length_text(const json::object& result, const std::string& name,
                                       bool internal) {
  const auto microsteps = number_at(result, name + "_microsteps");
  if (!microsteps) return std::nullopt;
  const auto in_unit = number_at(result, name);
  if (!in_unit || internal) return fmt::format("{:.0f} microsteps", *microsteps);
  return shown(InUnit{*in_unit, text_at(result, "unit")}, *microsteps);
}

json::object named(const std::string& axis, json::object result) {
  result["axis"] = axis;
  return result;
}

void print(const json::object& result, const verb::Home& verb, std::ostream& out) {
  out << fmt::format("{} stands at its reference\n", verb.axis);
  if (const auto correction = length_text(result, "correction", verb.internal))
    out << fmt::format("zero was at {} before\n", *correction);
  const auto distance = length_text(result, "switch_distance", verb.internal);
  if (distance) out << fmt::format("{} between the end switches\n", *distance);
}

}  // namespace

VerbResult run(const verb::Home& verb, Context& context) {
  json::object params{{"axis", verb.axis}};
  if (verb.mode) params["mode"] = *verb.mode;
  if (!verb.max_travel.empty())
    put(params, "max_travel", "max_travel_microsteps", {verb.max_travel, verb.internal});
  const auto perform = [&](const char* method, const std::string& told) {
    return context.target.perform(method, std::move(params), {})
        .map([&](const json::object& result) {
          warn(texts_at(result, "warnings"), context.output);
          if (context.output.json) {
            print_json(named(verb.axis, result), context.output);
          } else {
            context.output.out << told << '\n';
          }
          return ExitCode::done;
        });
  };
  if (verb.stop) return perform("axis.stop_home", verb.axis + " searches no longer");
  if (verb.no_wait) {
    return perform("axis.start_home", fmt::format("{} searches its reference. {}", verb.axis,
                                                  how_to_end(verb, context.target)));
  }

  constexpr double milliseconds = 1000;
  if (verb.timeout_s)
    params["timeout_ms"] = static_cast<std::int64_t>(*verb.timeout_s * milliseconds);
  if (verb.leave) params["leave"] = true;
  ProgressLine line(context.output);
  const auto result =
      context.target.perform("axis.home", std::move(params), [&](const json::object& news) {
        line.show(fmt::format("{} searches its reference, step {}", verb.axis,
                              integer_at<std::int32_t>(news, "step")));
        return context.host.signal() == 0;
      });
  line.clear();
  if (!result) return tl::unexpected(explained(result.error(), verb, context));
  warn(texts_at(*result, "warnings"), context.output);
  if (context.output.json) {
    print_json(named(verb.axis, *result), context.output);
  } else {
    print(*result, verb, context.output.out);
  }
  return ExitCode::done;
}

VerbResult run(const verb::Recover& verb, Context& context) {
  std::vector<std::string> names{verb.axis};
  if (verb.all) {
    // Also those without a name in the configuration.
    const auto listed = context.target.perform("axis.list", {{"all", true}}, {});
    if (!listed) return tl::unexpected(listed.error());
    names.clear();
    for (const auto& axis : listed->at("axes").as_array())
      names.emplace_back(axis.at("name").as_string());
  }
  for (const auto& name : names) {
    const auto recovered = context.target.perform("axis.recover", {{"axis", name}}, {});
    if (!recovered) return tl::unexpected(recovered.error());
    if (!context.output.json) context.output.out << name << " may move\n";
  }
  if (context.output.json)
    print_json({{"recovered", json::array(names.begin(), names.end())}}, context.output);
  return ExitCode::done;
}

}  // namespace tmclctl
