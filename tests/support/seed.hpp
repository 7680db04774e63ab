/// Where random tests get their seed: from TMCL_SEED to replay a run, otherwise a new one; printed
/// either way.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>

namespace tmcl::test {

inline std::uint64_t seed() {
  static const std::uint64_t value = [] {
    const char* given = std::getenv("TMCL_SEED");
    const std::uint64_t chosen = given != nullptr ? std::stoull(given) : std::random_device{}();
    std::cout << "replay with TMCL_SEED=" << chosen << std::endl;
    return chosen;
  }();
  return value;
}

}  // namespace tmcl::test
