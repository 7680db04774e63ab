// The method table, and the check of parameters that reads it.
#include <array>
#include <limits>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include <boost/json.hpp>

#include "api/params.hpp"
#include "api/request.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/json_text.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;
using testing::HasSubstr;
using tmcl::api::FieldType;
using ParamInfo = tmcl::api::Field;

std::string to_text(const json::object& object) {
  std::string text;
  tmcl::append_json(text, object);
  return text;
}

json::value good_value(const ParamInfo& row) {
  switch (row.type) {
    case FieldType::text: return "word";
    case FieldType::text_or_integer: return row.minimum;
    case FieldType::texts: return json::array{"word"};
    case FieldType::integers: return json::array{row.minimum};
    case FieldType::quantity: return "1.5mm";
    case FieldType::quantities: return json::array{0, "1.5mm"};
    case FieldType::boolean: return true;
    default: return row.minimum;
  }
}

json::object good_params(const MethodInfo& method) {
  json::object params;
  for (const auto& row : method.params) params[row.name] = good_value(row);
  return params;
}

bool has_range(const ParamInfo& row) {
  return row.type == FieldType::integer || row.type == FieldType::text_or_integer ||
         row.type == FieldType::integers;
}

double as_double(std::int64_t number) { return static_cast<double>(number); }

/// A number as the parameter takes it.
json::value as_given(const ParamInfo& row, const json::value& number) {
  if (row.type != FieldType::integers) return number;
  return json::array{row.minimum, number};
}

// What a parameter of this type must never be.
std::vector<json::value> bad_values(FieldType type) {
  std::vector<json::value> values{nullptr, json::object{}, 1.5, json::array{1}};
  if (type == FieldType::number || type == FieldType::quantity)
    std::erase(values, json::value(1.5));
  if (type == FieldType::integers) values.back() = json::array{"1"};
  if (type == FieldType::quantities) values.back() = json::array{true};
  const bool is_array = type == FieldType::integers || type == FieldType::quantities;
  if (type == FieldType::text || type == FieldType::texts || is_array) values.push_back(7);
  if (type == FieldType::integer || type == FieldType::texts) values.push_back("7");
  if (type != FieldType::boolean) values.push_back(true);
  return values;
}

TEST(DaemonMethodTable, IsComplete) {
  std::set<std::string_view> names;
  for (const auto& method : method_table()) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_FALSE(method.summary.empty()) << method.name;
    EXPECT_NE(method.handler, nullptr) << method.name;
    for (const auto rows : {method.params, method.result}) {
      for (const auto& row : rows) EXPECT_FALSE(row.summary.empty()) << method.name << row.name;
    }
  }
}

TEST(DaemonParams, AreAdmittedWhenGood) {
  for (const auto& method : method_table()) {
    const auto error = check_params(method, good_params(method));
    EXPECT_FALSE(error) << method.name << ": " << error->message;
  }
}

TEST(DaemonParams, EveryErrorNamesTheOffender) {
  const auto expect_offender = [](const MethodInfo& method, const json::object& params,
                                  std::string_view offender, std::string_view name) {
    const auto error = check_params(method, params);
    ASSERT_TRUE(error) << method.name << " " << to_text(params);
    EXPECT_EQ(error->kind, ErrorKind::bad_request);
    EXPECT_EQ(error->name, name) << to_text(params);
    EXPECT_EQ(error->subject.at("param"), json::string_view(offender)) << to_text(params);
    EXPECT_EQ(error->outcome, tmcl::Outcome::not_sent);
    EXPECT_THAT(error->message, HasSubstr(std::string(offender)));
  };
  for (const auto& method : method_table()) {
    const auto good = good_params(method);
    auto params = good;
    params["surplus"] = 1;
    expect_offender(method, params, "surplus", "bad_argument");
    for (const auto& row : method.params) {
      if (row.required) {
        params = good;
        params.erase(json::string_view(row.name));
        expect_offender(method, params, row.name, "bad_argument");
      }
      for (const auto& value : bad_values(row.type)) {
        params = good;
        params[row.name] = value;
        expect_offender(method, params, row.name, "bad_argument");
      }
      if (!has_range(row)) continue;
      for (const json::value& value :
           {json::value(row.minimum - 1), json::value(row.maximum + 1), json::value(INT64_MIN),
            json::value(INT64_MAX), json::value(UINT64_MAX), json::value(1e300),
            json::value(-1e300), json::value(as_double(row.minimum - 1)),
            json::value(as_double(row.maximum + 1))}) {
        params = good;
        params[row.name] = as_given(row, value);
        expect_offender(method, params, row.name, "out_of_range");
      }
    }
  }
}

TEST(DaemonParams, BoundsThemselvesAreAdmitted) {
  int ranges = 0;
  for (const auto& method : method_table()) {
    for (const auto& row : method.params) {
      if (!has_range(row)) continue;
      ++ranges;
      for (const auto bound : {row.minimum, row.maximum}) {
        for (const json::value& value : {json::value(bound), json::value(as_double(bound))}) {
          auto params = good_params(method);
          params[row.name] = as_given(row, value);
          const auto error = check_params(method, params);
          EXPECT_FALSE(error) << to_text(params) << ": " << error->message;
        }
      }
    }
  }
  EXPECT_GT(ranges, 0);
}

TEST(DaemonJsonText, WritesNumbersAsPeopleDo) {
  EXPECT_EQ(to_text({{"a", 30517.578125}, {"b", 0.0}, {"c", json::array{}}, {"d", "\"\n"}}),
            R"({"a":30517.578125,"b":0,"c":[],"d":"\"\n"})");
}

TEST(DaemonJsonText, IsReadAsWhatItWasMadeOf) {
  std::string every_byte;
  for (char byte = 0; byte < 0x7F; ++byte) every_byte += byte;
  constexpr auto least = std::numeric_limits<std::int64_t>::min();
  constexpr auto greatest = std::numeric_limits<std::uint64_t>::max();
  const json::object all{{"words", every_byte},
                         {every_byte, json::array{nullptr, true, false, 1e300, -0.5}},
                         {"numbers", json::array{least, greatest, 0, -1}},
                         {"empty", json::array{json::object{}, json::array{}, ""}}};
  EXPECT_EQ(json::parse(to_text(all)), all);
}

TEST(DaemonJsonText, IsUtf8WhateverItIsMadeOf) {
  const auto written = [](std::string_view text) {
    const auto line = to_text({{"a", text}});
    return std::string(json::parse(line).at("a").as_string());
  };
  for (const std::string good : {"", "abc", "\u00e4\u20ac", "\U0001F600\u0800\uffff", "\x7f"})
    EXPECT_EQ(written(good), good);
  EXPECT_EQ(written("a\xE2\x82z"), "a\uFFFD\uFFFDz");
  std::mt19937_64 random(tmcl::test::seed());
  // Such as letters that are cut, too long, surrogates, and what follows the last one.
  constexpr std::string_view bytes =
      "a\x80\x8F\x90\x9F\xA0\xBF\xC0\xC2\xDF\xE0\xED\xEF\xF0\xF4\xF5\xFF";
  for (int round = 0; round < tmcl::test::rounds(20'000); ++round) {
    std::string text;
    for (auto size = random() % 8; size > 0; --size) text += bytes[random() % bytes.size()];
    ASSERT_NO_THROW(written(text));
    ASSERT_EQ(written(written(text)), written(text));
  }
}

TEST(DaemonRequest, NoNameStandsTwice) {
  const auto told = [](std::string_view line) {
    const auto request = parse_request(line).request;
    return request ? "" : request.error().message;
  };
  EXPECT_EQ(told(R"({"jsonrpc":"2.0","id":1,"method":"bus.list","method":"axis.rotate"})"),
            "the name 'method' stands twice in an object");
  EXPECT_EQ(told(R"({"jsonrpc":"2.0","id":1,"method":"axis.stop",)"
                 R"("params":{"axis":"x","\u0061xis":"y"}})"),
            "the name 'axis' stands twice in an object");
  EXPECT_EQ(told(R"({"jsonrpc":"2.0","id":1,"method":"axis.stop","params":{"axis":"a:\"id\":x"}})"),
            "");
  EXPECT_EQ(told(R"({"jsonrpc":"2.0","id":"id","method":"axis.stop","params":{"axis":"axis"}})"),
            "");
}

// A line of a good request with some of its bytes changed, removed or added.
std::string damaged(std::string line, std::mt19937_64& random) {
  constexpr std::string_view alphabet = "{}[]\",:0123456789.-eE\\utrfalsn \t\xFF\x80\x01";
  for (auto changes = 1 + random() % 4; changes > 0 && !line.empty(); --changes) {
    const auto at = random() % line.size();
    const char letter = alphabet[random() % alphabet.size()];
    switch (random() % 3) {
      case 0: line[at] = letter; break;
      case 1: line.erase(at, 1 + random() % 3); break;
      default: line.insert(at, 1, letter);
    }
  }
  return line;
}

TEST(DaemonRequest, AnyLineIsARequestOrAProperError) {
  std::mt19937_64 random(tmcl::test::seed());
  const auto methods = method_table();
  int requests = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto& method = methods[random() % methods.size()];
    json::object message{{"jsonrpc", "2.0"}, {"id", i}, {"method", method.name}};
    message["params"] = good_params(method);
    const auto line = damaged(to_text(message), random);
    auto [id, request] = parse_request(line);
    if (request) {
      ++requests;
      ASSERT_FALSE(check_params(*request->method, request->params)) << line;
      continue;
    }
    const auto answer = json::parse(answer_line(id, tl::unexpected(std::move(request.error()))));
    ASSERT_EQ(answer.at("jsonrpc"), "2.0") << line;
    ASSERT_LT(answer.at("error").at("code").as_int64(), 0) << line;
    ASSERT_EQ(answer.at("error").at("data").at("outcome"), "not_sent") << line;
  }
  EXPECT_GT(requests, 0);  // some damage does no harm
}

// ---- errors as JSON ----------------------------------------------------------------------------

TEST(DaemonError, HasTheCodeOfItsNameAndOfWhatItAsksFor) {
  const auto code = [](const Error& error) { return to_json(error).at("code").as_int64(); };
  const auto of_library = [&](tmcl::Errc of) { return code(call_error(tmcl::not_sent(of, ""))); };
  EXPECT_EQ(code(failed("parse_error", "")), -32700);
  EXPECT_EQ(code(failed("line_too_long", "")), -32700);
  EXPECT_EQ(code(failed("invalid_request", "")), -32600);
  EXPECT_EQ(code(failed("method_not_found", "")), -32601);
  EXPECT_EQ(code(failed("internal_error", "")), -32603);
  EXPECT_EQ(code(failed("too_many_requests", "")), -32001);
  EXPECT_EQ(code(failed("daemon_ending", "")), -32002);
  EXPECT_EQ(code(failed("not_stopped", "")), -32000);
  EXPECT_EQ(code(not_now("moving", "")), -32003);
  EXPECT_EQ(code(not_now("daemon_ending", "")), -32003) << "to a request by HTTP";
  EXPECT_EQ(code(param_error("out_of_range", "p", "")), -32602);
  EXPECT_EQ(code(param_error("moving", "p", "")), -32602);
  EXPECT_EQ(of_library(tmcl::Errc::bad_argument), -32602);
  EXPECT_EQ(of_library(tmcl::Errc::beyond_soft_limit), -32602);
  EXPECT_EQ(of_library(tmcl::Errc::leased), -32003);
  EXPECT_EQ(of_library(tmcl::Errc::daemon_ending), -32002);
  EXPECT_EQ(of_library(tmcl::Errc::move_interrupted), -32000);
  auto of_journey = failed("daemon_ending", "");
  of_journey.subject["run"] = json::object();
  EXPECT_EQ(code(of_journey), -32000) << "it had begun";
}

TEST(DaemonError, IsTheSameForItsClient) {
  std::vector<Error> all{failed("not_stopped", "m", "h"), failed("daemon_ending", "m"),
                         not_now("moving", "m"), param_error("unknown_axis", "axis", "m"),
                         param_error("no_path", "axes", "m")};
  for (int i = 0; i <= static_cast<int>(tmcl::Errc::out_of_range); ++i)
    all.push_back(call_error(tmcl::not_sent(static_cast<tmcl::Errc>(i), "m"), "x"));
  for (const auto& error : all) {
    const auto read = tmcl::client::error_from_json(to_json(error));
    EXPECT_EQ(read.kind, error.kind) << error.name;
    EXPECT_EQ(read.name, error.name);
    EXPECT_EQ(read.outcome, error.outcome) << error.name;
    EXPECT_EQ(read.hint, error.hint) << error.name;
    EXPECT_EQ(read.subject, tmcl::client::without_nulls(error).subject) << error.name;
  }
}

// ---- how long an answer is ---------------------------------------------------------------------

std::string request_line(const json::value& id, std::string_view method, json::object params) {
  return to_text({{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", params}});
}

/// What a line gets for an answer that is an error.
std::string answer_to_line(const std::string& line) {
  auto [id, request] = parse_request(line);
  if (request) return "";
  return answer_line(id, tl::unexpected(std::move(request.error())));
}

/// Letters of one byte, of several, and such as JSON writes with six.
std::string long_text(std::size_t bytes, std::mt19937_64& random) {
  static constexpr std::array<std::string_view, 4> letters{"a", "\x01", "\"", "\u20ac"};
  const auto letter = letters[random() % letters.size()];
  std::string text;
  while (text.size() + letter.size() <= bytes) text += letter;
  return text + std::string(bytes - text.size(), 'b');
}

std::vector<std::size_t> lengths(std::mt19937_64& random) {
  std::vector<std::size_t> all;
  for (std::size_t n = 0; n <= 300; ++n) all.push_back(n);
  for (std::size_t n = 0; n <= 300; ++n) all.push_back(max_line_bytes - n);
  for (int i = 0; i < tmcl::test::rounds(300); ++i) all.push_back(random() % max_line_bytes);
  return all;
}

TEST(DaemonAnswer, FitsALineHoweverLongTheIdIs) {
  std::mt19937_64 random(tmcl::test::seed());
  for (const auto length : lengths(random)) {
    const json::value id(long_text(length, random));
    const auto line = answer_line(id, json::object{{"value", 7}});
    ASSERT_LT(line.size(), max_answer_bytes);
    const auto answer = json::parse(line);
    ASSERT_EQ(answer.at("id"), length <= max_id_bytes ? id : json::value(nullptr)) << length;
    ASSERT_EQ(answer.at("result").at("value"), 7);

    const auto parsed = parse_request(request_line(id, "bus.list", {}));
    ASSERT_EQ(parsed.request.has_value(), length <= max_id_bytes) << length;
    if (parsed.request) continue;
    ASSERT_TRUE(parsed.id.is_null());
    ASSERT_EQ(parsed.request.error().name, "invalid_request");
  }
}

TEST(DaemonAnswer, FitsALineHoweverLongAClientsWordsAre) {
  std::mt19937_64 random(tmcl::test::seed());
  for (const auto length : lengths(random)) {
    const auto word = long_text(length, random);
    // Lines of all four forms would take four times as long.
    const auto line = [&, form = random() % 4] {
      if (form == 0) return to_text({{"jsonrpc", "2.0"}, {"id", 1}, {word, 1}});
      if (form == 1) return request_line(1, word, {});
      if (form == 2) return request_line(1, "bus.scan", {{word, 1}});
      return request_line(1, "module.execute", {{"bus", word}, {"address", word}});
    }();
    const auto answer = json::parse(answer_to_line(line));
    ASSERT_TRUE(answer.at("error").at("message").is_string()) << length;
    ASSERT_LT(to_text(answer.as_object()).size(), 24 * max_error_text_bytes);
  }
}

TEST(DaemonAnswer, ThatDoesNotFitSaysWhatIsKnownOfTheCall) {
  const json::object much{{"much", std::string(max_answer_bytes, 'a')}};
  const auto error_in = [](const std::string& line) {
    EXPECT_LT(line.size(), 1000U);
    const auto answer = json::parse(line);
    EXPECT_EQ(answer.at("id"), 1);
    EXPECT_EQ(answer.at("error").at("data").at("name"), "answer_too_long");
    return answer.at("error").at("data").at("outcome");
  };
  using tmcl::Effect;
  EXPECT_EQ(error_in(answer_line(1, much)), "done");
  for (const auto effect : {Effect::writes, Effect::moves, Effect::stops})
    EXPECT_EQ(error_in(answer_line(1, much, effect)), "unknown");
  auto error = failed("reply_timeout", "no answer");
  error.outcome = tmcl::Outcome::refused;
  error.subject["problems"] = much;
  EXPECT_EQ(error_in(answer_line(1, tl::unexpected(error), Effect::moves)), "refused");
}

TEST(DaemonAnswer, ShortensTextBetweenLetters) {
  std::string euros;
  while (euros.size() < 2 * max_error_text_bytes) euros += "\u20ac";
  for (const std::string before : {"", "a", "ab"}) {
    const auto error = failed("any", before + euros, before + euros);
    EXPECT_LE(error.message.size(), max_error_text_bytes);
    EXPECT_GT(error.message.size(), max_error_text_bytes - 4);
    EXPECT_TRUE(error.message.ends_with("\u20ac..."));
    EXPECT_EQ(error.message, error.hint);
  }
}

}  // namespace
}  // namespace tmcld
