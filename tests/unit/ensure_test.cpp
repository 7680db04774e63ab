#include "tmcl/ensure.hpp"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

namespace tmcl {
namespace {

/// As in the product, for as long as it lives.
struct AsInTheProduct {
  AsInTheProduct() { end_process_when_broken(false); }
  AsInTheProduct(const AsInTheProduct&) = delete;
  AsInTheProduct& operator=(const AsInTheProduct&) = delete;
  ~AsInTheProduct() { end_process_when_broken(); }
};

TEST(Ensure, SaysNothingOfWhatHolds) { ensure(true); }

TEST(Ensure, EndsACallAndNamesFileAndLine) {
  const AsInTheProduct as_in_the_product;
  const auto line = std::to_string(__LINE__ + 2);
  try {
    ensure(false);
    ADD_FAILURE() << "went on";
  } catch (const std::logic_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("ensure_test.cpp:" + line + ": "));
  }
}

TEST(Ensure, EndsATest) { EXPECT_DEATH(ensure(false), "ensure_test.cpp"); }

}  // namespace
}  // namespace tmcl
