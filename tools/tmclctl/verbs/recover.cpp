// recover.
#include <fmt/format.h>

#include "output/print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;

Result<ExitCode> run(const verb::Recover& verb, Context& context) {
  std::vector<std::string> names{verb.axis};
  if (verb.all) {
    // Also those without a name in the configuration.
    const auto listed = context.call(api::axis::List{true});
    if (!listed) return tl::unexpected(listed.error());
    names.clear();
    for (const auto& axis : listed->axes) names.push_back(axis.name);
  }
  for (const auto& name : names) {
    const auto recovered = context.call(api::axis::Recover{name});
    if (!recovered) return tl::unexpected(recovered.error());
    if (!context.output.json) context.output.out << name << " may move\n";
  }
  if (context.output.json)
    print_json({{"recovered", json::array(names.begin(), names.end())}}, context.output);
  return ExitCode::done;
}

constexpr const char* recover_help = R"(
When a module has started again, or is another one than before, tmcld moves its axes no more: where
they are, and how they are set up, is what the module starts with. 'tmclctl home x' finds the place
again. Where none is needed, or you have looked, this says that the axis may move. The settings are
not put back: what is not stored in the module (see 'tmclctl store') has to be set again.

  tmclctl recover x
  tmclctl recover --all
)";

}  // namespace

void add_recover(Grammar& grammar) {
  auto recover = grammar.verb<verb::Recover>(
      "recover", access::acts, "Let an axis move again whose module restarted", recover_help, run);
  recover.optional_word("AXIS", axis_meaning, text(recover->axis));
  recover.flag("--all", "Every axis there is", recover->all);
  recover.object(
      [](const verb::Recover& said, bool) {
        return said.axis.empty() != said.all ? "name one axis, or say --all" : "";
      },
      "'tmclctl axes' lists the axes");
}

}  // namespace tmclctl
