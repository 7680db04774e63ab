#include "tmcl/harmless_question.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include "tmcl/command.hpp"
#include "tmcl/ensure.hpp"
#include "tmcl/version.hpp"

namespace tmcl {
namespace {

constexpr std::uint32_t most_tries = 4096;
constexpr std::uint32_t values_of_motor = 64;
// Spreads the values over all bits: 2^32 divided by the golden ratio.
constexpr std::uint32_t step_of_values = 0x9E37'79B1;

SerialBytes question(std::uint8_t address, std::uint32_t number) {
  return encode_serial(Request{ModuleAddress{address}, Command::GET_FIRMWARE_VERSION,
                               static_cast<std::uint8_t>(VersionForm::binary),
                               static_cast<std::uint8_t>(number / values_of_motor),
                               static_cast<std::int32_t>(number * step_of_values)});
}

/// A line that a question is sent on. So that times are whole, a bit of the sender takes twice the
/// rate of the receiver, and the other way round.
class SentBits {
 public:
  SentBits(const SerialBytes& bytes, std::uint32_t rate_of_receiver)
      : bit_time_(2 * std::int64_t{rate_of_receiver}) {
    auto bit = bits_.begin();
    for (const auto byte : bytes) {
      *bit++ = false;
      for (unsigned i = 0; i < 8; ++i) *bit++ = (byte >> i & 1U) != 0;
      *bit++ = true;
    }
  }

  bool is_high(std::int64_t time) const {
    const auto i = static_cast<std::size_t>(time / bit_time_);
    return i >= bits_.size() || bits_.at(i);
  }
  /// The first instant from this one on at which it is so; the end if there is none.
  std::int64_t when(bool high, std::int64_t from) const {
    if (is_high(from) == high) return from;
    auto i = static_cast<std::size_t>(from / bit_time_);
    while (i < bits_.size() && bits_.at(i) != high) ++i;
    return static_cast<std::int64_t>(i) * bit_time_;
  }
  std::int64_t end() const { return static_cast<std::int64_t>(bits_.size()) * bit_time_; }

 private:
  std::array<bool, 10 * serial_datagram_size> bits_{};
  std::int64_t bit_time_;
};

struct Receiver {
  std::uint32_t rate;
  bool waits_for_high;
  bool keeps_broken_bytes;
};

std::vector<std::uint8_t> heard_by(const Receiver& receiver, const SerialBytes& sent,
                                   std::uint32_t rate) {
  const SentBits line(sent, receiver.rate);
  const auto bit = 2 * std::int64_t{rate};
  const auto middle = bit / 2;
  std::vector<std::uint8_t> heard;
  for (auto at = line.when(false, 0); at < line.end(); at = line.when(false, at)) {
    unsigned byte = 0;
    for (unsigned i = 0; i < 8; ++i)
      byte |= static_cast<unsigned>(line.is_high(at + bit * (i + 1) + middle)) << i;
    at += bit * 9 + middle;
    const bool is_whole = line.is_high(at);
    if (is_whole || receiver.keeps_broken_bytes) heard.push_back(static_cast<std::uint8_t>(byte));
    if (!is_whole && receiver.waits_for_high) at = line.when(true, at);
  }
  return heard;
}

/// No module has address 0.
bool does_something(std::span<const std::uint8_t, serial_datagram_size> bytes) {
  const auto* command = find_command(bytes[1]);
  if (bytes[0] == 0 || command == nullptr || !detail::is_sealed(bytes)) return false;
  const auto& intent = intent_of(command->command, bytes[2]);
  return intent.effect != Effect::reads && !is_stop(intent);
}

bool does_something_to(const Receiver& receiver, const SerialBytes& sent, std::uint32_t rate) {
  const auto heard = heard_by(receiver, sent, rate);
  for (std::size_t i = 0; i + serial_datagram_size <= heard.size(); ++i) {
    if (does_something(std::span(heard).subspan(i).first<serial_datagram_size>())) return true;
  }
  return false;
}

bool is_harmless(const SerialBytes& sent, std::uint32_t rate) {
  return std::ranges::none_of(serial_rates, [&](std::uint32_t other) {
    for (const bool waits : {false, true}) {
      for (const bool keeps : {false, true})
        if (does_something_to({other, waits, keeps}, sent, rate)) return true;
    }
    return false;
  });
}

}  // namespace

SerialBytes harmless_question(std::uint8_t address, std::uint32_t rate) {
  for (std::uint32_t i = 0; i < most_tries; ++i) {
    const auto bytes = question(address, i);
    if (is_harmless(bytes, rate)) return bytes;
  }
  ensure(false);  // a test proves that there is one for each address and rate
  return {};
}

}  // namespace tmcl
