/// A gateway in the test's own process and thread, with one bus in memory, in virtual time.
#pragma once

#include "api/local_gateway.hpp"
#include "unit/daemon_path_fixture.hpp"

namespace tmcld::test {

using namespace std::chrono_literals;

class LocalBench {
 public:
  explicit LocalBench(
      const std::string& toml = two_axes(),
      const std::shared_ptr<VirtualReactor>& reactor = std::make_shared<VirtualReactor>())
      : reactor_(reactor), config_(parsed(toml)) {
    wire.modules.emplace(std::uint8_t{1}, FakeModule(1));
  }
  ~LocalBench() {
    wire.unplug();
    gateway_.reset();
  }

  /// Empty if that worked.
  std::string open(GatewayOptions options = {}) {
    int far = -1;
    options.open_link = [&](const BusConfig&) -> tmcl::Result<tmcl::Link> {
      if (wire.is_absent) return tl::unexpected(tmcl::bad_argument(wire.why_absent));
      auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
      far = ::dup(ends->second.descriptor());
      return std::move(ends->first);
    };
    auto gateway = LocalGateway::open(config_, std::move(options), context());
    if (!gateway) return gateway.error().message;
    gateway_ = std::move(*gateway);
    wire.plug_in(gateway_->gateway().buses().front()->executor(), far);
    return {};
  }

  LocalGateway& local() { return *gateway_; }
  tmcl::TimePoint now() const { return reactor_->time.now(); }
  /// What a call gives that must not fail.
  json::object result(std::string_view method, json::object params) {
    const auto answer = local().call(method, std::move(params));
    if (!answer) throw std::runtime_error(answer.error().message);
    return *answer;
  }
  std::string error(std::string_view method, json::object params) {
    const auto answer = local().call(method, std::move(params));
    return answer ? "none" : answer.error().name;
  }

  FakeWire wire;

 private:
  std::shared_ptr<boost::asio::io_context> context() const {
    return {reactor_, &reactor_->context};
  }
  static Config parsed(const std::string& toml) {
    const auto config = parse_config("[daemon]\nsocket = \"unused\"\n" + toml);
    if (!config) throw std::runtime_error(config.error().front().message);
    return *config;
  }

  std::shared_ptr<VirtualReactor> reactor_;
  Config config_;
  std::unique_ptr<LocalGateway> gateway_;
};

}  // namespace tmcld::test
