/// A client at which calls fail by an exception.
#pragma once

#include <future>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include <boost/asio/co_spawn.hpp>

#include "api/dispatch.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {

/// Takes so many notifications, and throws then.
class ThrowingPeer final : public Peer {
 public:
  explicit ThrowingPeer(int notifications) : left_(notifications) {}
  void notify(std::string_view, json::object) override {
    if (left_-- <= 0) throw std::runtime_error("injected");
  }
  bool is_gone() const override { return false; }
  Subscriptions& subscriptions() override { throw std::bad_alloc(); }

 private:
  int left_;
};

/// What a call gives that comes in past all fronts.
inline RpcResult dispatch_for(TestDaemon& daemon, std::shared_ptr<Peer> peer,
                              const std::string& method, const json::object& params) {
  const json::object message{{"jsonrpc", "2.0"}, {"id", 1}, {"method", method}, {"params", params}};
  auto request = parse_request(json::serialize(message));
  if (!request) return tl::unexpected(request.error().error);
  const auto promise = std::make_shared<std::promise<RpcResult>>();
  auto result = promise->get_future();
  daemon.on_reactor([&] {
    auto call = dispatch(daemon.daemon().gateway().shared_from_this(), std::move(peer),
                         std::move(*request));
    boost::asio::co_spawn(daemon.daemon().context(), std::move(call),
                          [promise](const std::exception_ptr& failure, RpcResult given) {
                            if (failure) return promise->set_exception(failure);
                            promise->set_value(std::move(given));
                          });
    return 0;
  });
  return result.get();
}

}  // namespace tmcld::test
