// An exchange in steady state takes no memory. Sanitizers see to memory by operators of their own.
#if !defined(__SANITIZE_ADDRESS__)

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include <unistd.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "engine/bus_engine.hpp"
#include "support/pty.hpp"
#include "support/responder.hpp"
#include "tmcl/blocking.hpp"
#include "tmcl/bus.hpp"
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

/// A module at the other end of a link.
class Answering {
 public:
  Answering(boost::asio::io_context& context, Link far)
      : far_(std::move(far)), readiness_(context, ::dup(far_.descriptor())) {
    wait();
  }

 private:
  void wait() {
    readiness_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                          [this](const auto& error) {
                            SerialBytes bytes{};
                            const auto count = far_.read(bytes);
                            if (error || !count || *count != bytes.size()) return;
                            const auto request = decode_serial_request(bytes);
                            (void)far_.write(encode_serial(test::reply_to(*request, 7)));
                            wait();
                          });
  }

  Link far_;
  boost::asio::posix::stream_descriptor readiness_;
};

boost::asio::awaitable<void> exchange_with(Bus& bus, int times, int& done) {
  for (int i = 0; i < times; ++i) {
    const auto answer = co_await bus.execute(test::gap(1));
    done += answer ? 1 : 0;
  }
}

TEST(BusAllocations, NoneInSteadyState) {
  boost::asio::io_context context{1};
  auto ends = Link::memory_pair(Framing::serial);
  Bus bus(context.get_executor(), std::move(ends->first));
  const Answering module(context, std::move(ends->second));
  int done = 0;
  const auto exchange = [&](int times) -> boost::asio::awaitable<void> {
    co_await exchange_with(bus, 10, done);
    counts = true;
    co_await exchange_with(bus, times, done);
    counts = false;
    bus.close();
  };
  boost::asio::co_spawn(context, exchange(1000), boost::asio::detached);
  context.run();
  EXPECT_EQ(done, 1010);
  EXPECT_EQ(allocations, 0U);
  allocations = 0;
}

TEST(BlockingBusAllocations, NoneInSteadyState) {
  const test::Pty pty;
  const test::Responder module(pty.master());
  BusOptions patient;
  patient.reply_timeout = std::chrono::seconds(10);
  auto bus = blocking::Bus::open("serial:" + pty.path() + "@115200", {}, patient);
  ASSERT_TRUE(bus);
  int done = 0;
  for (int i = 0; i < 1000; ++i) {
    counts = i >= 100;
    const auto answer = bus->execute(test::gap(1));
    done += answer ? 1 : 0;
  }
  counts = false;
  EXPECT_EQ(done, 1000);
  EXPECT_EQ(allocations, 0U);
  allocations = 0;
}

}  // namespace
}  // namespace tmcl

#endif
