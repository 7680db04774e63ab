#include "unit/ctl_bench.hpp"

#include <csignal>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <unistd.h>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>

#include "api/dispatch.hpp"
#include "api/local_channel.hpp"
#include "api/subscriptions.hpp"
#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "config/load.hpp"
#include "sim/bench.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/ports/socket_port.hpp"
#include "support/no_events.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmclctl::test {

namespace sim = tmcl::sim;

std::string axis_section(const std::string& name, int address, int motor, const std::string& more) {
  return fmt::format("[[axis]]\nname = \"{}\"\nbus = \"bench\"\naddress = {}\nmotor = {}\n{}", name,
                     address, motor, more);
}

namespace {

using Answer = Result<boost::json::object>;

constexpr std::uint32_t bits_per_second = 115'200;

/// As a client on a connection of its own.
class OtherClient final : public tmcld::Peer {
 public:
  explicit OtherClient(const std::shared_ptr<tmcld::Gateway>& gateway)
      : client_(gateway->add_client("other")) {}
  void notify(std::string_view, boost::json::object) override {}
  bool is_gone() const override { return false; }
  tmcld::Subscriptions& subscriptions() override { return subscriptions_; }
  tmcld::Client client() const override { return client_; }

 private:
  tmcld::Client client_;
  tmcld::Subscriptions subscriptions_{[] {}};
};

boost::asio::awaitable<void> carry_out(std::shared_ptr<tmcld::Gateway> gateway,
                                       std::shared_ptr<tmcld::Peer> peer, tmcld::RpcRequest request,
                                       tmcl::Duration after,
                                       std::shared_ptr<std::optional<Answer>> answer) {
  if (after > tmcl::Duration{}) co_await tmcld::rest(after);
  auto result = co_await tmcld::dispatch(std::move(gateway), std::move(peer), std::move(request));
  answer->emplace(std::move(result).map_error(tmcl::client::without_nulls));
}

boost::asio::awaitable<void> let_happen(tmcl::Duration after, std::function<void()> event) {
  co_await tmcld::rest(after);
  event();
}

std::uint8_t number_of(std::string_view parameter, const sim::Module& module) {
  const auto* row = tmcl::find_parameter(tmcl::axis_parameters(module.model()), parameter);
  if (row == nullptr) throw std::runtime_error("no parameter " + std::string(parameter));
  return row->number;
}

Error lost_connection() {
  return {std::string(tmcl::client::error_name::lost), ErrorKind::failed, tmcl::Outcome::not_sent,
          "tmcld has gone", ""};
}

}  // namespace

class CtlBench::World final : public FakeHost, public std::enable_shared_from_this<World> {
 public:
  World(std::string toml, const char* model) : toml_(std::move(toml)) {
    std::signal(SIGPIPE, SIG_IGN);
    add(model, 1);
  }
  ~World() override { close(); }

  tmcl::TimePoint now() const override { return time_.now(); }
  /// A signal ends it.
  void sleep(tmcl::Duration duration) override {
    const auto until = now() + duration;
    time_.run_while_not([this] { return signal() != 0; }, until - now());
    if (signal() == 0 && now() < until) time_.run_until(std::min(until, signal_time()));
  }

  sim::Module& add(std::string_view model, std::uint8_t address) {
    auto& module = table_.add(*tmcl::find_model(model), tmcl::ModuleAddress{address});
    modules_[address] = &module;
    return module;
  }
  sim::Module& module(std::uint8_t address) { return *modules_.at(address); }
  std::int32_t execute(const tmcl::Request& request) {
    auto& one = module(static_cast<std::uint8_t>(request.address));
    one.run_due();
    const auto answer = one.execute(request, sim::Medium::serial, events_);
    if (answer.status != tmcl::Status::ok)
      throw std::runtime_error(
          fmt::format("command {} is refused", static_cast<int>(request.command)));
    scheduler_.touch();
    return answer.value;
  }

  tmcld::LocalChannel& channel() {
    if (!channel_) open();
    return *channel_;
  }
  void close() {
    channel_.reset();
    lines_.clear();
    time_.settle();
  }
  void cut_wires(std::string why, const std::string& bus) {
    why_no_wires_ = std::move(why);
    if (bus.empty()) {
      lines_.clear();
    } else {
      lines_.erase(bus);
    }
    time_.settle();
  }
  void after(tmcl::Duration duration, std::function<void()> event) {
    tmcld::spawn(context_->get_executor(), let_happen(duration, std::move(event)));
  }
  std::shared_ptr<std::optional<Answer>> begin(tmcl::Duration after, std::string_view method,
                                               boost::json::object params) {
    const auto gateway = channel().local().gateway().shared_from_this();
    if (!other_) other_ = std::make_shared<OtherClient>(gateway);
    auto request = tmcld::make_request(method, std::move(params));
    if (!request) throw std::runtime_error(request.error().message);
    request->id = 1;
    auto answer = std::make_shared<std::optional<Answer>>();
    tmcld::spawn(context_->get_executor(),
                 carry_out(gateway, other_, std::move(*request), after, answer));
    return answer;
  }
  void run_until(const std::function<bool()>& condition) {
    if (!time_.run_while_not(condition, std::chrono::hours(1)))
      throw std::runtime_error("no answer within an hour");
  }

 private:
  void open() {
    const auto config = tmcld::parse_config("[daemon]\nsocket = \"/none\"\n" + toml_);
    if (!config) throw std::runtime_error(config.error().front().message);
    tmcld::GatewayOptions options;
    options.open_link = [this](const tmcld::BusConfig& bus) { return plug_in(bus); };
    auto local = tmcld::LocalGateway::open(*config, std::move(options), context_);
    if (!local) throw std::runtime_error(local.error().message);
    channel_ = std::make_unique<tmcld::LocalChannel>(std::move(*local), "1.0",
                                                     [this] { return signal() != 0; });
  }
  tmcl::Result<tmcl::Link> plug_in(const tmcld::BusConfig& bus) {
    if (!why_no_wires_.empty()) {
      tmcl::Error error;
      error.code = tmcl::Errc::link_open_failed;
      error.message = why_no_wires_;
      return tl::unexpected(std::move(error));
    }
    const bool is_can = std::holds_alternative<tmcl::CanName>(bus.link);
    auto ends = tmcl::Link::memory_pair(is_can ? tmcl::Framing::can : tmcl::Framing::serial);
    tmcl::FileDescriptor far(::dup(ends->second.descriptor()));
    const sim::Pace pace{is_can ? 1'000'000 : bits_per_second, sim::usual_time_to_answer};
    sim::SerialWire wire;
    wire.pace = pace;
    wire.echoes = echoes;
    lines_[bus.name] = is_can
                           ? sim::serve_can_socket(*context_, scheduler_, std::move(far), pace)
                           : sim::serve_serial_socket(*context_, scheduler_, std::move(far), wire);
    return std::move(ends->first);
  }

  std::string toml_;
  std::shared_ptr<boost::asio::io_context> context_ = std::make_shared<boost::asio::io_context>(1);
  tmcl::VirtualTime time_{*context_};
  tmcl::ContextClock clock_{*context_};
  tmcl::test::NoEvents events_;
  sim::Bench table_{clock_};
  sim::Scheduler scheduler_{*context_, table_};
  std::map<std::uint8_t, sim::Module*> modules_;
  std::string why_no_wires_;
  std::map<std::string, std::unique_ptr<sim::Port>> lines_;  ///< By their buses.
  std::shared_ptr<OtherClient> other_;
  std::unique_ptr<tmcld::LocalChannel> channel_;

 public:
  /// By their methods; "" for all of them.
  std::map<std::string, Error, std::less<>> failures;
  std::map<std::string, std::function<void(boost::json::object&)>, std::less<>> changes;
  std::vector<std::string>* calls = nullptr;
  tmcl::client::Channel::Listener listener;
  bool echoes = false;
  bool is_lost = false;
  int away_for = 0;
};

namespace {

/// No verb takes so long: an axis that never arrives is waited for without end.
constexpr tmcl::TimePoint end_of_tests{std::chrono::hours(24)};

/// The channel of a gateway in this process, and what the test lets become of it.
template <class World>
class BenchChannel final : public tmcl::client::Channel {
 public:
  explicit BenchChannel(std::shared_ptr<World> world) : world_(std::move(world)) {}

  Answer call(std::string_view method, boost::json::object params,
              const tmcl::client::CallOptions& options) override {
    if (world_->now() > end_of_tests) throw std::runtime_error("tmclctl does not end by itself");
    world_->calls->push_back(std::string(method) + ' ' + boost::json::serialize(params));
    for (const auto wanted : {method, std::string_view()}) {
      const auto failure = world_->failures.find(wanted);
      if (failure != world_->failures.end()) return tl::unexpected(failure->second);
    }
    auto answer = channel().call(method, std::move(params), options);
    const auto change = world_->changes.find(method);
    if (answer && change != world_->changes.end()) change->second(*answer);
    return answer;
  }
  Result<void> listen(tmcl::Duration at_most) override {
    if (std::exchange(world_->is_lost, false)) {
      channel().local().hang_up();
      return tl::unexpected(lost_connection());
    }
    return channel().listen(at_most);
  }
  void on_notification(Listener listener) override {
    channel().on_notification(std::move(listener));
  }
  Result<void> reopen() override {
    if (world_->away_for-- > 0) return tl::unexpected(lost_connection());
    return channel().reopen();
  }
  std::string version() const override { return {}; }

 private:
  tmcld::LocalChannel& channel() { return world_->channel(); }

  std::shared_ptr<World> world_;
};

}  // namespace

CtlBench::CtlBench(std::string toml, const char* model)
    : world_(std::make_shared<World>(std::move(toml), model)),
      host(*world_),
      gateway{tmcl::client::Caller(std::make_unique<BenchChannel<World>>(world_))} {
  world_->calls = &calls;
}

CtlBench::~CtlBench() { world_->close(); }

ExitCode CtlBench::run(const std::vector<std::string>& arguments) {
  std::ostringstream out_stream;
  std::ostringstream err_stream;
  Output output{out_stream, err_stream, screen, screen};
  output.gateway = " --direct can:can0";
  const auto exit = tmclctl::run(arguments, output, host, gateway);
  out = out_stream.str();
  err = err_stream.str();
  return exit;
}

boost::json::object CtlBench::json(std::vector<std::string> arguments, ExitCode expected) {
  arguments.insert(arguments.begin(), "--json");
  const auto exit = run(arguments);
  if (exit != expected) throw std::runtime_error("unexpected exit code; output: " + out + err);
  return boost::json::parse(out).as_object();
}

std::vector<std::string> CtlBench::orders() const {
  std::vector<std::string> orders;
  for (const auto& call : calls) {
    const auto* method = tmcld::find_method(call.substr(0, call.find(' ')));
    if (method == nullptr || method->role != tmcld::Role::observe) orders.push_back(call);
  }
  return orders;
}

std::vector<std::string> CtlBench::calls_of(std::string_view method) const {
  std::vector<std::string> found;
  for (const auto& call : calls)
    if (call.substr(0, call.find(' ')) == method) found.push_back(call);
  return found;
}

sim::Module& CtlBench::module(std::uint8_t address) { return world_->module(address); }

sim::Module& CtlBench::add(const char* model, std::uint8_t address) {
  return world_->add(model, address);
}

std::int32_t CtlBench::execute(tmcl::Command command, std::uint8_t type, std::uint8_t motor,
                               std::int32_t value, std::uint8_t address) {
  return world_->execute({tmcl::ModuleAddress{address}, command, type, motor, value});
}

std::int32_t CtlBench::get(std::string_view parameter, std::uint8_t motor, std::uint8_t address) {
  return execute(tmcl::Command::GAP, number_of(parameter, module(address)), motor, 0, address);
}

void CtlBench::set(std::string_view parameter, std::int32_t value, std::uint8_t motor,
                   std::uint8_t address) {
  execute(tmcl::Command::SAP, number_of(parameter, module(address)), motor, value, address);
}

void CtlBench::place(std::int32_t position, std::uint8_t motor) {
  execute(tmcl::Command::MST, 0, motor, 0);
  set("actual_position", position, motor);
  set("target_position", position, motor);
}

void CtlBench::open() { world_->channel(); }

void CtlBench::cut_wires(std::string why, const std::string& bus) {
  world_->cut_wires(std::move(why), bus);
}

void CtlBench::let_lines_echo() { world_->echoes = true; }

void CtlBench::fail(std::string_view method, std::optional<Error> error) {
  world_->failures.erase(std::string(method));
  if (error) world_->failures.emplace(method, std::move(*error));
}

void CtlBench::amend(std::string_view method, std::function<void(boost::json::object&)> change) {
  world_->changes[std::string(method)] = std::move(change);
}

void CtlBench::lose_connection(int away_for) {
  world_->is_lost = true;
  world_->away_for = away_for;
}

void CtlBench::after(tmcl::Duration duration, std::function<void()> event) {
  world_->after(duration, std::move(event));
}

Result<boost::json::object> CtlBench::other(std::string_view method, boost::json::object params) {
  const auto answer = world_->begin({}, method, std::move(params));
  world_->run_until([&] { return answer->has_value(); });
  return **answer;
}

void CtlBench::other_after(tmcl::Duration duration, std::string_view method,
                           boost::json::object params) {
  world_->begin(duration, method, std::move(params));
}

}  // namespace tmclctl::test
