#include "memory/bench.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <stdexcept>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <boost/asio/post.hpp>

#include "config/load.hpp"
#include "log/log.hpp"
#include "memory/allocations.hpp"
#include "memory/tcp_peer.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
namespace ap = tmcl::axis_parameter;

std::string new_folder() {
  auto name = (std::filesystem::temp_directory_path() / "tmcld-XXXXXX").string();
  return ::mkdtemp(name.data());
}

std::string axis(const std::string& name, int module, int motor) {
  return "[[axis]]\nname = \"" + name + "\"\nbus = \"bench\"\naddress = " + std::to_string(module) +
         "\nmotor = " + std::to_string(motor) + "\nunit = \"mm\"\nscrew_pitch = 5\n";
}

}  // namespace

// ---- a client ----------------------------------------------------------------------------------

MemoryClient::MemoryClient(MemoryBench& bench)
    : bench_(bench), descriptor_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  bench.socket().copy(address.sun_path, sizeof address.sun_path - 1);
  if (::connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("cannot connect");
  const auto is_greeted = [&] {
    read();
    return input_.find('\n') != std::string::npos;
  };
  if (!bench.run_until(is_greeted, 1s)) throw std::runtime_error("no greeting");
}

MemoryClient::~MemoryClient() { ::close(descriptor_); }

void MemoryClient::send(std::string_view method, std::string_view params) {
  answer_.reset();
  const auto line = R"({"jsonrpc":"2.0","id":)" + std::to_string(++last_id_) + R"(,"method":")" +
                    std::string(method) + R"(","params":)" + std::string(params) + "}\n";
  for (std::string_view left = line; !left.empty();) {
    const auto sent = ::send(descriptor_, left.data(), left.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) left.remove_prefix(static_cast<std::size_t>(sent));
    if (sent > 0) continue;
    if (errno != EAGAIN) return;
    bench_.run_for(1ms);
  }
}

void MemoryClient::read() {
  char bytes[4096];
  while (true) {
    const auto count = ::recv(descriptor_, bytes, sizeof bytes, MSG_DONTWAIT);
    if (count == 0) is_cut_off_ = true;
    if (count <= 0) return;
    input_.append(bytes, static_cast<std::size_t>(count));
  }
}

std::optional<json::object> MemoryClient::answer() {
  read();
  for (auto end = input_.find('\n'); end != std::string::npos; end = input_.find('\n')) {
    auto message = json::parse(input_.substr(0, end)).as_object();
    input_.erase(0, end + 1);
    const auto* id = message.if_contains("id");
    const bool is_unread = id != nullptr && id->is_null();
    if (id != nullptr && (is_unread || *id == last_id_)) answer_ = std::move(message);
  }
  return answer_;
}

json::object MemoryClient::call(std::string_view method, std::string_view params) {
  send(method, params);
  (void)bench_.run_until([&] { return answer().has_value() || is_cut_off_; }, 60s);
  return answer_.value_or(json::object{{"nothing", method}});
}

// ---- the daemon --------------------------------------------------------------------------------

MemoryBench::MemoryBench()
    : folder_(new_folder()),
      socket_(folder_ + "/socket"),
      line_(modules_, [this](auto bytes) { (void)far_->write(bytes); },
            {.pace = {.bits_per_second = 115'200, .to_answer = 500us}}) {
  silence_log();
  std::signal(SIGPIPE, SIG_IGN);
  tmcl::sim::ModuleSettings settings;
  settings.data_logger = true;
  modules_.add(*tmcl::find_model("TMCM-1110"), tmcl::ModuleAddress{1}, settings);
  modules_.add(*tmcl::find_model("TMCM-3110"), tmcl::ModuleAddress{2});
  modules_.add(*tmcl::find_model("TMCM-1140"), tmcl::ModuleAddress{3});
  // Another program may take a port that was free.
  auto problem = create_daemon();
  for (int tries = 1; !problem.empty() && tries < 10; ++tries) problem = create_daemon();
  if (!problem.empty()) throw std::runtime_error(problem);
  daemon_->start();
  open_can_port();
  const auto is_ready = [&] {
    for (const auto& one : daemon_->gateway().axes())
      if (one->module().state() != GatewayModule::State::ready) return false;
    return true;
  };
  if (!run_until(is_ready, 10s)) throw std::runtime_error("its modules do not answer");
  run_for(1s);
}

std::string MemoryBench::create_daemon() {
  http_port_ = free_tcp_port();
  serial_port_ = free_tcp_port();
  const auto config =
      parse_config("[daemon]\nsocket = \"" + socket_ + "\"\n[[bus]]\nname = \"bench\"\n" +
                   "link = \"serial:/dev/none@115200\"\n" + axis("x", 1, 0) + axis("y", 2, 0) +
                   axis("z", 2, 1) + "[[module]]\nbus = \"bench\"\naddress = 3\n" +
                   "[[port]]\nname = \"a\"\nbus = \"bench\"\nmay = [\"move\"]\n" +
                   "tcp = \"127.0.0.1:" + std::to_string(serial_port_) + "\"\n" +
                   "[[port]]\nname = \"b\"\nbus = \"bench\"\nmay = [\"move\"]\n" + "pty = \"" +
                   terminal() + "\"\n");
  if (!config) throw std::runtime_error(config.error().front().message);
  HttpConfig http;
  http.listen = {{"127.0.0.1", http_port_}};
  http.loopback_without_token = true;
  auto daemon = Daemon::create(
      context_, *config, [this](const auto&) { return open(); }, {}, http);
  if (!daemon) return daemon.error();
  daemon_ = std::move(*daemon);
  return {};
}

void MemoryBench::open_can_port() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw std::runtime_error("no pair of sockets");
  can_hosts_ = tmcl::FileDescriptor(ends[0]);
  CanSockets sockets;
  sockets.open = [end = ends[1]](const auto&) { return tmcl::FileDescriptor(end); };
  sockets.is_on = [](int, const auto&) { return true; };
  PortConfig config;
  config.name = "c";
  config.bus = "bench";
  config.role = Role::operate;
  auto port = tmcld::open_can_port(config, {"can"}, daemon_->gateway().shared_from_this(),
                                   std::move(sockets));
  can_port_ = std::move(*port);
  can_port_->start();
}

MemoryBench::~MemoryBench() {
  can_port_->close();
  daemon_->stop();
  (void)run_until([&] { return daemon_->has_ended(); }, 500s);
  run_for(1s);
  can_port_.reset();
  daemon_.reset();
  std::filesystem::remove_all(folder_);
}

tmcl::Result<tmcl::Link> MemoryBench::open() {
  auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
  if (!ends) return tl::unexpected(ends.error());
  far_ = std::make_unique<tmcl::Link>(std::move(ends->second));
  return std::move(ends->first);
}

void MemoryBench::let_reactor_throw() {
  boost::asio::post(context_, [] { throw std::bad_alloc(); });
}

template <class Turn>
void MemoryBench::in_daemon(Turn turn) {
  try {
    const Watched watched;
    turn();
  } catch (...) {
    has_failed_ = true;
    const Watched watched;
    daemon_->on_failure(std::current_exception());
  }
}

void MemoryBench::go_on(tmcl::TimePoint limit) {
  in_daemon([&] { time_.settle(); });
  if (serve_modules()) return;
  const auto next = std::min(limit, modules_.next_due());
  bool went_on = false;
  in_daemon([&] { went_on = time_.step(next); });
  if (!went_on && next > time_.now()) time_.freeze_for(next - time_.now());
  modules_.run_due();
}

bool MemoryBench::serve_modules() {
  std::array<std::uint8_t, 64> bytes{};
  const auto count = far_ ? far_->read(bytes) : tmcl::Result<std::size_t>(0U);
  if (!count || *count == 0) return false;
  const auto all = std::span(bytes).first(*count);
  for (auto rest = all; rest.size() >= tmcl::serial_datagram_size;
       rest = rest.subspan(tmcl::serial_datagram_size)) {
    const auto request = tmcl::decode_serial_request(rest.first<tmcl::serial_datagram_size>());
    if (request) requests.push_back(*request);
  }
  line_.receive(all);
  modules_.run_due();
  return true;
}

std::int32_t MemoryBench::get(std::size_t motor, std::uint8_t parameter) {
  modules_.run_due();
  const auto& modules = modules_.modules();
  if (motor == 0) return *modules[0]->axis(0).get(parameter);
  if (motor < 4) return *modules[1]->axis(static_cast<std::uint8_t>(motor - 1)).get(parameter);
  return *modules[2]->axis(0).get(parameter);
}

std::vector<std::int32_t> MemoryBench::positions() {
  std::vector<std::int32_t> all;
  for (std::size_t motor = 0; motor < motors; ++motor)
    all.push_back(get(motor, ap::actual_position));
  return all;
}

bool MemoryBench::moves() {
  for (std::size_t motor = 0; motor < motors; ++motor)
    if (get(motor, ap::actual_velocity) != 0) return true;
  return false;
}

}  // namespace tmcld::test
