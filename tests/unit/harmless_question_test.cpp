// A question for a line whose baud rate is not known does nothing to a module of any other rate.
#include "tmcl/harmless_question.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tmcl/command.hpp"

namespace tmcl::test {
namespace {

/// What one hears who looks at a line at another rate than that of its sender. Times in seconds;
/// written without a look at the one under test.
class Ear {
 public:
  Ear(const SerialBytes& sent, double sender, double receiver)
      : sender_(sender), receiver_(receiver) {
    for (const unsigned byte : sent) {
      const unsigned frame = byte << 1U | 1U << 9U;
      for (unsigned bit = 0; bit < 10; ++bit) levels_.push_back((frame >> bit & 1U) != 0);
    }
  }

  std::vector<std::uint8_t> listen(bool keeps_broken, bool waits_for_high) const {
    std::vector<std::uint8_t> heard;
    const double duration = static_cast<double>(levels_.size()) / sender_;
    double time = 0;
    while (time < duration) {
      if (level(time)) {
        time = next_edge(time);
        continue;
      }
      unsigned frame = 0;
      for (unsigned bit = 0; bit < 10; ++bit)
        frame |= static_cast<unsigned>(level(time + (bit + 0.5) / receiver_)) << bit;
      const bool broken = frame >> 9U == 0;
      if (!broken || keeps_broken) heard.push_back(static_cast<std::uint8_t>(frame >> 1U));
      time += 9.5 / receiver_;
      while (broken && waits_for_high && !level(time)) time = next_edge(time);
    }
    return heard;
  }

 private:
  // What is computed to fall onto an edge is behind it.
  static constexpr double nothing = 1e-9;
  bool level(double time) const {
    const auto bit = static_cast<std::size_t>((time + nothing) * sender_);
    return bit >= levels_.size() || levels_[bit];
  }
  double next_edge(double time) const {
    return (std::floor((time + nothing) * sender_) + 1) / sender_;
  }

  double sender_, receiver_;
  std::vector<bool> levels_;
};

/// Whether anything in it moves a motor, or sets something.
bool acts(const std::vector<std::uint8_t>& heard) {
  for (std::size_t i = 0; i + serial_datagram_size <= heard.size(); ++i) {
    const auto request = decode_serial_request(std::span(heard).subspan(i).first<9>());
    if (!request || number(request->address) == 0) continue;
    if (find_command(static_cast<std::uint8_t>(request->command)) == nullptr) continue;
    const auto& intent = intent_of(request->command, request->type);
    if (intent.effect != Effect::reads && !is_stop(intent)) return true;
  }
  return false;
}

TEST(HarmlessQuestion, IsHeardAsItIsAtItsOwnRate) {
  for (const auto rate : serial_rates) {
    const auto sent = harmless_question(1, rate);
    const auto heard = Ear(sent, rate, rate).listen(true, true);
    EXPECT_EQ(heard, std::vector<std::uint8_t>(sent.begin(), sent.end())) << rate;
  }
}

TEST(HarmlessQuestion, AsksEachAddressForItsVersion) {
  for (unsigned address = 1; address <= 255; ++address) {
    const auto sent = harmless_question(static_cast<std::uint8_t>(address), 9600);
    const auto request = decode_serial_request(sent);
    ASSERT_TRUE(request.has_value());
    EXPECT_EQ(number(request->address), address);
    EXPECT_EQ(request->command, Command::GET_FIRMWARE_VERSION);
    EXPECT_EQ(request->type, 1);
  }
}

TEST(HarmlessQuestion, DoesNothingToModulesOfAnyOtherRate) {
  for (unsigned address = 1; address <= 255; ++address) {
    for (const auto sender : serial_rates) {
      const auto sent = harmless_question(static_cast<std::uint8_t>(address), sender);
      for (const auto receiver : serial_rates) {
        const Ear ear(sent, sender, receiver);
        for (const bool keeps : {false, true}) {
          for (const bool waits : {false, true}) {
            ASSERT_FALSE(acts(ear.listen(keeps, waits)))
                << "to " << address << " at " << sender << ", heard at " << receiver;
          }
        }
      }
    }
  }
}

/// Without the choice of its value it would: what the others prove is not nothing.
TEST(HarmlessQuestion, AnyQuestionWouldNotDo) {
  unsigned harmful = 0;
  for (std::uint16_t address = 1; address <= 255; ++address) {
    for (std::uint32_t i = 0; i < 40; ++i) {
      const auto value = static_cast<std::int32_t>(i * 2'654'435'769U);
      const auto sent = encode_serial(
          Request{ModuleAddress{address}, Command::GET_FIRMWARE_VERSION, 1, 0, value});
      harmful += static_cast<unsigned>(acts(Ear(sent, 9'600, 38'400).listen(true, false)));
    }
  }
  EXPECT_GT(harmful, 0U);
}

}  // namespace
}  // namespace tmcl::test
