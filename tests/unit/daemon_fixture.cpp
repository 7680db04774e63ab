#include "unit/daemon_fixture.hpp"

#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <unistd.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>

#include "log/log.hpp"
#include "tmcl/timer.hpp"

namespace tmcld::test {
namespace {

std::string new_folder() {
  auto name = (std::filesystem::temp_directory_path() / "tmcld-XXXXXX").string();
  return ::mkdtemp(name.data());
}

}  // namespace

class FakeWire::End : public boost::asio::posix::stream_descriptor {
 public:
  using basic_stream_descriptor::basic_stream_descriptor;
};

void FakeWire::plug_in(const boost::asio::any_io_executor& executor, int descriptor) {
  end_ = std::make_shared<End>(executor, descriptor);
  boost::asio::co_spawn(executor, serve(end_), boost::asio::detached);
}

void FakeWire::unplug() {
  if (end_) end_->close();
  end_.reset();
  held.clear();
}

void FakeWire::release() {
  holds = false;
  for (const auto& request : std::exchange(held, {})) answer(request);
}

boost::asio::awaitable<void> FakeWire::serve(std::shared_ptr<End> end) {
  tmcl::SerialBytes bytes{};
  while (true) {
    boost::system::error_code error;
    const auto size = co_await end->async_read_some(
        boost::asio::buffer(bytes), boost::asio::redirect_error(boost::asio::use_awaitable, error));
    if (error) co_return;
    // Half a datagram comes to nothing: modules drop it when the line is silent.
    if (size != bytes.size()) continue;
    const auto request = tmcl::decode_serial_request(bytes);
    if (!request) continue;
    seen.push_back(*request);
    tmcl::Timer timer(end->get_executor());
    timer.expires_after(delay);
    co_await timer.async_wait(boost::asio::use_awaitable);
    if (holds) {
      held.push_back(*request);
    } else {
      answer(*request);
    }
  }
}

void FakeWire::answer(const tmcl::Request& request) {
  const auto module =
      takes_any_address ? modules.begin() : modules.find(tmcl::reply_byte(request.address));
  if (!end_) return;
  boost::system::error_code ignored;
  if (module == modules.end()) {
    boost::asio::write(*end_, boost::asio::buffer(stray_bytes), ignored);
    return;
  }
  auto reply = module->second.execute(request);
  if (request.command == tmcl::Command::GET_FIRMWARE_VERSION && !module->second.play) {
    reply.value = tmcl::to_value({model, 1, 9});
  }
  if (loses && loses(request)) return;
  const auto bytes = tmcl::encode_serial(reply);
  boost::asio::write(*end_, boost::asio::buffer(bytes), ignored);
}

// ---- a daemon ----------------------------------------------------------------------------------

PlayedDaemon::PlayedDaemon(std::shared_ptr<boost::asio::io_context> context,
                           const std::string& toml, WaitForSocket wait)
    : context_(std::move(context)), socket_(new_folder() + "/socket", std::move(wait)) {
  silence_log();
  // As in main().
  std::signal(SIGPIPE, SIG_IGN);
  const auto config = parse_config("[daemon]\nsocket = \"" + socket_.path + "\"\n" + toml);
  if (!config) throw std::runtime_error(config.error().front().message);
  for (const auto& bus : config->buses) {
    wires_[bus.name].modules.emplace(std::uint8_t{1}, FakeModule(1));
  }
  auto daemon = Daemon::create(*context_, *config, [this](const auto& bus) { return open(bus); });
  if (!daemon) throw std::runtime_error(daemon.error());
  daemon_ = std::move(*daemon);
}

PlayedDaemon::~PlayedDaemon() {
  daemon_.reset();
  std::filesystem::remove_all(std::filesystem::path(socket_.path).parent_path());
}

bool PlayedDaemon::is_ready() {
  return std::ranges::all_of(daemon_->gateway().axes(), [](const auto& axis) {
    return axis->module().state() == GatewayModule::State::ready;
  });
}

// Called on the bus' own thread, perhaps while the reactor is ending: it must not be waited for.
tmcl::Result<tmcl::Link> PlayedDaemon::open(const BusConfig& bus) {
  auto& wire = wires_.at(bus.name);
  if (wire.throws) throw std::runtime_error("injected");
  if (wire.is_absent) {
    tmcl::Error error;
    error.code = tmcl::Errc::link_open_failed;
    error.message = wire.why_absent;
    return tl::unexpected(std::move(error));
  }
  auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
  const int far = ::dup(ends->second.descriptor());
  boost::asio::post(*context_, [this, &wire, far] { wire.plug_in(context_->get_executor(), far); });
  return std::move(ends->first);
}

// ---- in virtual time ---------------------------------------------------------------------------

TestDaemon::TestDaemon(const std::string& toml, const std::shared_ptr<VirtualReactor>& reactor)
    : PlayedDaemon({reactor, &reactor->context}, toml,
                   [this](int descriptor, short events, int wait_ms) {
                     return wait_for(descriptor, events, wait_ms);
                   }),
      time_(reactor->time) {}

TestDaemon::~TestDaemon() {
  if (is_started_) end();
  unplug_all();
  run_for(std::chrono::seconds(1));
}

void TestDaemon::start(bool until_ready) {
  is_started_ = true;
  daemon().start();
  if (until_ready && !eventually([&] { return is_ready(); }))
    throw std::runtime_error("its modules do not answer");
}

void TestDaemon::end() {
  daemon().stop();
  time_.run_while_not([&] { return daemon().has_ended(); }, std::chrono::hours(1));
}

bool TestDaemon::wait_for(int descriptor, short events, int wait_ms) {
  const auto ready = [&] { return tmcl::test::wait_in_real_time(descriptor, events, 0); };
  const auto limit = now() + std::chrono::milliseconds(wait_ms);
  if (time_.run_while_not(ready, limit - now())) return true;
  time_.run_until(limit);
  return ready();
}

}  // namespace tmcld::test
