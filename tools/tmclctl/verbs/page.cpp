// page: where a browser finds the page of tmcld.
#include "tmcl/api/page.hpp"

#include "output/print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

Result<ExitCode> run(const verb::Page&, Context& context) {
  const auto found = context.call(tmcl::api::page::Find{});
  if (!found) return tl::unexpected(found.error());
  const auto& addresses = found->addresses;
  const auto code = addresses.empty() ? ExitCode::refused : ExitCode::done;
  if (context.output.json) {
    print_json(tmcl::api::to_json(*found), context.output);
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

  tmclctl page
  xdg-open $(tmclctl page | head -n 1)
)";

}  // namespace

void add_page(Grammar& grammar) {
  grammar.verb<verb::Page>("page",
                           access::tmcld_only(VerbEffect::reads, "with --direct there is no page"),
                           "Where a browser sees and moves the axes", page_help, run);
}

}  // namespace tmclctl
