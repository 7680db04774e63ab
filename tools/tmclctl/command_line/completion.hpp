/// What may stand at the cursor of a shell. The grammar is the table: which words and options there
/// are, and what kind each of them is by its placeholder, such as AXIS, MODULE or FILE.
#pragma once

#include <string>
#include <vector>

#include "connection/gateway.hpp"

namespace CLI {
class App;
}

namespace tmclctl {

struct Completion {
  /// Words; or "axes", "modules", "buses": what the gateway has. Each may get `suffix`.
  std::vector<std::string> words{};
  std::string of_gateway{};
  std::string prefix{};  ///< Before each of them, such as "X=".
  std::string suffix{};  ///< Behind each, such as "=".
};

/// `typed`: the words up to the cursor, the last of them in part, perhaps empty; what they say of
/// how to reach the axes is put into `where`. The word ":files" stands for the names of files.
Completion complete_line(const CLI::App& program, const std::vector<std::string>& typed,
                         Where& where);

/// The words of one kind, such as "models" or "parameters"; empty for one that is not known.
std::vector<std::string> words_of_kind(const std::string& kind,
                                       const std::vector<std::string>& of = {});

}  // namespace tmclctl
