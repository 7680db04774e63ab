#include "engine/reply_form.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "tmcl/command_type.hpp"
#include "tmcl/program.hpp"

namespace tmcl::engine {
namespace {

class OrdinaryReply final : public ReplyForm {};

/// Says neither of which module it is nor what it answers.
class VersionTextReply final : public ReplyForm {
 public:
  Company company() const override { return Company::other_forms; }
  std::optional<FirmwareVersion> text_in(const CanFrame& frame) const override {
    std::array<char, version_text_size> text{};
    std::ranges::transform(frame.data, text.begin(),
                           [](std::uint8_t byte) { return static_cast<char>(byte); });
    return version_from_text(std::string_view(text.data(), frame.length));
  }
  void expect(SerialDecoder& decoder) const override {
    decoder.expect_program_line(false);
    decoder.expect_version_text(true);
  }
};

/// A line of a program has the place of the module, the status and the command for its own.
class ProgramLineReply final : public ReplyForm {
 public:
  Company company() const override { return Company::none; }
  bool is_answer(const Reply& reply, const Request& sent) const override {
    return program::refuses_memory(reply, sent);
  }
  bool is_unframed() const override { return true; }
  void expect(SerialDecoder& decoder) const override {
    decoder.expect_program_line(true);
    decoder.expect_version_text(false);
  }
};

/// The reply has the value of the request. Not so after relative moves and moves to coordinates:
/// some modules tell then where they go.
bool is_echoed(const Request& sent) {
  switch (sent.command) {
    case Command::MVP: return sent.type == move_type::absolute;
    case Command::ROR:
    case Command::ROL:
    case Command::MST:
    case Command::SAP:
    case Command::SGP:
    case Command::SIO:
    case Command::SCO: return true;
    default: return false;
  }
}

constexpr OrdinaryReply ordinary;
constexpr VersionTextReply version_text;
constexpr ProgramLineReply program_line;

}  // namespace

const ReplyForm& ReplyForm::of(const Request& request) {
  if (request.command == Command::READ_TMCL_MEMORY) return program_line;
  const bool as_text = request.type == static_cast<std::uint8_t>(VersionForm::text);
  if (request.command == Command::GET_FIRMWARE_VERSION && as_text) return version_text;
  return ordinary;
}

bool ReplyForm::is_answer(const Reply& reply, const Request& sent) const {
  if (reply.module != reply_byte(sent.address)) return false;
  // A module that could not read the request does not know which command it was.
  if (reply.status == Status::wrong_checksum && reply.command == Command{0}) return true;
  if (reply.command != sent.command) return false;
  return !is_echoed(sent) || reply.value == sent.value ||
         (reply.value == 0 && !is_success(reply.status));
}

void ReplyForm::expect(SerialDecoder& decoder) const {
  decoder.expect_program_line(false);
  decoder.expect_version_text(false);
}

}  // namespace tmcl::engine
