/// The page that tmcld shows a browser.
#pragma once

#include <string>
#include <vector>

#include "tmcl/api/field.hpp"

namespace tmcl::api::page {

struct Addresses {
  TMCL_STRUCT(Addresses);
  TMCL_FIELD(std::vector<std::string>, addresses,
             "what a browser takes, such as https://gateway:4143; empty where nothing is served by "
             "HTTP");
};
struct Find {
  TMCL_METHOD("page.find", reads, Addresses, "where the page for browsers is", Find);
};

}  // namespace tmcl::api::page
