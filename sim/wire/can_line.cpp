#include "sim/wire/can_line.hpp"

#include <algorithm>
#include <utility>

#include "sim/bench.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/version.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

constexpr std::uint8_t long_frame = 8;

std::uint32_t identifier(const Globals& globals, std::uint8_t number) {
  return static_cast<std::uint32_t>(globals.value(number));
}

}  // namespace

CanLine::CanLine(Bench& bench, Output output) : Line(bench), output_(std::move(output)) {}

void CanLine::receive(const CanFrame& frame) {
  const Format format{frame.extended,
                      frame.length == can_datagram_size ? can_datagram_size : long_frame};
  auto whole = frame;
  std::ranges::fill(whole.data.begin() + std::min(frame.length, long_frame), whole.data.end(),
                    std::uint8_t{0});
  whole.length = long_frame;
  const auto request = decode_can_request(whole);
  if (!request) return;
  for (const auto& module : bench().modules()) hand_to(*module, frame, *request, format);
}

void CanLine::hand_to(Module& module, const CanFrame& frame, const Request& request,
                      Format format) {
  const auto& globals = module.globals();
  const auto own = identifier(globals, gp::can_id);
  const auto reply_id = identifier(globals, gp::can_reply_id);
  const auto secondary = identifier(globals, gp::can_secondary_address);
  const bool addressed = frame.id == own;
  if (!addressed && (secondary == 0 || frame.id != secondary)) return;
  last_format_[&module] = format;
  const auto answer = module.execute(request, Medium::can, *this);
  if (!addressed || answer.form == Answer::Form::none) return;
  if (answer.form == Answer::Form::version_text) {
    CanFrame text{reply_id, format.extended, format.length, {}};
    std::ranges::copy_n(to_text(module.version()).begin(), format.length, text.data.begin());
    return output_(text);
  }
  const Reply ordinary{0, reply_byte(ModuleAddress{static_cast<std::uint16_t>(own)}), answer.status,
                       request.command, answer.value};
  const auto reply =
      answer.form == Answer::Form::program_line ? program::memory_reply(answer.line) : ordinary;
  output_(encode_can(reply, reply_id, format.extended, format.length));
}

void CanLine::target_reached(const Module& module, std::int32_t motors) {
  const auto& globals = module.globals();
  const auto format = last_format_[&module];
  const Reply event{0, globals.byte(gp::can_id), Status::delayed, Command::TARGET_REACHED_EVENT,
                    motors};
  output_(encode_can(event, identifier(globals, gp::can_reply_id), format.extended, format.length));
}

}  // namespace tmcl::sim
