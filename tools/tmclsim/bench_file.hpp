/// The file of --bench: which modules there are, and what their motors drive.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "module_spec.hpp"
#include "sim/module/module_settings.hpp"
#include "sim/stage/stage.hpp"

namespace tmclsim {

/// One [[module]] with its [[module.axis]] tables.
struct BenchModule {
  std::string spec;                            ///< As for --module: "TMCM-1110" or "TMCM-1110@3".
  std::vector<tmcl::sim::StageSettings> axes;  ///< One for each motor.
  tmcl::sim::ModuleSettings settings{};
  Surroundings surroundings{};
};

/// The error is a sentence that begins with file and line, and names what is wrong there.
tl::expected<std::vector<BenchModule>, std::string> read_bench_file(const std::string& path);
/// `name` is what errors call the text.
tl::expected<std::vector<BenchModule>, std::string> parse_bench_file(std::string_view text,
                                                                     std::string_view name);

}  // namespace tmclsim
