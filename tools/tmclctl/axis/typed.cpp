#include "typed.hpp"

#include "command_line/form.hpp"

namespace tmclctl {

std::optional<std::int32_t> Typed::counted() const {
  const auto number = parse_number<std::int32_t>(text);
  return internal && number ? std::optional(*number) : std::nullopt;
}

std::optional<tmcl::api::Amount> Typed::amount() const {
  if (text.empty() || counted()) return std::nullopt;
  return tmcl::api::Amount(text);
}

tmcl::api::NameOrNumber name_or_number(const std::string& text) {
  if (const auto number = parse_number<std::int32_t>(text)) return *number;
  return text;
}

}  // namespace tmclctl
