#include "api/rpc_error.hpp"

#include <cstdint>
#include <utility>

#include <boost/json/value.hpp>

namespace tmcld {
namespace {

int code_of(tmcl::Errc code) {
  switch (code) {
    case tmcl::Errc::bad_argument:
    case tmcl::Errc::beyond_soft_limit: return rpc_code::invalid_params;
    case tmcl::Errc::axis_claimed:
    case tmcl::Errc::leased:
    case tmcl::Errc::lease_lost:
    case tmcl::Errc::latched:
    case tmcl::Errc::not_permitted:
    case tmcl::Errc::stale_request: return rpc_code::not_allowed;
    case tmcl::Errc::daemon_ending: return rpc_code::daemon_ending;
    default: return rpc_code::call_failed;
  }
}

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

boost::json::value text_or_null(std::string_view text) {
  if (text.empty()) return nullptr;
  return boost::json::value(text);
}

}  // namespace

RpcError rpc_error(int code, std::string_view name, std::string message, std::string hint) {
  RpcError error{code, shortened(std::move(message)), {}};
  error.data["name"] = name;
  error.data["outcome"] = name_of(tmcl::Outcome::not_sent);
  error.data["hint"] = text_or_null(shortened(std::move(hint)));
  return error;
}

RpcError param_error(std::string_view name, std::string_view param, std::string message,
                     std::string hint) {
  auto error = rpc_error(rpc_code::invalid_params, name, std::move(message), std::move(hint));
  error.data["param"] = shortened(std::string(param));
  return error;
}

RpcError call_error(const tmcl::Error& error, std::string_view axis) {
  auto result = rpc_error(code_of(error.code), name_of(error.code), error.message, error.hint);
  auto& data = result.data;
  data["outcome"] = name_of(error.outcome);
  data["bus"] = text_or_null(error.bus);
  data["axis"] = text_or_null(axis);
  data["address"] = nullptr;
  data["command"] = nullptr;
  data["status"] = nullptr;
  data["status_name"] = nullptr;
  if (error.request) {
    data["address"] = number(error.request->address);
    data["command"] = describe(*error.request);
  }
  if (error.status) {
    data["status"] = static_cast<std::uint8_t>(*error.status);
    data["status_name"] = name_of(*error.status);
  }
  return result;
}

boost::json::object to_json(const RpcError& error) {
  boost::json::object json;
  json["code"] = error.code;
  json["message"] = error.message;
  json["data"] = error.data;
  return json;
}

}  // namespace tmcld
