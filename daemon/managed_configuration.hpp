/// The file of the configuration that clients may set, and a daemon that goes by it.
#pragma once

#include <string>

#include "api/configuration_keeper.hpp"

namespace tmcld {

class Daemon;

class ManagedConfiguration final : public ConfigurationKeeper {
 public:
  /// It must outlive every call.
  explicit ManagedConfiguration(Daemon& daemon) : daemon_(daemon) {}

  boost::asio::awaitable<Result<tmcl::api::configuration::Managed>> get() override;
  boost::asio::awaitable<Result<tmcl::api::configuration::Taken>> set(
      tmcl::api::configuration::Set wish, Client client) override;

 private:
  struct Next;

  /// Empty: none.
  std::string file() const;
  boost::asio::awaitable<Result<Next>> read(std::string toml) const;
  boost::asio::awaitable<Result<std::string>> foresee(Next next) const;
  boost::asio::awaitable<Result<std::string>> carry_out(Next next, Client client) const;

  Daemon& daemon_;
};

}  // namespace tmcld
