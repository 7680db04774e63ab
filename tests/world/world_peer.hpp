/// A client of a gateway in the same process, that only leaves its trace.
#pragma once

#include <cstdint>
#include <string_view>

#include <boost/json/object.hpp>

#include "api/peer.hpp"
#include "api/subscriptions.hpp"
#include "world/trace.hpp"

namespace tmcld::test {

namespace json = boost::json;

class WorldPeer final : public Peer {
 public:
  explicit WorldPeer(Trace& trace) : trace_(&trace) {}
  void notify(std::string_view method, json::object) override { trace_->add(method); }
  bool is_gone() const override { return false; }
  Subscriptions& subscriptions() override { return subscriptions_; }
  Client client() const override { return {number, "client"}; }

  std::uint64_t number = 0;
  bool has_ended = false;

 private:
  Trace* trace_;
  Subscriptions subscriptions_{[] {}};
};

}  // namespace tmcld::test
