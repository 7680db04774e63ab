#include "port_choice.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tmclctl {

Result<std::string> only_module(const std::vector<tmcl::Port>& ports) {
  std::vector<std::string> modules, others;
  for (const auto& port : ports)
    (is_module(port) ? modules : others).push_back("--direct " + link_to(port));
  if (modules.size() == 1)
    return link_to(
        *std::ranges::find_if(ports, [](const tmcl::Port& port) { return is_module(port); }));
  if (!modules.empty()) {
    return tl::unexpected(usage_error(
        "several_modules", "--direct auto is for one module by USB, and there are several",
        fmt::format("say which: {}", fmt::join(modules, ", "))));
  }
  return tl::unexpected(usage_error(
      "no_module", "--direct auto: no module by Trinamic is on USB",
      others.empty()
          ? "is it plugged in, and has it power? 'tmclctl ports' lists what is there"
          : fmt::format("if it is behind another port, name that: {}", fmt::join(others, ", "))));
}

}  // namespace tmclctl
