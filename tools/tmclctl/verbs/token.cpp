// token add, token list, token revoke.
#include "tmcl/api/token.hpp"

#include "output/print.hpp"
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
  table.print(context.output);
  return ExitCode::done;
}

Result<ExitCode> run(const verb::RevokeToken& verb, Context& context) {
  const auto revoked = context.call(api::token::Revoke{verb.name});
  if (!revoked) return tl::unexpected(revoked.error());
  if (context.output.json) {
    print_json({{"name", verb.name}, {"revoked", true}}, context.output);
  } else {
    context.output.out << verb.name << " lets no client in any more\n";
  }
  return ExitCode::done;
}

namespace {

constexpr std::string_view alone = "with --direct there is no other client";

constexpr const char* token_help = R"(
A token lets a client in from the network, by [http] of tmcld's configuration, with the role that it was
made for: observe, operate or configure, each with what is before it. It is printed once; tmcld keeps a
hash of it. 'token revoke' ends the connections and the leases of its clients. All of this needs the
role configure.

  tmclctl token add --role operate --name lab
  tmclctl --url https://gateway.example:4143 --token-file lab.token axes
  tmclctl token list
  tmclctl token revoke lab
)";

}  // namespace

void add_tokens(Grammar& grammar) {
  const auto group = grammar.group("token", "What lets clients in from the network", token_help);
  auto add = grammar.verb<verb::AddToken>(group, "add", access::tmcld_only(VerbEffect::acts, alone),
                                          "Make one and print it, this once", token_help, run);
  add.required_option("--role", "ROLE", "What it lets do: observe, operate or configure",
                      text(add->role));
  add.option("--name", "NAME", "What it is called; token-1 or the next without", text(add->name));
  grammar.verb<verb::Tokens>(group, "list", access::tmcld_only(VerbEffect::reads, alone),
                             "Which there are", token_help, run);
  auto revoke = grammar.verb<verb::RevokeToken>(
      group, "revoke", access::tmcld_only(VerbEffect::acts, alone),
      "Let no client in by it any more, and end those that are", token_help, run);
  revoke.word("NAME", "As list has it", text(revoke->name));
}

}  // namespace tmclctl
