#include "gateway/traffic_log.hpp"

#include <algorithm>
#include <chrono>
#include <span>

namespace tmcld {
namespace {

using tmcl::Traffic;

// A module drops a datagram that has not come in after 5 ms; adapters for USB collect for 16 ms.
constexpr tmcl::Duration longest_pause_in_datagram = std::chrono::milliseconds(50);

}  // namespace

void TrafficLog::note(const Traffic& traffic) {
  if (traffic.at - last_byte_at_ > longest_pause_in_datagram) give_up_datagram();
  if (traffic.direction == Traffic::Direction::out) return note_request(traffic);
  if (framing_ == tmcl::Framing::can) return note_frame(traffic);
  last_byte_at_ = traffic.at;
  for (const auto byte : traffic.bytes) note_byte(byte);
}

void TrafficLog::note_request(const Traffic& traffic) {
  auto& entry = add(traffic.at, traffic.direction, traffic.bytes);
  entry.can_id = traffic.can_id;
  entry.can_extended = traffic.can_extended;
  entry.asker = traffic.asker;
  const bool is_can = framing_ == tmcl::Framing::can;
  entry.is_garbage = !is_can && traffic.bytes.size() != tmcl::serial_datagram_size;
  if (entry.is_garbage) return;
  const auto module = is_can ? static_cast<std::uint8_t>(traffic.can_id & 0xFFU) : entry.bytes[0];
  const auto command = entry.bytes.at(is_can ? 0 : 1);
  asked_.at(module) = {command, traffic.asker};
  // The version may come as a text, and what is read of a program with any status.
  decoder_.expect_version_text(static_cast<tmcl::Command>(command) ==
                               tmcl::Command::GET_FIRMWARE_VERSION);
  decoder_.expect_program_line(true);
}

void TrafficLog::note_frame(const Traffic& traffic) {
  auto& entry = add(traffic.at, traffic.direction, traffic.bytes);
  entry.can_id = traffic.can_id;
  entry.can_extended = traffic.can_extended;
  entry.is_garbage = entry.size < tmcl::can_datagram_size;
  entry.asker = asker_of(entry.bytes[0], entry.bytes[2]);
}

void TrafficLog::note_byte(std::uint8_t byte) {
  if (unfinished_.is_full()) {
    throw_away(unfinished_.at.front());
    std::shift_left(unfinished_.at.begin(), unfinished_.at.end(), 1);
    --unfinished_.count;
  }
  unfinished_.push(byte);
  const auto item = decoder_.push(byte);
  if (!item) return;
  end_garbage();
  auto& entry = add(last_byte_at_, Traffic::Direction::in, unfinished_.all());
  unfinished_.count = 0;
  if (const auto* reply = std::get_if<tmcl::Reply>(&*item))
    entry.asker = asker_of(reply->module, static_cast<std::uint8_t>(reply->command));
}

void TrafficLog::give_up_datagram() {
  for (const auto byte : unfinished_.all()) throw_away(byte);
  unfinished_.count = 0;
  end_garbage();
  decoder_.reset();
}

void TrafficLog::throw_away(std::uint8_t byte) {
  if (garbage_.is_full()) end_garbage();
  garbage_.push(byte);
}

void TrafficLog::end_garbage() {
  if (garbage_.count == 0) return;
  add(last_byte_at_, Traffic::Direction::in, garbage_.all()).is_garbage = true;
  garbage_.count = 0;
}

std::uint64_t TrafficLog::asker_of(std::uint8_t module, std::uint8_t command) const {
  const auto& question = asked_.at(module);
  return question.command == command ? question.asker : 0;
}

TrafficLog::Entry& TrafficLog::add(tmcl::TimePoint at, Traffic::Direction direction,
                                   std::span<const std::uint8_t> bytes) {
  auto& entry = ring_[last_ % most];
  entry = {++last_, at, direction};
  const auto size = std::min(bytes.size(), entry.bytes.size());
  entry.size = static_cast<std::uint8_t>(size);
  std::ranges::copy(bytes.first(size), entry.bytes.begin());
  return entry;
}

std::optional<tmcl::Reply> TrafficLog::last_reply_to(std::uint64_t asker) const {
  for (auto number = last_; number >= first(); --number) {
    const auto& entry = ring_[(number - 1) % most];
    if (entry.direction == Traffic::Direction::out || entry.asker != asker) continue;
    if (framing_ == tmcl::Framing::serial) return tmcl::decode_serial_reply(entry.bytes);
    tmcl::CanFrame frame{entry.can_id, entry.can_extended, entry.size, {}};
    std::copy_n(entry.bytes.begin(), std::min(entry.size, std::uint8_t{8}), frame.data.begin());
    return tmcl::decode_can_reply(frame);
  }
  return std::nullopt;
}

std::vector<TrafficLog::Entry> TrafficLog::after(std::uint64_t number, std::size_t limit) const {
  std::vector<Entry> found;
  for (auto next = std::max(number + 1, first()); next <= last_ && found.size() < limit; ++next)
    found.push_back(ring_[(next - 1) % most]);
  return found;
}

}  // namespace tmcld
