// How many requests of one client are in progress, and which of them wait.
#include <gmock/gmock.h>

#include <string>

#include "fronts/request_lanes.hpp"

namespace tmcld::test {
namespace {

const MethodInfo& known_method(const char* name) { return *find_method(name); }

RpcRequest numbered_request(const char* name, int id) {
  RpcRequest made;
  made.id = id;
  made.method = &known_method(name);
  return made;
}

class RequestLanesOfAClient : public testing::Test {
 protected:
  void fill(const char* name) {
    for (std::size_t i = 0; i < max_requests_in_flight; ++i)
      ASSERT_TRUE(lanes.begin(known_method(name)));
  }
  RequestLanes lanes;
};

TEST_F(RequestLanesOfAClient, CallsStopsAndRenewalsDoNotKeepEachOtherOut) {
  std::size_t all = 0;
  for (const char* name : {"axis.move_to", "axis.stop", "lease.renew"}) {
    SCOPED_TRACE(name);
    fill(name);
    EXPECT_FALSE(lanes.begin(known_method(name)));
    EXPECT_EQ(lanes.count(), all += max_requests_in_flight);
  }
  EXPECT_FALSE(lanes.begin(known_method("axis.get_state"))) << "it is of the lane of moves";
  EXPECT_FALSE(lanes.begin(known_method("lease.release"))) << "it is of the lane of renewals";
}

TEST_F(RequestLanesOfAClient, WhatHasEndedGivesItsPlaceBack) {
  fill("axis.move_to");
  lanes.end(known_method("axis.move_to"));
  EXPECT_TRUE(lanes.begin(known_method("axis.get_state")));
  for (std::size_t i = 0; i < max_requests_in_flight; ++i) lanes.end(known_method("axis.move_to"));
  EXPECT_TRUE(lanes.are_empty());
}

TEST_F(RequestLanesOfAClient, OnlyReadsWaitForAnswersToBeWritten) {
  constexpr auto much = reads_wait_at_unsent_bytes + 1;
  EXPECT_TRUE(lanes.must_wait(known_method("axis.get_state"), much));
  EXPECT_FALSE(lanes.must_wait(known_method("axis.get_state"), reads_wait_at_unsent_bytes));
  for (const char* name : {"axis.move_to", "axis.stop", "lease.renew"})
    EXPECT_FALSE(lanes.must_wait(known_method(name), much)) << name;
}

TEST_F(RequestLanesOfAClient, ReadsKeepTheirOrder) {
  for (const int id : {1, 2}) lanes.wait(numbered_request("axis.get_state", id));
  EXPECT_TRUE(lanes.must_wait(known_method("axis.get_state"), 0)) << "others wait already";
  EXPECT_FALSE(lanes.next(reads_wait_at_unsent_bytes + 1));
  for (const int id : {1, 2}) {
    const auto next = lanes.next(0);
    ASSERT_TRUE(next);
    EXPECT_EQ(next->id, id);
  }
  EXPECT_FALSE(lanes.next(0));
  EXPECT_FALSE(lanes.has_waiting());
}

TEST_F(RequestLanesOfAClient, WhatWaitsCanBeForgotten) {
  lanes.wait(numbered_request("axis.get_state", 1));
  lanes.forget_waiting();
  EXPECT_FALSE(lanes.next(0));
}

}  // namespace
}  // namespace tmcld::test
