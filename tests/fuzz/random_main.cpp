// Runs a fuzz target without a fuzzer: on the files it is given, or on random bytes.
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "support/seed.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

void run_file(const char* name) {
  std::ifstream file(name, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::uint64_t current_seed = 0;

void tell_seed(int) {
  std::fprintf(stderr, "replay it alone with TMCL_SEED=%ju and 1 script\n", current_seed);
}

void run_random(std::uint64_t scripts) {
  std::signal(SIGABRT, tell_seed);
  for (auto seed = tmcl::test::seed(); scripts != 0; --scripts, ++seed) {
    current_seed = seed;
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> bytes(random() % 400);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
}

}  // namespace

// fuzz_x FILE...   or   fuzz_x SCRIPTS (a number)
int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "10000";
  if (first.find_first_not_of("0123456789") == std::string::npos) {
    run_random(std::stoull(first));
    return 0;
  }
  for (int i = 1; i < argc; ++i) run_file(argv[i]);
}
