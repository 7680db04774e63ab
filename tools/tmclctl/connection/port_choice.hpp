/// Which port is meant by --direct auto.
#pragma once

#include <string>
#include <vector>

#include "output/errors.hpp"
#include "tmcl/ports.hpp"

namespace tmclctl {

constexpr std::string_view any_port = "auto";

/// The link to the only module by USB. Errors: usage, naming what there is to choose from.
Result<std::string> only_module(const std::vector<tmcl::Port>& ports);

}  // namespace tmclctl
