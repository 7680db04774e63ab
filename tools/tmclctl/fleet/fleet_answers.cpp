#include "fleet/fleet_answers.hpp"

#include <algorithm>

#include <boost/json/array.hpp>

#include "output/print.hpp"

namespace tmclctl {

namespace json = boost::json;

void FleetAnswers::fail(const std::string& gateway, const Error& error, const std::string& axis) {
  exit_ = std::max(exit_, exit_code_of(error));
  if (axis.empty()) {
    document_of(gateway)["error"] = error_document(error);
  } else {
    add_axis(gateway, {{"axis", axis}, {"error", error_document(error)}});
  }
  auto& output = fleet_.output;
  if (output.json) return;
  output.out.flush();
  const auto where = axis.empty() ? gateway : gateway + ' ' + axis;
  output.err << "tmclctl: " << alarming(where + ": " + error.message, output.err_screen)
             << std::endl;
}

void FleetAnswers::add_axis(const std::string& gateway, json::object row) {
  auto& axes = document_of(gateway)["axes"];
  if (!axes.is_array()) axes = json::array();
  axes.get_array().push_back(std::move(row));
}

json::object& FleetAnswers::document_of(const std::string& gateway) {
  return documents_.try_emplace(gateway, json::object{{"gateway", gateway}}).first->second;
}

std::vector<std::string> FleetAnswers::askable() {
  std::vector<std::string> names;
  for (const auto& [name, gateway] : fleet_.gateways.all()) {
    if (gateway.online) {
      names.push_back(name);
    } else {
      fail(name, gateway_away(name, tmcl::Outcome::not_sent));
    }
  }
  return names;
}

Result<ExitCode> FleetAnswers::ask(const std::string& role, std::vector<FleetCall> calls,
                                   const OnResult& on_result, tmcl::Duration patience) {
  const auto called = fleet_.call(
      role, std::move(calls),
      [&](const FleetCall& call, const Result<json::object>& result) {
        if (result) return on_result(call, *result);
        fail(call.gateway, result.error(), call.axis);
      },
      patience);
  if (!called) return tl::unexpected(called.error());
  return end();
}

ExitCode FleetAnswers::end() {
  if (!fleet_.output.json) return exit_;
  json::array gateways;
  for (auto& [name, document] : documents_) gateways.push_back(std::move(document));
  print_json({{"gateways", std::move(gateways)}}, fleet_.output);
  return exit_;
}

}  // namespace tmclctl
