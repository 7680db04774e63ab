// page: where a browser finds the page of tmcld, and what lets a phone in.
#include "tmcl/api/page.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "output/print.hpp"
#include "output/qr_code.hpp"
#include "tmcl/api/token.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
using Addresses = std::vector<std::string>;

/// A phone is another computer.
bool is_for_others(const std::string& address) {
  return address.find("//localhost:") == std::string::npos;
}

Result<std::string> address_for_phones(const Addresses& addresses) {
  const auto found = std::ranges::find_if(addresses, is_for_others);
  if (found != addresses.end()) return *found;
  return tl::unexpected(usage_error(
      "no_address", "this tmcld shows its page to this computer alone, and to no phone",
      "a section [http] with an address of the network in 'listen', and with 'certificate' and "
      "'key', makes it, after a restart"));
}

/// Made where there is none, so that a phone needs one command.
Result<void> ensure_token(const std::string& name, Context& context) {
  const auto all = context.call(api::token::List{});
  if (!all) return tl::unexpected(all.error());
  if (std::ranges::find(all->tokens, name, &api::token::Token::name) != all->tokens.end())
    return {};
  api::token::Add wish{"operate"};
  wish.name = name;
  return context.call(wish).map([](const api::token::Added&) {});
}

Result<ExitCode> invite(const verb::Page& verb, const Addresses& addresses, Context& context) {
  const auto address = address_for_phones(addresses);
  if (!address) return tl::unexpected(address.error());
  if (auto made = ensure_token(verb.token, context); !made) return tl::unexpected(made.error());
  const auto invited = context.call(api::token::Invite{verb.token});
  if (!invited) return tl::unexpected(invited.error());
  const auto link = *address + "/#code=" + invited->code;
  auto& output = context.output;
  if (output.json) {
    auto document = api::to_json(*invited);
    document["link"] = link;
    print_json(document, output);
    return ExitCode::done;
  }
  output.out << qr_code(link, output.out_screen) << link << '\n'
             << fmt::format(
                    "signs one browser in, once, within {:.0f} minutes, by the token '{}' with the "
                    "role {}; 'tmclctl token revoke {}' ends that\n",
                    invited->ends_in_s / 60, invited->name, invited->role, invited->name);
  return ExitCode::done;
}

Result<ExitCode> run(const verb::Page& verb, Context& context) {
  const auto found = context.call(api::page::Find{});
  if (!found) return tl::unexpected(found.error());
  const auto& addresses = found->addresses;
  if (verb.phone && !addresses.empty()) return invite(verb, addresses, context);
  const auto code = addresses.empty() ? ExitCode::refused : ExitCode::done;
  if (context.output.json) {
    print_json(api::to_json(*found), context.output);
    return code;
  }
  for (const auto& address : addresses) context.output.out << address << '\n';
  if (addresses.empty()) {
    context.output.err << "tmclctl: this tmcld serves nothing by HTTP; a section [http] with "
                          "'listen' in its configuration makes it, after a restart\n";
  }
  return code;
}

constexpr const char* page_help = R"(
Prints the addresses of the page on which a browser shows, moves and stops the axes, one a line. It asks
for a token, once: 'tmclctl token add --role operate' makes one.

With --phone it prints a picture that the camera of a phone reads, and the link that is in it: it signs
one browser in, once, within ten minutes, by the token that --token names. Where there is no such
token, it is made, with the role operate. This needs the role configure.

  tmclctl page
  xdg-open $(tmclctl page | head -n 1)
  tmclctl page --phone
)";

}  // namespace

void add_page(Grammar& grammar) {
  auto page = grammar.verb<verb::Page>(
      "page", access::tmcld_only(VerbEffect::acts, "with --direct there is no page"),
      "Where a browser sees and moves the axes", page_help, run);
  page.flag("--phone", "Print what signs a phone in", page->phone);
  page.option("--token", "NAME", "With --phone: by this token (default phone)", text(page->token));
  page.object([](const verb::Page& said, bool) {
    return std::string(said.phone || said.token == verb::Page{}.token ? ""
                                                                      : "--token needs --phone");
  });
}

}  // namespace tmclctl
