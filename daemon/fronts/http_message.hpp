/// Requests and answers by HTTP as Beast has them; included by http_connection.cpp alone, since it
/// takes long to compile.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <boost/beast/core/string.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "api/request.hpp"
#include "fronts/http_admission.hpp"
#include "fronts/page_files.hpp"

namespace tmcld {

namespace http = boost::beast::http;

/// Takes nothing that a proxy in front of it may read otherwise: RFC 9112, 3.2 and 5.2.
class RequestParser final : public http::request_parser<http::string_body> {
 public:
  /// Why the head is refused; empty if it is not.
  const std::string& objection() const { return objection_; }

 private:
  void on_field_impl(http::field name, boost::beast::string_view name_text,
                     boost::beast::string_view value, boost::system::error_code& error) override {
    // The parser begins when all of the head is there, so that this finds the end of a line.
    const auto* end = name_text.data() + name_text.size();
    while (end[0] != '\r' || end[1] != '\n') ++end;
    const bool is_folded = end[2] == ' ' || end[2] == '\t';
    const bool is_repeated = is_single(name) && get().count(name) > 0;
    if (is_folded) objection_ = "is on more than one line";
    if (is_repeated) objection_ = "is there twice";
    if (is_folded || is_repeated) {
      objection_ = "the field '" + std::string(name_text) + "' " + objection_;
      error = http::error::bad_field;
      return;
    }
    // What comes behind the body says nothing of who sends it.
    if (!is_header_done()) get().insert(name, name_text, value);
  }
  /// Who is let in depends on it.
  static bool is_single(http::field name) {
    return name == http::field::host || name == http::field::authorization ||
           name == http::field::cookie || name == http::field::origin ||
           name == http::field::content_type || name == http::field::expect;
  }

  std::string objection_;
};

using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

inline std::string_view view_of(boost::beast::string_view text) {
  return {text.data(), text.size()};
}

inline HttpHead head_of(const Request& request) {
  const auto field = [&](http::field name) { return view_of(request[name]); };
  HttpHead head{view_of(request.method_string()),
                view_of(request.target()),
                field(http::field::host),
                {},
                field(http::field::authorization),
                field(http::field::cookie),
                field(http::field::content_type),
                field(http::field::sec_websocket_protocol),
                boost::beast::websocket::is_upgrade(request)};
  if (request.find(http::field::origin) != request.end()) head.origin = field(http::field::origin);
  return head;
}

/// As an answer to a call would be that could not be read.
inline std::string body_of(const Error& refusal) {
  return answer_line(nullptr, tl::unexpected(refusal)) + "\n";
}

inline Response response_of(unsigned status, const char* type, std::string body, unsigned version,
                            bool keep_alive) {
  Response response(static_cast<http::status>(status), version);
  response.set(http::field::server, "tmcld");
  response.set(http::field::content_type, type);
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  if (status == 401) response.set(http::field::www_authenticate, "Bearer");
  if (status == 426) response.set(http::field::upgrade, "websocket");
  response.keep_alive(keep_alive);
  response.body() = std::move(body);
  response.prepare_payload();
  return response;
}

constexpr auto json_type = "application/json";
constexpr auto plain_type = "text/plain; charset=utf-8";
constexpr auto metrics_type = "text/plain; version=0.0.4; charset=utf-8";

/// The page may load what is its own, and no other page may show it in a frame.
constexpr auto content_security_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self'; "
    "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

inline Response page_response(const PageFile& file, const Request& request) {
  const auto field = [&](http::field name) { return view_of(request[name]); };
  const bool is_there = is_known(file, field(http::field::if_none_match));
  const auto body = body_for(file, field(http::field::accept_encoding));
  Response response(is_there ? http::status::not_modified : http::status::ok, request.version());
  response.set(http::field::server, "tmcld");
  response.set(http::field::content_type, file.type);
  response.set(http::field::etag, file.tag);
  response.set(http::field::vary, "Accept-Encoding");
  response.set(http::field::cache_control,
               file.is_constant ? "public, max-age=31536000, immutable" : "no-cache");
  response.set("Content-Security-Policy", content_security_policy);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.keep_alive(request.keep_alive());
  if (is_there) return response;
  if (!body.coding.empty()) response.set(http::field::content_encoding, body.coding);
  response.content_length(body.bytes.size());
  if (request.method() != http::verb::head) response.body() = body.bytes;
  return response;
}

}  // namespace tmcld
