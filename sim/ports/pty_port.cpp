#include "sim/ports/pty_port.hpp"

#include <utility>

#include "sim/ports/pty_stream.hpp"
#include "sim/ports/rate_of_terminal.hpp"
#include "sim/ports/silence.hpp"
#include "sim/wire/serial_line.hpp"
#include "sim/wire/usb_line.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {
namespace {

namespace asio = boost::asio;

class PtyPort final : public Port {
 public:
  PtyPort(asio::io_context& io, Scheduler& scheduler, LinkedPty pty, const SerialWire& wire)
      : stream_(io, std::move(pty.pty), std::move(pty.link)),
        silence_(io, stream_.descriptor()),
        line_(
            scheduler.bench(), [this](auto bytes) { stream_.write(bytes); }, wire) {
    stream_.read([this, &scheduler, has_rates = wire.has_rates_of_modules](auto bytes) {
      if (has_rates) line_.set_host_rate(rate_of_terminal(stream_.descriptor()));
      line_.receive(bytes, silence_.seen_at());
      scheduler.touch();
      if (line_.is_unfinished()) silence_.look_later();
    });
  }

  std::string description() const override { return "pty " + stream_.description(); }

 private:
  PtyStream stream_;
  Silence silence_;
  SerialLine line_;
};

class UsbPtyPort final : public Port {
 public:
  UsbPtyPort(asio::io_context& io, Scheduler& scheduler, Module& module, LinkedPty pty,
             std::uint64_t seed)
      : module_(&module),
        stream_(io, std::move(pty.pty), std::move(pty.link)),
        line_(
            scheduler.bench(), module, [this](auto bytes) { stream_.write(bytes); }, seed) {
    stream_.read([this, &scheduler](auto bytes) {
      line_.receive(bytes);
      scheduler.touch();
    });
  }

  std::string description() const override {
    const auto address = module_->globals().value(global_parameter::serial_address);
    return "usb-pty " + stream_.description() + ", module " + std::to_string(address);
  }

 private:
  Module* module_;
  PtyStream stream_;
  UsbLine line_;
};

}  // namespace

OpenedPort open_pty_port(asio::io_context& io, Scheduler& scheduler,
                         const std::filesystem::path& path, const SerialWire& wire) {
  auto pty = open_linked_pty(path);
  if (!pty) return tl::unexpected(pty.error());
  return std::make_unique<PtyPort>(io, scheduler, std::move(*pty), wire);
}

OpenedPort open_usb_pty_port(asio::io_context& io, Scheduler& scheduler, Module& module,
                             const std::filesystem::path& path, std::uint64_t seed) {
  auto pty = open_linked_pty(path);
  if (!pty) return tl::unexpected(pty.error());
  return std::make_unique<UsbPtyPort>(io, scheduler, module, std::move(*pty), seed);
}

}  // namespace tmcl::sim
