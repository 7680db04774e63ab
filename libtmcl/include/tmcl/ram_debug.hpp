/// The numbers of command 142, RAMDebug: a module records some of its values at the ticks of its
/// own clock, and a host reads the record afterwards.
///
/// They are those of the vendor's firmware for evaluation boards (TMC-EvalSystem, tmc/RAMDebug.h
/// and tmc/TMCL.c) and of PyTrinamic (pytrinamic/RAMDebug.py, pytrinamic/rd.py).
#pragma once

#include <cstdint>

namespace tmcl::ram_debug {

/// The type of the command.
enum class Type : std::uint8_t {
  init = 0,
  set_sample_count = 1,
  set_sampling_source = 2,
  set_prescaler = 3,
  set_channel = 4,
  set_trigger_channel = 5,
  set_shift_mask = 6,
  enable_trigger = 7,
  get_state = 8,
  get_sample = 9,
  get_info = 10,
  get_channel_type = 11,
  get_channel_address = 12,
  set_pretrigger_sample_count = 13,
  get_pretrigger_sample_count = 14,
  set_process_frequency = 15,
  set_type = 16,
  set_eval_channel = 17,
  set_address = 18,
  set_trigger_type = 19,
  set_trigger_eval_channel = 20,
  set_trigger_address = 21,
  bulk_download = 22,
};

/// What a channel reads. Its select word says which of them: motor or bank in the highest byte, the
/// number in the lowest.
enum class Kind : std::uint8_t {
  off = 0,
  axis_parameter = 1,
  chip_register = 2,
  stacked_register = 3,
  system_tick = 4,
  ram_debug_parameter = 5,
  analog_input = 6,
  global_parameter = 8,
};

/// What ends the wait: a value that was not greater than the threshold becomes so (rising), no
/// longer is (falling), or either.
enum class Trigger : std::uint8_t {
  unconditional = 0,
  rising_signed = 1,
  falling_signed = 2,
  both_signed = 3,
  rising_unsigned = 4,
  falling_unsigned = 5,
  both_unsigned = 6,
};

enum class State : std::uint8_t {
  idle = 0,
  trigger = 1,     ///< Waits for its trigger.
  capture = 2,     ///< Records what comes after it.
  complete = 3,    ///< The record can be read, until INIT.
  pretrigger = 4,  ///< Records what has to lie before the trigger; does not look for that yet.
  error = 5,
};

enum class Info : std::uint8_t {
  channels = 0,
  elements = 1,        ///< Of the buffer: one for each value of each channel.
  base_frequency = 2,  ///< In Hz.
  written = 3,         ///< Where in its buffer it writes next.
};

/// In place of a channel's number: the trigger's.
inline constexpr std::uint8_t trigger_index = 255;

}  // namespace tmcl::ram_debug
