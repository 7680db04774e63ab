/// What a daemon is to the methods about its configuration.
#pragma once

#include <memory>

#include <boost/asio/awaitable.hpp>

#include "api/error.hpp"
#include "gateway/authority/leases.hpp"
#include "tmcl/api/configuration.hpp"

namespace tmcld {

inline Error not_managed() {
  return not_now(
      "not_managed", "clients cannot set the configuration of this gateway",
      "'managed' in [daemon] of the configuration of a running tmcld names a file for that");
}

class ConfigurationKeeper {
 public:
  virtual ~ConfigurationKeeper() = default;
  virtual boost::asio::awaitable<Result<tmcl::api::configuration::Managed>> get() = 0;
  /// All of it, or nothing.
  virtual boost::asio::awaitable<Result<tmcl::api::configuration::Taken>> set(
      tmcl::api::configuration::Set wish, Client client) = 0;
};

/// A Peer of a daemon's front is one, too.
class ConfigurationPlace {
 public:
  virtual ~ConfigurationPlace() = default;
  /// Null if there is none.
  virtual const std::shared_ptr<ConfigurationKeeper>& configuration() const = 0;
};

}  // namespace tmcld
