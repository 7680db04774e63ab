// The method table, and the check of parameters that reads it.
#include <fstream>
#include <iterator>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include <boost/json.hpp>

#include "api/json_text.hpp"
#include "api/params.hpp"
#include "api/request.hpp"
#include "support/seed.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;
using testing::HasSubstr;

json::value good_value(const ParamInfo& row) {
  switch (row.type) {
    case FieldType::text: return "word";
    case FieldType::text_or_integer: return row.minimum;
    case FieldType::texts: return json::array{"word"};
    case FieldType::integers:
    case FieldType::numbers: return json::array{0};
    case FieldType::boolean: return true;
    default: return row.minimum;
  }
}

json::object good_params(const MethodInfo& method) {
  json::object params;
  for (const auto& row : method.params) params[row.name] = good_value(row);
  return params;
}

// What a parameter of this type must never be.
std::vector<json::value> bad_values(FieldType type) {
  std::vector<json::value> values{nullptr, json::object{}, 1.5, json::array{1}};
  if (type == FieldType::number) std::erase(values, json::value(1.5));
  const bool is_numbers = type == FieldType::integers || type == FieldType::numbers;
  if (is_numbers) values.back() = json::array{"1"};
  if (type == FieldType::text || type == FieldType::texts || is_numbers) values.push_back(7);
  if (type == FieldType::integer || type == FieldType::texts) values.push_back("7");
  if (type != FieldType::boolean) values.push_back(true);
  return values;
}

TEST(DaemonMethodTable, IsDocumentedAndComplete) {
  std::ifstream file(TMCL_SOURCE_DIR "/docs/PROTOCOL.md");
  const std::string protocol{std::istreambuf_iterator<char>(file), {}};
  std::set<std::string_view> names;
  for (const auto& method : method_table()) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_FALSE(method.summary.empty()) << method.name;
    EXPECT_NE(method.handler, nullptr) << method.name;
    EXPECT_THAT(protocol, HasSubstr("### " + std::string(method.name) + "\n"));
    for (const auto& row : method.params) {
      EXPECT_FALSE(row.summary.empty()) << method.name << " " << row.name;
      EXPECT_THAT(protocol, HasSubstr("`" + std::string(row.name) + "`"));
    }
    for (const auto& row : method.result) {
      EXPECT_FALSE(row.summary.empty()) << method.name << " " << row.name;
      EXPECT_THAT(protocol, HasSubstr("\"" + std::string(row.name) + "\":"));
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
    EXPECT_EQ(error->code, rpc_code::invalid_params);
    EXPECT_EQ(error->data.at("name"), json::string_view(name)) << to_text(params);
    EXPECT_EQ(error->data.at("param"), json::string_view(offender)) << to_text(params);
    EXPECT_EQ(error->data.at("outcome"), "not_sent");
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
      if (row.type != FieldType::integer) continue;
      for (const json::value& value :
           {json::value(row.minimum - 1), json::value(row.maximum + 1), json::value(INT64_MIN),
            json::value(INT64_MAX), json::value(UINT64_MAX), json::value(1e300),
            json::value(-1e300)}) {
        params = good;
        params[row.name] = value;
        expect_offender(method, params, row.name, "out_of_range");
      }
    }
  }
}

TEST(DaemonParams, AreReadAsTheNumbersTheyAre) {
  const Params params({{"a", -7}, {"b", 7U}, {"c", 1e3}, {"d", json::array{"x", "y"}}});
  EXPECT_EQ(params.integer("a"), -7);
  EXPECT_EQ(params.integer("b"), 7);
  EXPECT_EQ(params.integer("c"), 1000);
  EXPECT_EQ(params.integer_or("none", 5), 5);
  EXPECT_THAT(params.texts("d"), testing::ElementsAre("x", "y"));
  EXPECT_THAT(params.texts("none"), testing::IsEmpty());
}

TEST(DaemonJsonText, WritesNumbersAsPeopleDo) {
  EXPECT_EQ(to_text({{"a", 30517.578125}, {"b", 0.0}, {"c", json::array{}}, {"d", "\"\n"}}),
            R"({"a":30517.578125,"b":0,"c":[],"d":"\"\n"})");
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
    auto request = parse_request(line);
    if (request) {
      ++requests;
      ASSERT_FALSE(check_params(*request->method, request->params)) << line;
      continue;
    }
    const auto answer = json::parse(
        answer_line(request.error().id, tl::unexpected(std::move(request.error().error))));
    ASSERT_EQ(answer.at("jsonrpc"), "2.0") << line;
    ASSERT_LT(answer.at("error").at("code").as_int64(), 0) << line;
    ASSERT_EQ(answer.at("error").at("data").at("outcome"), "not_sent") << line;
  }
  EXPECT_GT(requests, 0);  // some damage does no harm
}

}  // namespace
}  // namespace tmcld
