#include "gateway/authority/gaps.hpp"

#include <fmt/format.h>

namespace tmcld {
namespace {

double seconds(const Gaps& gaps) { return std::chrono::duration<double>(gaps.duration()).count(); }

}  // namespace

std::string stale_text(const Gaps& gaps) {
  return fmt::format("it was requested before tmcld stood still for {:.1f} s", seconds(gaps));
}

std::string gap_text(const Gaps& gaps) {
  return fmt::format("tmcld stood still for {:.1f} s: movements requested before that are refused",
                     seconds(gaps));
}

}  // namespace tmcld
