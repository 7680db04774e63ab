/// What many gateways answered: told as it comes, or in one document at the end.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <boost/json/object.hpp>

#include "fleet/fleet.hpp"

namespace tmclctl {

/// Of a column.
constexpr std::size_t gateway_width = 16;

class FleetAnswers {
 public:
  using OnResult = std::function<void(const FleetCall& call, const boost::json::object& result)>;

  explicit FleetAnswers(Fleet& fleet) : fleet_(fleet) {}

  /// The gateways that can be asked; tells of the others that they are away.
  std::vector<std::string> askable();
  /// Makes the calls. Errors: broker_lost, cancelled.
  Result<ExitCode> ask(const std::string& role, std::vector<FleetCall> calls,
                       const OnResult& on_result,
                       tmcl::Duration patience = CallRound::usual_patience);
  /// `axis` may be empty.
  void fail(const std::string& gateway, const Error& error, const std::string& axis = {});
  void add_axis(const std::string& gateway, boost::json::object row);
  boost::json::object& document_of(const std::string& gateway);
  /// Prints the document, if one is wanted. The worst of what happened.
  ExitCode end();

 private:
  Fleet& fleet_;
  std::map<std::string, boost::json::object> documents_;
  ExitCode exit_ = ExitCode::done;
};

}  // namespace tmclctl
