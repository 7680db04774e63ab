/// What is wrong with a configuration file, and where.
#pragma once

#include <cstdint>
#include <string>

namespace tmcld {

/// A place in a text; line and column count from one, files from zero.
struct Place {
  std::uint32_t line = 1;
  std::uint32_t column = 1;
  std::uint32_t file = 0;
};

struct ConfigProblem {
  Place place;
  std::string message;
};

/// "tmcld.toml:12:1: unknown key 'adress' in [[axis]]. Did you mean 'address'?"
inline std::string describe(const std::string& file, const ConfigProblem& problem) {
  return file + ":" + std::to_string(problem.place.line) + ":" +
         std::to_string(problem.place.column) + ": " + problem.message;
}

}  // namespace tmcld
