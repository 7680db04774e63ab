/// The methods of stand-alone programs and of firmware.
#pragma once

#include <vector>

#include "tmcl/api/module.hpp"
#include "tmcl/firmware.hpp"

namespace tmcl::api {

namespace program {

constexpr std::string_view program_summary = "a program file, in hexadecimal";
constexpr std::string_view first_address_summary = "address of its first command; 0 if absent";
constexpr Bounds program_addresses{0, 2047};

struct LabelledAddress {
  TMCL_STRUCT(LabelledAddress);
  TMCL_FIELD(std::string, name, "as it is written where it stands");
  TMCL_FIELD(std::uint32_t, address, "of the command behind it");
};
struct Assembled {
  TMCL_STRUCT(Assembled);
  TMCL_FIELD(std::string, program, program_summary);
  TMCL_FIELD(std::uint32_t, commands, "how many commands it has");
  TMCL_FIELD(std::vector<std::uint32_t>, lines, "of each command, the line of the text, from 1");
  TMCL_FIELD(std::vector<LabelledAddress>, labels, "in their order in the text");
};
struct Assemble {
  TMCL_METHOD("program.assemble", reads, Assembled,
              "makes a program file of a program's text; asks no module", Assemble);
  TMCL_FIELD(std::string, text, "the text, which includes no file but TMCLParam.tmc");
  TMCL_FIELD(std::optional<std::string>, model,
             "whose parameters TMCLParam.tmc names, such as TMCM-1110; those that have one number "
             "on all models if absent");
};

struct Commands {
  TMCL_STRUCT(Commands);
  TMCL_FIELD(std::uint32_t, commands, "how many commands it has");
};
struct Load : OnModule {
  TMCL_METHOD("program.load", writes, Commands,
              "loads a program into a module; tells its progress by notify_progress", Load,
              OnModule);
  TMCL_FIELD(std::string, program, program_summary);
  TMCL_FIELD(std::optional<std::uint16_t>, first_address, first_address_summary, program_addresses);
  TMCL_FIELD(std::optional<bool>, compare, "read it back and compare; true if absent");
};
struct Compare : OnModule {
  TMCL_METHOD("program.compare", reads, Commands, "compares a program with the one in a module",
              Compare, OnModule);
  TMCL_FIELD(std::string, program, program_summary);
  TMCL_FIELD(std::optional<std::uint16_t>, first_address, first_address_summary, program_addresses);
};
struct ReadProgram {
  TMCL_STRUCT(ReadProgram);
  TMCL_FIELD(std::uint32_t, commands, "how many commands it has");
  TMCL_FIELD(std::string, program, program_summary);
};
struct Read : OnModule {
  TMCL_METHOD("program.read", reads, ReadProgram, "reads the program in a module", Read, OnModule);
  TMCL_FIELD(std::optional<std::uint16_t>, first_address, first_address_summary, program_addresses);
  TMCL_FIELD(std::optional<std::uint16_t>, length, "how many commands; up to its end if absent",
             {1, 2048});
};
struct Started {
  TMCL_STRUCT(Started);
  TMCL_FIELD(
      bool, unattended,
      "true: what the program sets turning has no owner, and turns on when a connection ends");
};
struct Run : SoonOnModule {
  TMCL_METHOD("program.run", moves, Started, "runs the program in a module", Run, SoonOnModule);
  TMCL_FIELD(std::optional<std::uint16_t>, first_address,
             "where it begins; where it stands if absent", program_addresses);
};
struct Stop : SoonOnModule {
  TMCL_METHOD("program.stop", writes, Nothing, "ends the program; motors go on", Stop,
              SoonOnModule);
};
struct Step : SoonOnModule {
  TMCL_METHOD("program.step", moves, Started, "executes one command of the program", Step,
              SoonOnModule);
};
constexpr std::int64_t most_steps_at_once = 100'000;
constexpr std::int64_t longest_wait_ms = 3'600'000;
constexpr std::int64_t usual_wait_ms = 60'000;
struct Stepped {
  TMCL_STRUCT(Stepped);
  TMCL_FIELD(std::string, reason,
             "address: the next command is at one of them; ended: the program has ended, failed or "
             "was stopped; steps: so many were executed; waits: the command is not over yet");
  TMCL_FIELD(std::uint32_t, steps, "how many commands were executed, one that waits included");
  TMCL_FIELD(std::string, state, "stopped, running, stepping or reset");
  TMCL_FIELD(std::optional<std::int32_t>, next_address, "the next command");
  TMCL_FIELD(std::optional<std::int32_t>, last_error, "0: none; null if the module does not say");
  TMCL_FIELD(
      bool, unattended,
      "true: what the program sets turning has no owner, and turns on when a connection ends");
};
struct StepTo : OnModule {
  TMCL_METHOD("program.step_to", moves, Stepped,
              "executes commands of the program one by one, until it stands before one of these; "
              "tells its progress by notify_progress",
              StepTo, OnModule);
  TMCL_FIELD(std::optional<std::vector<std::uint16_t>>, until,
             "addresses in the program: it ends before a command there, but executes the first one "
             "anyhow",
             program_addresses);
  TMCL_FIELD(std::optional<std::uint32_t>, most_steps,
             "how many commands at most; 1 if absent, or 1000 with `until`",
             {1, most_steps_at_once});
  TMCL_FIELD(std::optional<std::int64_t>, wait_ms,
             "how long one command may take, such as WAIT; 60000 if absent", {0, longest_wait_ms});
};
struct Reset : SoonOnModule {
  TMCL_METHOD("program.reset", writes, Nothing, "ends the program and sets it back to its start",
              Reset, SoonOnModule);
};
struct ProgramState {
  TMCL_STRUCT(ProgramState);
  TMCL_FIELD(std::string, state, "stopped, running, stepping or reset");
  TMCL_FIELD(std::optional<std::int32_t>, next_address,
             "the next command; null if the module does not say");
  TMCL_FIELD(std::optional<std::int32_t>, last_error, "0: none; null if the module does not say");
};
struct Status : SoonOnModule {
  TMCL_METHOD("program.status", reads, ProgramState, "what the program does", Status, SoonOnModule);
};

struct OnBreakpoint : SoonOnModule {
  TMCL_STRUCT(OnBreakpoint, SoonOnModule);
  TMCL_FIELD(std::uint16_t, at, "address in the program", program_addresses);
};
struct SetBreakpoint : OnBreakpoint {
  TMCL_METHOD("program.set_breakpoint", writes, Nothing, "stops the program there from now on",
              SetBreakpoint, OnBreakpoint);
};
struct ClearBreakpoint : OnBreakpoint {
  TMCL_METHOD("program.clear_breakpoint", writes, Nothing, "does not stop it there any more",
              ClearBreakpoint, OnBreakpoint);
};
struct ClearBreakpoints : SoonOnModule {
  TMCL_METHOD("program.clear_breakpoints", writes, Nothing, "does not stop it anywhere any more",
              ClearBreakpoints, SoonOnModule);
};

}  // namespace program

/// To what is longer than a line, and handed over in parts.
constexpr std::string_view data_summary = "the next bytes, in hexadecimal";
struct HandedOver {
  TMCL_STRUCT(HandedOver);
  TMCL_FIELD(std::int32_t, bytes, "how many there are now");
};

namespace firmware {

struct FirmwareState {
  TMCL_STRUCT(FirmwareState);
  TMCL_FIELD(std::optional<std::string>, model, model_summary);
  TMCL_FIELD(std::uint16_t, model_number, "its number");
  TMCL_FIELD(std::string, running, "what answers: 1110V142, or 1110B101 for its bootloader");
  TMCL_FIELD(bool, in_bootloader, "no firmware runs");
};
struct Status : SoonOnModule {
  TMCL_METHOD("firmware.status", reads, FirmwareState,
              "what runs in a module, as its updates need to know", Status, SoonOnModule);
};
struct Stage {
  TMCL_METHOD("firmware.stage", reads, HandedOver, "hands over the next part of a firmware image",
              Stage);
  TMCL_FIELD(std::int32_t, offset, "how many bytes were handed over before; 0: a new image",
             {0, tmcl::firmware::most_image_bytes});
  TMCL_FIELD(std::string, data, data_summary);
};
struct Exchange {
  TMCL_STRUCT(Exchange);
  TMCL_FIELD(std::optional<std::string>, model, model_summary);
  TMCL_FIELD(std::uint16_t, model_number, "its number");
  TMCL_FIELD(std::string, before, "what ran before: 1110V101");
  TMCL_FIELD(std::string, running, "what runs now");
  TMCL_FIELD(std::uint32_t, checksum, "of the image");
};
struct Upload : OnModule {
  TMCL_METHOD("firmware.upload", moves, Exchange,
              "exchanges the firmware of a module for the image that was handed over; tells its "
              "progress by notify_progress",
              Upload, OnModule);
  TMCL_FIELD(std::uint32_t, start, "address of the image's first byte", {.minimum = 0});
  TMCL_FIELD(std::uint32_t, bytes, "how many bytes were handed over",
             {1, tmcl::firmware::most_image_bytes});
  TMCL_FIELD(std::optional<bool>, force,
             "also an image that does not say that it is for this model");
};

}  // namespace firmware
}  // namespace tmcl::api
