#include "world/cable.hpp"

#include <csignal>
#include <utility>

#include "async/spawn.hpp"
#include "log/log.hpp"
#include "support/no_events.hpp"

namespace tmcld::test {

CableBench::CableBench(const std::string& config, std::string_view model, tmcl::Framing framing,
                       const tmcl::sim::ModuleSettings& settings)
    : config_(parse_config(config).value()),
      wire(context_, "bench", framing, 1, {}, trace_),
      module(wire.bench().add(*tmcl::find_model(model), tmcl::ModuleAddress{1}, settings)) {
  std::signal(SIGPIPE, SIG_IGN);
  silence_log();
  start_gateway();
  for (const char* axis : {"x", "y"}) {
    for (const auto& [parameter, value] : {std::pair{4, 240'000}, {5, 4'999'922}, {17, 4'999'922}})
      call("parameter.set", {{"axis", axis}, {"parameter", parameter}, {"value", value}});
  }
}

CableBench::~CableBench() {
  gateway_->close();
  time.run_for(std::chrono::seconds(10));
}

void CableBench::start_gateway(const std::string& journal, const std::string& deadmen) {
  GatewayOptions options;
  options.open_link = [this](const BusConfig&) { return wire.open(); };
  options.journal = journal;
  options.deadmen = deadmen;
  options.log = [this](LogLevel, std::string_view line) { logged.emplace_back(line); };
  options.audit = [this](const AuditEntry& entry) { audited.push_back(entry.text); };
  gateway_ = Gateway::create(context_.get_executor(), config_, std::move(options));
  gateway_->on_event([this](const GatewayEvent& event) {
    if (event.kind == GatewayEvent::Kind::axis_stopped) stopped.push_back(event.text);
    if (event.kind == GatewayEvent::Kind::orphan_stopped) orphans.push_back(event.text);
    events.emplace_back(name_of(event.kind));
  });
  peer_->number = gateway_->add_client("client").number;
  gateway_->start();
  time.run_for(std::chrono::seconds(1));
}

void CableBench::other_master(const tmcl::Request& request) {
  tmcl::test::NoEvents nobody;
  module.execute(request, tmcl::sim::Medium::serial, nobody);
  wire.touch();
}

std::shared_ptr<WorldPeer> CableBench::be_another_client() {
  auto before = std::exchange(peer_, std::make_shared<WorldPeer>(trace_));
  peer_->number = gateway_->add_client("client").number;
  return before;
}

void CableBench::end_gateway() {
  gateway_->close();
  time.run_for(std::chrono::milliseconds(100));
}

CableBench::Answer CableBench::begin(std::string_view method, json::object params) {
  auto answer = std::make_shared<std::optional<Result<boost::json::object>>>();
  auto carry_out = [](auto gateway, auto peer, RpcRequest request,
                      Answer into) -> boost::asio::awaitable<void> {
    auto result = co_await dispatch(std::move(gateway), std::move(peer), std::move(request));
    *into = std::move(result);
  };
  const RpcRequest request{1, find_method(method), std::move(params)};
  spawn(context_.get_executor(), carry_out(gateway_, peer_, request, answer));
  return answer;
}

Result<boost::json::object> CableBench::end(const Answer& answer) {
  EXPECT_TRUE(time.run_while_not([&] { return answer->has_value(); }, std::chrono::hours(1)));
  return std::move(**answer);
}

CableBench::Answer CableBench::begin_path() {
  const auto path = begin("path.run", {{"axes", json::array{"x", "y"}},
                                       {"text", "G1 X20 Y10 F1200\nG1 X900 Y0\n"},
                                       {"deviation", 900}});
  EXPECT_TRUE(time.run_while_not([&] { return mm(0) > 12; }, std::chrono::minutes(1)));
  return path;
}

std::int32_t CableBench::get(std::uint8_t motor, std::uint8_t parameter) {
  wire.bench().run_due();
  return *module.axis(motor).get(parameter);
}

bool CableBench::moves() {
  for (std::uint8_t motor = 0; motor < module.model().axes; ++motor) {
    if (get(motor, ap::actual_velocity) != 0) return true;
  }
  return false;
}

tmcl::Duration CableBench::time_to_stand() {
  const auto began = time.now();
  const auto limit = began + std::chrono::minutes(1);
  while (moves() && time.now() < limit) time.run_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(moves());
  return time.now() - began;
}

std::string CableBench::name_of_error(const Result<boost::json::object>& result) {
  return result ? "none" : result.error().name;
}

}  // namespace tmcld::test
