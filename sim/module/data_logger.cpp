#include "sim/module/data_logger.hpp"

#include <algorithm>
#include <bit>

namespace tmcl::sim {
namespace {

using ram_debug::Info;
using ram_debug::Kind;
using ram_debug::State;
using ram_debug::Trigger;
using ram_debug::Type;

constexpr int word_bits = 32;
constexpr std::uint32_t low_byte = 0xFF;

// The boards stop at 6; newer firmware has global parameters as well.
bool is_kind(std::uint8_t number) {
  return number <= static_cast<std::uint8_t>(Kind::analog_input) ||
         number == static_cast<std::uint8_t>(Kind::global_parameter);
}

std::uint32_t shifted(std::uint32_t word, std::uint8_t by) {
  return by < word_bits ? word >> by : 0;
}

// With the top bit of the field as its sign.
std::int32_t with_sign(std::uint32_t value, std::uint32_t field) {
  const bool negative = (value & std::bit_floor(field)) != 0;
  return static_cast<std::int32_t>(negative ? value | ~field : value);
}

Answer taken(const Request& request, bool ok) {
  return echo(request, ok ? Status::ok : Status::maximum_exceeded);
}

std::uint32_t value_of(const Request& request) { return static_cast<std::uint32_t>(request.value); }

}  // namespace

Answer DataLogger::execute(const Request& request, TimePoint now, const Probe& probe) {
  switch (static_cast<Type>(request.type)) {
    case Type::get_state:
    case Type::get_sample:
    case Type::get_info:
    case Type::get_channel_type:
    case Type::get_channel_address:
    case Type::get_pretrigger_sample_count: return read(request);
    default: return change(request, now, probe);
  }
}

Answer DataLogger::change(const Request& request, TimePoint now, const Probe& probe) {
  const auto value = value_of(request);
  switch (static_cast<Type>(request.type)) {
    case Type::init: init(); break;
    case Type::set_sample_count: sample_count_ = std::min(value, elements); break;
    case Type::set_sampling_source:
      return echo(request, value == 0 ? Status::ok : Status::invalid_value);
    case Type::set_prescaler: divider_ = value + 1; break;
    case Type::set_channel: return taken(request, set_channel(request.motor, value));
    case Type::set_trigger_channel:
      return taken(request, set_trigger_channel(request.motor, value));
    case Type::set_shift_mask:
      mask_ = value;
      shift_ = request.motor;
      break;
    case Type::enable_trigger: enable(request.motor, value, now, probe); break;
    case Type::set_pretrigger_sample_count:
      pretrigger_count_ = std::min(value, sample_count_);
      break;
    case Type::set_process_frequency: break;  // it has no timer whose frequency could be set
    case Type::set_type: return taken(request, set_kind(value));
    case Type::set_eval_channel: return taken(request, is_idle() && free_channel() != nullptr);
    case Type::set_address: return taken(request, set_select(value));
    case Type::set_trigger_type: return taken(request, set_trigger_kind(value));
    case Type::set_trigger_eval_channel: return taken(request, is_idle());
    case Type::set_trigger_address: return taken(request, set_trigger_select(value));
    case Type::bulk_download: return echo(request, Status::command_not_available);
    default: return echo(request, Status::wrong_type);
  }
  return echo(request);
}

// The ticks since the last samples go on counting, as they do on the boards.
void DataLogger::init() {
  state_ = State::idle;
  std::ranges::fill(ring_, 0);
  write_index_ = 0;
  divider_ = 1;
  sample_count_ = elements;
  pretrigger_count_ = 0;
  channels_.fill({});
  trigger_channel_ = {};
  mask_ = UINT32_MAX;
  shift_ = 0;
}

// ---- What it can be asked

Answer DataLogger::read(const Request& request) const {
  const auto value = value_of(request);
  Reading result;
  switch (static_cast<Type>(request.type)) {
    case Type::get_state: result = static_cast<std::uint32_t>(state_); break;
    case Type::get_sample: result = sample(value); break;
    case Type::get_info: result = info(value); break;
    case Type::get_channel_type:
      if (const auto* found = channel(request.motor))
        result = (value & ~low_byte) | static_cast<std::uint32_t>(found->kind);
      break;
    case Type::get_channel_address:
      if (const auto* found = channel(request.motor)) result = found->select;
      break;
    default: result = pretrigger_count_;
  }
  if (!result) return echo(request, Status::maximum_exceeded);
  return reading(static_cast<std::int32_t>(*result));
}

DataLogger::Reading DataLogger::sample(std::uint32_t index) const {
  const bool there = state_ == State::complete || (state_ == State::capture && index < recorded());
  if (index >= sample_count_ || !there) return std::nullopt;
  return ring_[(start_index_ + index) % elements];
}

DataLogger::Reading DataLogger::info(std::uint32_t number) const {
  switch (number) {
    case static_cast<std::uint32_t>(Info::channels): return channel_count;
    case static_cast<std::uint32_t>(Info::elements): return elements;
    case static_cast<std::uint32_t>(Info::base_frequency): return ticks_per_second;
    case static_cast<std::uint32_t>(Info::written): return write_index_;
    default: return std::nullopt;
  }
}

const DataLogger::Channel* DataLogger::channel(std::uint8_t index) const {
  if (index == ram_debug::trigger_index) return &trigger_channel_;
  return index < channels_.size() ? &channels_[index] : nullptr;
}

// ---- Channels: only before it is enabled

DataLogger::Channel* DataLogger::free_channel() {
  const auto found = std::ranges::find(channels_, Kind::off, &Channel::kind);
  return found != channels_.end() ? &*found : nullptr;
}

// A kind that there is not leaves the select word behind, in a channel that stays free.
bool DataLogger::set_channel(std::uint8_t kind, std::uint32_t select) {
  return set_select(select) && set_kind(kind);
}

bool DataLogger::set_kind(std::uint32_t kind) {
  const auto number = static_cast<std::uint8_t>(kind & low_byte);
  auto* free = free_channel();
  if (!is_kind(number) || !is_idle() || free == nullptr) return false;
  free->kind = Kind{number};
  return true;
}

bool DataLogger::set_select(std::uint32_t select) {
  auto* free = free_channel();
  if (!is_idle() || free == nullptr) return false;
  free->select = select;
  return true;
}

bool DataLogger::set_trigger_channel(std::uint8_t kind, std::uint32_t select) {
  return set_trigger_kind(kind) && set_trigger_select(select);
}

bool DataLogger::set_trigger_kind(std::uint32_t kind) {
  const auto number = static_cast<std::uint8_t>(kind & low_byte);
  if (!is_kind(number) || !is_idle()) return false;
  trigger_channel_.kind = Kind{number};
  return true;
}

bool DataLogger::set_trigger_select(std::uint32_t select) {
  if (!is_idle()) return false;
  trigger_channel_.select = select;
  return true;
}

// ---- The course of a record

// What cannot be enabled is ignored, and answered ok all the same.
void DataLogger::enable(std::uint8_t trigger, std::uint32_t threshold, TimePoint now,
                        const Probe& probe) {
  if (trigger > static_cast<std::uint8_t>(Trigger::both_unsigned) || !is_idle()) return;
  const bool is_edge = Trigger{trigger} != Trigger::unconditional;
  if (is_edge && trigger_channel_.kind == Kind::off) return;
  trigger_ = Trigger{trigger};
  threshold_ = threshold;
  above_ = look(probe);
  state_ = State::pretrigger;
  next_tick_ = clock_.at(now) + 1;
}

void DataLogger::run_due(TimePoint now, const Probe& probe) {
  if (next_due() > now) return;
  next_tick_ = clock_.at(now) + 1;
  tick(probe);
}

void DataLogger::tick(const Probe& probe) {
  if (state_ == State::pretrigger && write_index_ >= pretrigger_count_) state_ = State::trigger;
  if (state_ == State::trigger) {
    const auto before = std::exchange(above_, look(probe));
    if (is_met(before, above_)) {
      state_ = State::capture;
      start_index_ = (write_index_ - pretrigger_count_) % elements;
    }
  }
  if (++ticks_ < divider_) return;
  ticks_ = 0;
  write_samples(probe);
}

DataLogger::Above DataLogger::look(const Probe& probe) const {
  if (trigger_channel_.kind == Kind::off) return {};
  const auto field = shifted(mask_, shift_);
  const auto value = shifted(probe(trigger_channel_) & mask_, shift_);
  return {with_sign(value, field) > static_cast<std::int32_t>(threshold_), value > threshold_};
}

bool DataLogger::is_met(Above before, Above after) const {
  switch (trigger_) {
    case Trigger::unconditional: return true;
    case Trigger::rising_signed: return !before.as_signed && after.as_signed;
    case Trigger::falling_signed: return before.as_signed && !after.as_signed;
    case Trigger::both_signed: return before.as_signed != after.as_signed;
    case Trigger::rising_unsigned: return !before.as_unsigned && after.as_unsigned;
    case Trigger::falling_unsigned: return before.as_unsigned && !after.as_unsigned;
    case Trigger::both_unsigned: return before.as_unsigned != after.as_unsigned;
  }
  return false;
}

// The end is looked for after each value: the last round can be of some channels only.
void DataLogger::write_samples(const Probe& probe) {
  for (const auto& channel : channels_) {
    if (channel.kind == Kind::off) continue;
    ring_[write_index_] = probe(channel);
    write_index_ = (write_index_ + 1) % elements;
    if (write_index_ == 0 && state_ == State::pretrigger) state_ = State::trigger;
    if (state_ != State::capture) continue;
    if (recorded() == 0 || recorded() >= sample_count_) {
      state_ = State::complete;
      return;
    }
  }
}

}  // namespace tmcl::sim
