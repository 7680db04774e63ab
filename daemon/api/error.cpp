#include "api/error.hpp"

#include <utility>

#include <boost/json/value.hpp>

namespace tmcld {
namespace {

/// What a client has sent may be in it, and that may be as long as a line.
std::string shortened(std::string text) {
  constexpr std::string_view end = "...";
  if (text.size() <= max_error_text_bytes) return text;
  auto size = max_error_text_bytes - end.size();
  const auto is_within_letter = [&] { return (static_cast<unsigned char>(text[size]) >> 6) == 2; };
  while (size > 0 && is_within_letter()) --size;
  text.resize(size);
  return text += end;
}

Error error_of(ErrorKind kind, std::string_view name, std::string message, std::string hint) {
  return {std::string(name), kind, tmcl::Outcome::not_sent, shortened(std::move(message)),
          shortened(std::move(hint))};
}

}  // namespace

Error not_now(std::string_view name, std::string message, std::string hint) {
  return error_of(ErrorKind::not_now, name, std::move(message), std::move(hint));
}

Error failed(std::string_view name, std::string message, std::string hint) {
  return error_of(ErrorKind::failed, name, std::move(message), std::move(hint));
}

Error param_error(std::string_view name, std::string_view param, std::string message,
                  std::string hint) {
  auto error =
      error_of(tmcl::client::kind_of_objection(name), name, std::move(message), std::move(hint));
  error.subject["param"] = shortened(std::string(param));
  return error;
}

Error call_error(const tmcl::Error& error, std::string_view axis) {
  auto known = tmcl::client::error_from(error);
  auto result = error_of(known.kind, known.name, std::move(known.message), std::move(known.hint));
  result.outcome = known.outcome;
  for (const auto* key : {"bus", "axis", "address", "command", "status", "status_name"})
    result.subject[key] = std::move(known.subject[key]);
  if (!axis.empty()) result.subject["axis"] = axis;
  return result;
}

}  // namespace tmcld
