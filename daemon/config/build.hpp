/// What the sections mean together: names that refer to each other, links, ranges that depend on
/// the kind of link.
#pragma once

#include "config/config.hpp"
#include "config/http_config.hpp"
#include "config/sections.hpp"

namespace tmcld {

/// Appends what is wrong to the problems of the text; what it returns can be relied on only if
/// there are none. Sections that lack a required key are left out without a further word.
Config build_config(ConfigText& text);
/// That files can be read is checked when they are opened.
HttpConfig build_http(const HttpSection& section, tmcl::TextProblems& problems);

}  // namespace tmcld
