/// What the M words of a path switch: outputs of modules, by the configuration.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include <boost/asio/awaitable.hpp>

#include "config/config.hpp"
#include "gateway/authority/run_options.hpp"
#include "gateway/bus.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcld {

class Gateway;

/// How a program of G-code is read by this configuration.
tmcl::plan::path_file::GcodeSetup setup_of(const PathConfig& path);

class PathWords {
 public:
  PathWords() = default;
  /// As the gateway is configured now.
  explicit PathWords(const Gateway& gateway);

  /// What a word switches, such as "bench:1 output 0 1"; empty if it switches nothing.
  std::string what_switches(int word) const;
  /// Nothing for a word that switches nothing. Errors: those of a command; the message names the
  /// output.
  boost::asio::awaitable<tmcl::Result<void>> carry_out(int word, RunOptions options) const;

 private:
  struct Switch {
    std::shared_ptr<GatewayBus> bus;
    OutputSetting output;
  };
  std::map<std::uint8_t, Switch> switches_;
};

}  // namespace tmcld
