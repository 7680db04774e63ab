/// What the answer to a request looks like, where it is no reply that names module and command.
///
/// Another special reply is one more class in reply_form.cpp, and one more line in ReplyForm::of().
#pragma once

#include <optional>

#include "tmcl/link.hpp"
#include "tmcl/script.hpp"
#include "tmcl/serial_decoder.hpp"

namespace tmcl::engine {

/// Has no state: there is one object of each form, for all requests.
class ReplyForm {
 public:
  /// Which other exchanges may be under way on a CAN bus at the same time.
  enum class Company : std::uint8_t { any, other_forms, none };

  static const ReplyForm& of(const Request& request);

  ReplyForm(const ReplyForm&) = delete;
  ReplyForm& operator=(const ReplyForm&) = delete;

  virtual Company company() const { return Company::any; }
  /// A reply that says itself that it answers this request.
  virtual bool is_answer(const Reply& reply, const Request& sent) const;
  /// The answer may look like a reply of any module to any command.
  virtual bool is_unframed() const { return false; }
  /// CAN: an answer that is no reply at all.
  virtual std::optional<FirmwareVersion> text_in(const CanFrame&) const { return std::nullopt; }
  /// Serial: the decoder recognises nothing that is not expected.
  virtual void expect(SerialDecoder& decoder) const;

 protected:
  constexpr ReplyForm() = default;
  ~ReplyForm() = default;
};

}  // namespace tmcl::engine
