/// What `fleet top` shows: gateways and their axes, by what they have told. Does no I/O.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <boost/json/object.hpp>

#include "broker/message.hpp"
#include "fleet/gateways.hpp"

namespace tmclctl {

class FleetPicture {
 public:
  /// `gateways` outlives it, and goes on hearing births.
  explicit FleetPicture(const Gateways& gateways) : gateways_(gateways) {}

  /// What states and telemetry come by.
  std::vector<std::string> filters() const;
  void hear(const tmclmqtt::Message& message);
  /// The gateways with something wrong first, then those with axes that move. `axes`: each of them
  /// in a line of its own, too. `internal`: as modules count.
  std::vector<std::string> lines(int width, bool axes, bool internal) const;

 private:
  struct Count;
  using States = std::map<std::string, boost::json::object>;  ///< By axis.

  Count count(const std::string& gateway) const;
  std::vector<std::string> lines_of_axes(const std::string& gateway, int width,
                                         bool internal) const;

  const Gateways& gateways_;
  std::map<std::string, States> told_;  ///< By gateway.
};

}  // namespace tmclctl
