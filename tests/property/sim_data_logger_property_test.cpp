// The data logger of the simulated modules against a plain list of everything it ever wrote.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/module/data_logger.hpp"
#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"

namespace tmcl::sim {
namespace {

using ram_debug::Kind;
using ram_debug::State;
using ram_debug::Trigger;
using ram_debug::Type;
using Words = std::vector<std::uint32_t>;

constexpr std::uint32_t elements = DataLogger::elements;
constexpr std::uint32_t trigger_select = 100;
// Enough to fill the ring twice with one channel, at every second tick.
constexpr std::size_t longest = 36'000;

struct Setup {
  std::uint32_t samples = elements;
  std::uint32_t pretrigger = 0;
  std::uint32_t prescaler = 0;
  std::uint32_t channels = 1;
  Trigger trigger = Trigger::unconditional;
  std::uint32_t threshold = 0;
  std::uint32_t mask = UINT32_MAX;
  std::uint8_t shift = 0;

  std::string text() const {
    return std::to_string(samples) + " samples, " + std::to_string(pretrigger) + " before, 1/" +
           std::to_string(prescaler + 1) + " of " + std::to_string(channels) +
           " channels, trigger " + std::to_string(static_cast<int>(trigger)) + " at " +
           std::to_string(threshold) + ", mask " + std::to_string(mask) + " >> " +
           std::to_string(shift);
  }
};

/// What a channel of this number reads at a tick.
std::uint32_t value_at(const Words& signal, std::size_t tick, std::uint32_t channel) {
  return channel == trigger_select ? signal[tick] : signal[tick] ^ (channel << 8);
}

// ---- The reference: nothing wraps, and every value has its place in one long list.

class Reference {
 public:
  Reference(const Setup& setup, const Words& signal)
      : setup_(setup), signal_(signal), above_(is_above(0)) {}

  void tick() {
    ++tick_;
    if (complete_) return;
    looks_ = looks_ || written_.size() >= setup_.pretrigger;
    if (looks_ && !begin_) look();
    if (tick_ % (setup_.prescaler + 1) == 0) write();
  }
  State state() const {
    if (complete_) return State::complete;
    if (begin_) return State::capture;
    return looks_ ? State::trigger : State::pretrigger;
  }
  Words record() const {
    const auto from = written_.begin() + static_cast<std::ptrdiff_t>(begin_.value());
    const auto there = static_cast<std::ptrdiff_t>(written_.size() - *begin_);
    return {from, from + std::min<std::ptrdiff_t>(there, setup_.samples)};
  }

 private:
  bool is_above(std::size_t tick) const {
    const auto field = setup_.mask >> setup_.shift;
    std::int64_t value = (signal_[tick] & setup_.mask) >> setup_.shift;
    if (setup_.trigger >= Trigger::rising_unsigned) return value > setup_.threshold;
    if (value > field / 2) value -= std::int64_t{field} + 1;
    return value > static_cast<std::int32_t>(setup_.threshold);
  }
  void look() {
    const bool before = above_;
    above_ = is_above(tick_);
    const bool rises = !before && above_;
    const bool falls = before && !above_;
    bool met = true;
    switch (setup_.trigger) {
      case Trigger::unconditional: break;
      case Trigger::rising_signed:
      case Trigger::rising_unsigned: met = rises; break;
      case Trigger::falling_signed:
      case Trigger::falling_unsigned: met = falls; break;
      default: met = rises || falls;
    }
    // All of the ring in front of the trigger is none of it: the ring is as full as it is empty.
    if (met) begin_ = written_.size() - setup_.pretrigger % elements;
  }
  void write() {
    for (std::uint32_t channel = 0; channel < setup_.channels; ++channel) {
      written_.push_back(value_at(signal_, tick_, channel));
      looks_ = looks_ || written_.size() == elements;
      if (!begin_) continue;
      const auto recorded = written_.size() - *begin_;
      complete_ = recorded >= setup_.samples || recorded == elements;
      if (complete_) return;
    }
  }

  Setup setup_;
  const Words& signal_;
  bool above_;
  bool looks_ = false;
  bool complete_ = false;
  std::optional<std::size_t> begin_;
  std::size_t tick_ = 0;
  Words written_;
};

// ---- The logger, asked as a host would ask it

class Logger {
 public:
  explicit Logger(const Words& signal) : signal_(&signal) {}

  Answer ask(Type type, std::uint8_t motor = 0, std::uint32_t value = 0) {
    const Request request{ModuleAddress{1}, Command::RAM_DEBUG, static_cast<std::uint8_t>(type),
                          motor, static_cast<std::int32_t>(value)};
    return logger_.execute(request, now_, [this](const auto& channel) { return read(channel); });
  }
  void set_up(const Setup& setup) {
    ask(Type::init);
    ask(Type::set_sample_count, 0, setup.samples);
    ask(Type::set_prescaler, 0, setup.prescaler);
    for (std::uint32_t i = 0; i < setup.channels; ++i) ask(Type::set_channel, 1, i);
    ask(Type::set_pretrigger_sample_count, 0, setup.pretrigger);
    ask(Type::set_shift_mask, setup.shift, setup.mask);
    ask(Type::set_trigger_channel, 1, trigger_select);
    ask(Type::enable_trigger, static_cast<std::uint8_t>(setup.trigger), setup.threshold);
  }
  // Lets it run up to its next tick, and past times at which nothing is due.
  void tick() {
    logger_.run_due(now_ + std::chrono::microseconds(999), probe());
    ++tick_;
    now_ += std::chrono::milliseconds(1);
    logger_.run_due(now_, probe());
  }
  State state() { return static_cast<State>(ask(Type::get_state).value); }
  bool is_due() const { return logger_.next_due() != never; }
  Words record() {
    Words samples;
    for (std::uint32_t i = 0;; ++i) {
      const auto answer = ask(Type::get_sample, 0, i);
      if (answer.status != Status::ok) return samples;
      samples.push_back(static_cast<std::uint32_t>(answer.value));
    }
  }

 private:
  DataLogger::Probe probe() {
    return [this](const DataLogger::Channel& channel) { return read(channel); };
  }
  std::uint32_t read(const DataLogger::Channel& channel) const {
    EXPECT_EQ(channel.kind, Kind::axis_parameter);
    return value_at(*signal_, tick_, channel.select);
  }

  const Words* signal_;
  TimePoint now_{};
  std::size_t tick_ = 0;
  DataLogger logger_{TimePoint{}};
};

using Random = test::Random<>;

// Goes up and down, so that a trigger comes sooner or later, or never.
Words random_signal(Random& random) {
  Words signal{static_cast<std::uint32_t>(random.either_way(random.any_size(5000)))};
  const auto step = random.positive(100);
  while (signal.size() <= longest) {
    const auto change = static_cast<std::uint32_t>(random.between(-step, step));
    signal.push_back(signal.back() + (random.one_in(3) ? change : 0));
  }
  return signal;
}

std::uint32_t random_count(Random& random) {
  if (random.one_in(6)) return elements;
  return static_cast<std::uint32_t>(random.any_size(elements));
}

Setup random_setup(Random& random) {
  Setup setup;
  setup.samples = random_count(random);
  setup.pretrigger = std::min(random.one_in(3) ? 0 : random_count(random), setup.samples);
  setup.prescaler = static_cast<std::uint32_t>(random.one_in(2) ? 0 : random.any_size(20));
  setup.channels = static_cast<std::uint32_t>(random.between(0, 4));
  setup.trigger = Trigger{static_cast<std::uint8_t>(random.between(0, 6))};
  setup.threshold = static_cast<std::uint32_t>(random.either_way(random.any_size(5000)));
  if (random.one_in(3)) {
    setup.shift = static_cast<std::uint8_t>(random.between(0, 12));
    setup.mask = ((1U << random.between(1, 16)) - 1) << setup.shift;
    setup.threshold &= 0xFF;
  }
  return setup;
}

void expect_same(const Setup& setup, const Words& signal, Random& random) {
  Reference reference(setup, signal);
  Logger logger(signal);
  logger.set_up(setup);
  ASSERT_TRUE(logger.is_due());
  for (std::size_t tick = 1; tick <= longest; ++tick) {
    reference.tick();
    logger.tick();
    ASSERT_EQ(logger.state(), reference.state()) << "tick " << tick;
    if (reference.state() == State::capture && random.one_in(3000)) {
      ASSERT_EQ(logger.record(), reference.record()) << "what is there already, tick " << tick;
    }
    if (reference.state() == State::complete) break;
  }
  if (reference.state() != State::complete) return;
  EXPECT_FALSE(logger.is_due());
  EXPECT_EQ(logger.record(), reference.record());
}

TEST(SimDataLogger, RecordsWhatAPlainListHas) {
  Random random(test::seed());
  for (int round = 0; round < test::rounds(300); ++round) {
    const auto setup = random_setup(random);
    SCOPED_TRACE(setup.text());
    expect_same(setup, random_signal(random), random);
    if (testing::Test::HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace tmcl::sim
