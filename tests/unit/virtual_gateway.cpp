#include "unit/virtual_gateway.hpp"

#include <csignal>
#include <stdexcept>
#include <utility>

#include <unistd.h>

#include "async/spawn.hpp"
#include "log/log.hpp"

namespace tmcld::test {

VirtualGateway::VirtualGateway(const std::string& toml) {
  silence_log();
  std::signal(SIGPIPE, SIG_IGN);
  wire.modules.emplace(std::uint8_t{1}, FakeModule(1));
  wire.delay = {};
  const auto config = parse_config("[daemon]\nsocket = \"/none\"\n" + toml);
  if (!config) throw std::runtime_error(config.error().front().message);
  GatewayOptions options;
  options.open_link = [this](const BusConfig&) {
    auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
    wire.plug_in(context_.get_executor(), ::dup(ends->second.descriptor()));
    return tmcl::Result<tmcl::Link>(std::move(ends->first));
  };
  options.audit = [this](const AuditEntry& entry) { audited.push_back(entry.text); };
  gateway_ = Gateway::create(context_.get_executor(), *config, std::move(options));
  gateway_->start();
  time.run_for(std::chrono::seconds(1));
}

VirtualGateway::~VirtualGateway() {
  gateway_->close();
  wire.unplug();
  time.settle();
}

Result<boost::json::object> VirtualGateway::call(std::string_view method, json::object params) {
  return std::move(call_together(1, method, std::move(params)).front());
}

std::vector<Result<boost::json::object>> VirtualGateway::call_together(std::size_t count,
                                                                       std::string_view method,
                                                                       const json::object& params) {
  std::vector<Result<boost::json::object>> results;
  for (std::size_t i = 0; i < count; ++i) begin_call(method, params, results);
  if (!time.run_while_not([&] { return results.size() == count; }, std::chrono::hours(1)))
    throw std::runtime_error("no answer");
  return results;
}

void VirtualGateway::begin_call(std::string_view method, const json::object& params,
                                std::vector<Result<boost::json::object>>& into) {
  RpcRequest request{1, find_method(method), params};
  request.lease = take_lease_key(*request.method, request.params).value();
  request.sent_at = take_sent_at(*request.method, request.params).value();
  spawn(context_.get_executor(), carry_out(peer(), std::move(request), into));
}

std::shared_ptr<Peer> VirtualGateway::peer() {
  auto& peer = peers_[client.number];
  if (!peer) peer = std::make_shared<NobodySubscribes>(*this, client);
  return peer;
}

boost::asio::awaitable<void> VirtualGateway::carry_out(
    std::shared_ptr<Peer> peer, RpcRequest request,
    std::vector<Result<boost::json::object>>& into) {
  auto result = co_await dispatch(gateway_, std::move(peer), std::move(request));
  into.push_back(std::move(result));
}

}  // namespace tmcld::test
