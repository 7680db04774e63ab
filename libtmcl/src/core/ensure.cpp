#include "tmcl/ensure.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tmcl {
namespace {

std::atomic<bool> ends_process = false;

}  // namespace

void broken(std::source_location here) {
  const std::string_view path = here.file_name();
  const auto text = std::string(path.substr(path.rfind('/') + 1)) + ":" +
                    std::to_string(here.line()) + ": what " + here.function_name() +
                    " takes for granted does not hold";
  if (!ends_process) throw std::logic_error(text);
  std::fprintf(stderr, "%s\n", text.c_str());
  std::abort();
}

void end_process_when_broken(bool ends) { ends_process = ends; }

}  // namespace tmcl
