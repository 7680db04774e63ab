// The engine is a value: a copy that is told the same as the original wants the same done.

#include <gtest/gtest.h>

#include <random>

#include <fmt/format.h>

#include "engine/bus_engine.hpp"
#include "support/seed.hpp"

namespace tmcl {
namespace {

using engine::BusEngine;

static_assert(std::is_copy_constructible_v<BusEngine> && std::is_copy_assignable_v<BusEngine>);

std::string text_of(const engine::Action& action) {
  if (const auto* send = std::get_if<engine::Send>(&action))
    return fmt::format("send {} as {}", describe(send->request), send->place);
  if (const auto* event = std::get_if<BusEvent>(&action))
    return fmt::format("event {} of {}: {}", static_cast<int>(event->kind), number(event->module),
                       event->value);
  const auto& done = std::get<engine::Completion>(action);
  if (!done.result)
    return fmt::format("{} fails: {} {}", done.ticket, name_of(done.result.error().outcome),
                       describe(done.result.error()));
  const auto& reply = done.result->reply;
  return fmt::format("{} gets {} from {}, status {}{}", done.ticket, reply.value, reply.module,
                     static_cast<int>(reply.status),
                     done.result->duplicate_suspected ? ", doubtful" : "");
}

/// Two engines that are told the same.
class Twins {
 public:
  Twins(Framing framing, std::uint64_t seed)
      : framing_(framing), random_(seed), original_(framing, Duration{}, {}), copy_(original_) {}

  void part() { copy_ = BusEngine(original_); }
  std::size_t actions() const { return actions_; }

  void step() {
    switch (below(8)) {
      case 0:
      case 1:
      case 2: submit(); break;
      case 3:
      case 4: answer(); break;
      case 5: come({0, some_module(), Status::ok, some_command(), 7}); break;
      case 6: take_another_hold(); break;
      default: pass(); break;
    }
    do_actions();
    EXPECT_EQ(original_.next_deadline(), copy_.next_deadline());
  }

 private:
  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  std::uint8_t some_module() { return static_cast<std::uint8_t>(1 + below(3)); }
  Command some_command() {
    constexpr std::array commands{Command::GAP,
                                  Command::GAP,
                                  Command::MVP,
                                  Command::MST,
                                  Command::SAP,
                                  Command::START_DOWNLOAD,
                                  Command::END_DOWNLOAD,
                                  Command::READ_TMCL_MEMORY,
                                  Command::GET_FIRMWARE_VERSION,
                                  Command::GGP};
    return commands.at(below(commands.size()));
  }
  template <class Act>
  void both(const Act& act) {
    act(original_);
    act(copy_);
  }

  void submit() {
    const auto type = static_cast<std::uint8_t>(below(3));
    const auto motor = static_cast<std::uint8_t>(below(2));
    const Request request{ModuleAddress{some_module()}, some_command(), type, motor, 5};
    CallOptions options;
    if (hold_ && below(2) == 0) {
      options.hold = hold_;
      options.is_program_line = request.command == Command::MVP;
      options.in_bootloader = below(8) == 0;
    }
    if (below(6) == 0) options.deadline = now_ + std::chrono::milliseconds(below(100));
    const auto ticket = tickets_++;
    both([&](BusEngine& engine) { engine.submit(ticket, request, options, now_); });
  }
  void take_another_hold() {
    holds_.push_back(below(2) == 0 ? nullptr : std::make_shared<const Hold>());
    hold_ = holds_.back();
  }
  void answer() {
    if (sent_.empty()) return;
    const auto request = sent_[below(static_cast<unsigned>(sent_.size()))];
    const auto status = below(4) == 0 ? Status::command_loaded : Status::ok;
    come({default_host_address, reply_byte(request.address), status, request.command,
          request.value});
  }
  void come(Reply reply) {
    reply.host = default_host_address;
    both([&](BusEngine& engine) {
      if (framing_ == Framing::serial) {
        engine.on_bytes(encode_serial(reply), now_);
      } else {
        engine.on_frame(encode_can(reply, default_can_reply_id), now_);
      }
    });
  }
  void pass() {
    now_ += std::chrono::milliseconds(below(10) == 0 ? 6000 : below(60));
    both([&](BusEngine& engine) { engine.on_deadline(now_); });
  }
  void do_actions() {
    while (true) {
      const auto action = original_.next_action();
      const auto same = copy_.next_action();
      ASSERT_EQ(action.has_value(), same.has_value());
      if (!action) return;
      ++actions_;
      ASSERT_EQ(text_of(*action), text_of(*same));
      const auto* send = std::get_if<engine::Send>(&*action);
      if (send == nullptr) continue;
      if (below(10) == 0) {
        both([&](BusEngine& engine) { engine.on_send_refused(send->request, now_); });
      } else {
        sent_.push_back(send->request);
        if (sent_.size() > 4) sent_.erase(sent_.begin());
      }
    }
  }

  Framing framing_;
  std::mt19937_64 random_;
  TimePoint now_{std::chrono::hours(1)};
  BusEngine original_;
  BusEngine copy_;
  std::shared_ptr<const Hold> hold_;
  std::vector<std::shared_ptr<const Hold>> holds_;  ///< How long they live is the caller's affair.
  std::vector<Request> sent_;
  engine::Ticket tickets_ = 0;
  std::size_t actions_ = 0;
};

class CopiedEngine : public testing::TestWithParam<Framing> {};

TEST_P(CopiedEngine, WantsTheSameDone) {
  const auto seed = test::seed();
  std::size_t actions = 0;
  for (std::uint64_t round = 0; round < 200; ++round) {
    SCOPED_TRACE(fmt::format("TMCL_SEED={}, round {}", seed, round));
    Twins twins(GetParam(), seed + round);
    for (int i = 0; i < 200; ++i) {
      if (i % 20 == 0) twins.part();
      twins.step();
      if (testing::Test::HasFailure()) return;
    }
    actions += twins.actions();
  }
  EXPECT_GT(actions, 200U * 50U);
}

INSTANTIATE_TEST_SUITE_P(Links, CopiedEngine, testing::Values(Framing::serial, Framing::can),
                         [](const auto& parameter) {
                           return parameter.param == Framing::serial ? "serial" : "can";
                         });

}  // namespace
}  // namespace tmcl
