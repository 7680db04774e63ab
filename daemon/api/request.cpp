#include "api/request.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <boost/json/parse.hpp>

#include "api/params.hpp"
#include "api/repeated_name.hpp"
#include "api/suggest.hpp"
#include "tmcl/json_text.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;

// Enough for the state of an axis.
constexpr std::size_t usual_line_bytes = 512;
constexpr std::array<std::string_view, 4> members{"jsonrpc", "id", "method", "params"};

Error invalid(std::string message, std::string hint = {}) {
  return failed("invalid_request", std::move(message), std::move(hint));
}

bool is_usable_id(const json::value& id) {
  if (id.is_string()) return id.get_string().size() <= max_id_bytes;
  return id.is_int64() || id.is_uint64();
}

std::optional<Error> check_members(const json::object& message) {
  for (const auto& [key, value] : message) {
    const std::string_view name(key.data(), key.size());
    if (std::ranges::find(members, name) != members.end()) continue;
    return invalid("a request has no member '" + std::string(name) + "'", suggest(name, members));
  }
  const auto* version = message.if_contains("jsonrpc");
  if (version == nullptr || !version->is_string() || version->get_string() != "2.0") {
    return invalid("the member \"jsonrpc\" must be \"2.0\"");
  }
  const auto* id = message.if_contains("id");
  if (id == nullptr || !is_usable_id(*id)) {
    return invalid("the member \"id\" must be a string of at most " + std::to_string(max_id_bytes) +
                       " bytes or an integer",
                   "every request is answered, so that no error goes unseen");
  }
  const auto* params = message.if_contains("params");
  if (params != nullptr && !params->is_object()) {
    return invalid("the member \"params\" must be an object", "parameters go by name");
  }
  return std::nullopt;
}

Error unknown_method(std::string_view name) {
  std::vector<std::string_view> known;
  for (const auto& row : method_table()) known.push_back(row.name);
  return failed("method_not_found", "there is no method '" + std::string(name) + "'",
                suggest(name, known, "rpc.discover shows every method"));
}

Result<RpcRequest> request_of(json::object& message) {
  const auto* name = message.if_contains("method");
  if (name == nullptr || !name->is_string()) {
    return tl::unexpected(invalid("the member \"method\" must be a string"));
  }
  auto* params = message.if_contains("params");
  return make_request(std::string_view(name->get_string().data(), name->get_string().size()),
                      params == nullptr ? json::object() : std::move(params->get_object()));
}

Error unreadable(const boost::system::error_code& why) {
  const bool deep = why == json::error::too_deep;
  return failed("parse_error", "not JSON: " + why.message(),
                deep ? "messages may be nested 16 deep"
                     : "one JSON object a line, in UTF-8, and nothing else on it");
}

std::string line_of(const json::value& id, const Result<json::object>& result) {
  std::string line;
  line.reserve(usual_line_bytes);
  line += R"({"jsonrpc":"2.0","id":)";
  tmcl::append_json(line, is_usable_id(id) ? id : json::value(nullptr));
  if (result) {
    line += R"(,"result":)";
    tmcl::append_json(line, *result);
  } else {
    line += R"(,"error":)";
    tmcl::append_json(line, to_json(result.error()));
  }
  line += '}';
  return line;
}

/// Only the answer says what became of the call.
tmcl::Outcome outcome_of(const Result<json::object>& result, tmcl::Effect effect) {
  if (!result) return result.error().outcome;
  const bool acts = effect != tmcl::Effect::reads;
  return acts ? tmcl::Outcome::unknown : tmcl::Outcome::done;
}

}  // namespace

Error line_too_long() {
  return failed("line_too_long", "a line may have " + std::to_string(max_line_bytes) + " bytes",
                "the whole line was dropped");
}

Result<RpcRequest> make_request(std::string_view method, json::object params) {
  const auto* row = find_method(method);
  if (row == nullptr) return tl::unexpected(unknown_method(method));
  auto lease = take_lease_key(*row, params);
  if (!lease) return tl::unexpected(std::move(lease.error()));
  auto sent_at = take_sent_at(*row, params);
  if (!sent_at) return tl::unexpected(std::move(sent_at.error()));
  if (auto complaint = check_params(*row, params)) return tl::unexpected(std::move(*complaint));
  return RpcRequest{nullptr, row, std::move(params), *lease, *sent_at};
}

ParsedLine parse_request(std::string_view line) {
  ParsedLine parsed{nullptr, {}};
  const auto refuse = [&](Error error) {
    parsed.request = tl::unexpected(std::move(error));
    return std::move(parsed);
  };
  json::parse_options options;
  options.max_depth = max_depth;
  boost::system::error_code error;
  auto message = json::parse(json::string_view(line.data(), line.size()), error, {}, options);
  if (error) return refuse(unreadable(error));
  auto* object = message.if_object();
  if (object == nullptr) return refuse(invalid("a request is a JSON object", "no batches"));
  if (const auto* given = object->if_contains("id"); given && is_usable_id(*given))
    parsed.id = *given;
  if (auto complaint = check_members(*object)) return refuse(std::move(*complaint));
  if (const auto name = repeated_name(line, message))
    return refuse(invalid("the name '" + *name + "' stands twice in an object"));
  parsed.request = request_of(*object);
  if (parsed.request) parsed.request->id = parsed.id;
  return parsed;
}

std::string answer_line(const json::value& id, const Result<json::object>& result,
                        tmcl::Effect effect) {
  auto line = line_of(id, result);
  if (line.size() < max_answer_bytes) return line;
  auto error = failed("answer_too_long", "the answer is longer than a line may be",
                      "ask for less at a time");
  error.outcome = outcome_of(result, effect);
  return line_of(id, tl::unexpected(std::move(error)));
}

std::string notification_line(std::string_view method, const json::object& params) {
  std::string line = R"({"jsonrpc":"2.0","method":")";
  line += method;
  line += R"(","params":)";
  tmcl::append_json(line, params);
  line += '}';
  return line;
}

}  // namespace tmcld
