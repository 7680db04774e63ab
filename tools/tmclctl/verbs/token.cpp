// token add, token list, token revoke.
#include "tmcl/api/token.hpp"
#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {

namespace api = tmcl::api;

Result<ExitCode> run(const verb::AddToken& verb, Context& context) {
  api::token::Add wish{verb.role};
  if (!verb.name.empty()) wish.name = verb.name;
  const auto added = context.call(wish);
  if (!added) return tl::unexpected(added.error());
  if (context.output.json) {
    print_json(api::to_json(*added), context.output);
    return ExitCode::done;
  }
  // Alone on standard output, so that it can go into a file.
  context.output.out << added->token << '\n';
  context.output.err << "tmclctl: " << added->name << " may " << added->role
                     << "; the token is not shown again\n";
  return ExitCode::done;
}

Result<ExitCode> run(const verb::Tokens&, Context& context) {
  const auto all = context.call(api::token::List{});
  if (!all) return tl::unexpected(all.error());
  if (context.output.json) {
    print_json(api::to_json(*all), context.output);
    return ExitCode::done;
  }
  Table table({"TOKEN", "ROLE", "MADE"});
  for (const auto& token : all->tokens) table.add({token.name, token.role, token.made});
  table.print(context.output.out);
  return ExitCode::done;
}

Result<ExitCode> run(const verb::RevokeToken& verb, Context& context) {
  const auto revoked = context.call(api::token::Revoke{verb.name});
  if (!revoked) return tl::unexpected(revoked.error());
  if (context.output.json) {
    print_json({{"name", verb.name}, {"revoked", true}}, context.output);
  } else {
    context.output.out << verb.name << " lets nobody in any more\n";
  }
  return ExitCode::done;
}

}  // namespace tmclctl
