/// The part of tmcld's configuration that clients may set.
#pragma once

#include <optional>
#include <string>

#include "tmcl/api/field.hpp"

namespace tmcl::api::configuration {

struct Managed {
  TMCL_STRUCT(Managed);
  TMCL_FIELD(std::optional<std::string>, file,
             "its path, which 'managed' in [daemon] names; null: nothing is set by clients");
  TMCL_FIELD(std::optional<std::string>, toml, "what stands in it; null: it is not there yet");
};
struct Get {
  TMCL_METHOD("configuration.get", reads, Managed,
              "the part of the configuration that clients may set", Get);
};

struct Taken {
  TMCL_STRUCT(Taken);
  TMCL_FIELD(bool, changed, "it is another text than the one before");
  TMCL_FIELD(std::string, buses, "in words: what has become of the buses, or would");
};
struct Set {
  TMCL_METHOD("configuration.set", writes, Taken,
              "sets the part of the configuration that is for clients, and goes by it", Set);
  TMCL_FIELD(std::string, toml, "all of it: [[bus]], [[module]], [[axis]] and [path]");
  TMCL_FIELD(std::optional<bool>, dry_run,
             "true: it is only said what would become of it; nothing changes");
};

}  // namespace tmcl::api::configuration
