/// Two axes of a simulated TMCM-6212 behind a cable that can be cut, in virtual time.
#pragma once

#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/json/serialize.hpp>

#include "api/dispatch.hpp"
#include "config/load.hpp"
#include "gateway/gateway.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/cable_config.hpp"
#include "world/wire.hpp"
#include "world/world_peer.hpp"

namespace tmcld::test {

namespace ap = tmcl::axis_parameter;

class CableBench {
 public:
  explicit CableBench(const std::string& config = cable_config,
                      std::string_view model = "TMCM-6212",
                      tmcl::Framing framing = tmcl::Framing::serial,
                      const tmcl::sim::ModuleSettings& settings = {});
  ~CableBench();
  CableBench(const CableBench&) = delete;
  CableBench& operator=(const CableBench&) = delete;
  void start_gateway(const std::string& journal = {}, const std::string& deadmen = {});
  /// Of a host that tmcld knows nothing of.
  void other_master(const tmcl::Request& request);
  void client_leaves() { gateway_->remove_client(peer_->number); }
  Gateway& gateway() { return *gateway_; }
  /// Gives the client that has called until now, which stays.
  std::shared_ptr<WorldPeer> be_another_client();
  void be(std::shared_ptr<WorldPeer> client) { peer_ = std::move(client); }
  /// It sends nothing any more.
  void end_gateway();

  using Answer = std::shared_ptr<std::optional<Result<boost::json::object>>>;

  Answer begin(std::string_view method, json::object params);
  Result<boost::json::object> end(const Answer& answer);
  Result<boost::json::object> call(std::string_view method, json::object params) {
    return end(begin(method, std::move(params)));
  }
  Answer begin_path();

  std::int32_t get(std::uint8_t motor, std::uint8_t parameter);
  double mm(std::uint8_t motor) { return get(motor, ap::actual_position) / (51'200 / 5.0); }
  /// Whether any axis of the module does.
  bool moves();
  /// Looks each millisecond: behind a cut cable the next timer may end long after the axes stand.
  tmcl::Duration time_to_stand();
  std::string name_of_error(const Result<boost::json::object>& result);

 private:
  boost::asio::io_context context_{1};

 public:
  tmcl::VirtualTime time{context_};

 private:
  Trace trace_;
  Config config_;

 public:
  Wire wire;
  std::vector<std::string> stopped;
  std::vector<std::string> orphans;
  std::vector<std::string> events;
  std::vector<std::string> logged;
  std::vector<std::string> audited;
  tmcl::sim::Module& module;

 private:
  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<WorldPeer> peer_ = std::make_shared<WorldPeer>(trace_);
};

class Cable : public testing::Test, public CableBench {
 protected:
  using CableBench::CableBench;
};

}  // namespace tmcld::test
