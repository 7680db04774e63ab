/// A client at which calls fail by an exception.
#pragma once

#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "api/dispatch.hpp"
#include "async/spawn.hpp"
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
inline Result<boost::json::object> dispatch_for(TestDaemon& daemon, std::shared_ptr<Peer> peer,
                                                const std::string& method,
                                                const json::object& params) {
  const json::object message{{"jsonrpc", "2.0"}, {"id", 1}, {"method", method}, {"params", params}};
  auto request = parse_request(json::serialize(message)).request;
  if (!request) return tl::unexpected(request.error());
  std::optional<Result<boost::json::object>> result;
  spawn(daemon.daemon().context().get_executor(),
        [](auto call,
           std::optional<Result<boost::json::object>>& into) -> boost::asio::awaitable<void> {
          auto given = co_await std::move(call);
          into = std::move(given);
        }(dispatch(daemon.daemon().gateway().shared_from_this(), std::move(peer),
                                                             std::move(*request)),
                                                             result));
  if (!daemon.eventually([&] { return result.has_value(); })) throw std::runtime_error("no answer");
  return std::move(*result);
}

}  // namespace tmcld::test
