// What a module listens to on CAN must not be the identifier of its replies.

#include <gmock/gmock.h>

#include <algorithm>

#include "support/scripted_bus.hpp"

namespace tmcl {
namespace {

namespace gp = global_parameter;

using test::ScriptedBus;
using testing::HasSubstr;

class CanIdentifiers : public testing::TestWithParam<Framing> {
 protected:
  CanIdentifiers() {
    module.global(gp::can_id) = 1;
    module.global(gp::can_reply_id) = 2;
    module.global(gp::can_secondary_address) = 0;
  }
  Result<void> set(std::uint8_t parameter, std::int32_t value, std::uint8_t bank = 0) {
    return bus.run(verbs::set_global(ModuleAddress{1}, bank, parameter, value));
  }
  bool was_set() const {
    return std::ranges::count(module.executed(), Command::SGP, &Request::command) != 0;
  }

  ScriptedBus bus{GetParam()};
  test::FakeModule& module = bus.add_module(1);
};

TEST_P(CanIdentifiers, OneForBothIsRefused) {
  module.global(gp::can_secondary_address) = 7;
  for (const auto& [parameter, value] : {std::pair{gp::can_id, 2},
                                         {gp::can_secondary_address, 2},
                                         {gp::can_reply_id, 1},
                                         {gp::can_reply_id, 7}}) {
    const auto done = set(parameter, value);
    ASSERT_FALSE(done) << int{parameter};
    EXPECT_EQ(done.error().code, Errc::bad_argument);
    EXPECT_EQ(done.error().outcome, Outcome::not_sent);
    EXPECT_THAT(done.error().message, HasSubstr("takes what comes with its own identifier"));
  }
  EXPECT_FALSE(was_set());
}

TEST_P(CanIdentifiers, OthersAreSet) {
  for (const auto& [parameter, value] : {std::pair{gp::can_id, 3},
                                         {gp::can_secondary_address, 0},
                                         {gp::can_reply_id, 0},
                                         {gp::can_reply_id, 3}}) {
    EXPECT_TRUE(set(parameter, value)) << int{parameter};
  }
  EXPECT_TRUE(set(gp::can_id, 2, 2)) << "a user variable is no identifier";
}

TEST_P(CanIdentifiers, AModuleWithoutCanIsLeftAlone) {
  module.refuse = [](const Request& request) {
    return request.command == Command::GGP ? std::optional(Status::wrong_type) : std::nullopt;
  };
  EXPECT_TRUE(set(gp::can_id, 2));
}

TEST_P(CanIdentifiers, NothingIsSetWhileTheModuleDoesNotTell) {
  bus.chance = [](std::size_t) { return test::Fault::lost_reply; };
  const auto done = set(gp::can_id, 2);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().outcome, Outcome::not_sent);
}

INSTANTIATE_TEST_SUITE_P(Both, CanIdentifiers, testing::Values(Framing::serial, Framing::can),
                         [](const auto& wire) {
                           return wire.param == Framing::can ? "can" : "serial";
                         });

}  // namespace
}  // namespace tmcl
