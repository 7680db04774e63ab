// An exchange in steady state takes no memory. Sanitizers see to memory by operators of their own.
#if !defined(__SANITIZE_ADDRESS__)

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "engine/bus_engine.hpp"
#include "unit/engine_requests.hpp"

namespace {

bool counts = false;
std::size_t allocations = 0;

}  // namespace

void* operator new(std::size_t size) {
  if (counts) ++allocations;
  if (void* room = std::malloc(size)) return room;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (counts) ++allocations;
  return std::malloc(size);
}
void operator delete(void* room) noexcept { std::free(room); }
void operator delete(void* room, std::size_t) noexcept { std::free(room); }

namespace tmcl {
namespace {

class EngineAllocations : public testing::TestWithParam<Framing> {};

/// Submits requests to several modules and answers whatever goes out; how many calls were done.
int exchange(engine::BusEngine& engine, Framing framing, TimePoint now) {
  for (std::uint8_t module = 1; module <= 4; ++module)
    engine.submit(module, test::gap(module), {}, now);
  engine.submit(5, test::mvp(2, 100), {}, now);
  int done = 0;
  while (const auto action = engine.next_action()) {
    if (const auto* completion = std::get_if<engine::Completion>(&*action))
      done += completion->result ? 1 : 0;
    const auto* send = std::get_if<engine::Send>(&*action);
    if (send == nullptr) continue;
    const auto reply = test::reply_to(send->request, send->request.value);
    if (framing == Framing::serial) {
      engine.on_bytes(encode_serial(reply), now);
    } else {
      engine.on_frame(encode_can(reply, default_can_reply_id), now);
    }
  }
  return done;
}

TEST_P(EngineAllocations, NoneInSteadyState) {
  engine::BusEngine engine(GetParam(), Duration{}, {});
  TimePoint now{std::chrono::hours(1)};
  int done = 0;
  for (int i = 0; i < 1000; ++i) {
    counts = i >= 100;  // fences have gone out by then, too
    now += std::chrono::milliseconds(1);
    done += exchange(engine, GetParam(), now);
    engine.on_deadline(now);
  }
  counts = false;
  EXPECT_EQ(done, 5000);
  EXPECT_EQ(allocations, 0U);
  allocations = 0;
}

INSTANTIATE_TEST_SUITE_P(Links, EngineAllocations, testing::Values(Framing::serial, Framing::can),
                         [](const auto& parameter) {
                           return parameter.param == Framing::serial ? "serial" : "can";
                         });

}  // namespace
}  // namespace tmcl

#endif
