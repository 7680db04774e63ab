#include "sim/ports/usb_port.hpp"

#include <array>
#include <memory>
#include <span>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>

#include "sim/ports/virtual_usb.hpp"
#include "sim/wire/usbip.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {
namespace {

namespace asio = boost::asio;

class UsbPort final : public Port {
 public:
  UsbPort(asio::io_context& io, Scheduler& scheduler, Module& module, UsbLayout layout,
          std::uint64_t seed, VirtualUsb cable)
      : module_(&module),
        scheduler_(&scheduler),
        place_(std::move(cable.place)),
        socket_(io, asio::local::stream_protocol(), cable.end.release()),
        device_(
            scheduler.bench(), module, layout,
            [this](const UsbResult& result) { write(encode_usbip(result)); }, seed) {
    read_on();
  }

  std::string description() const override {
    const auto address = module_->globals().value(global_parameter::serial_address);
    return "usb " + place_ + ", module " + std::to_string(address);
  }

 private:
  void read_on() {
    socket_.async_read_some(asio::buffer(input_), [this](const auto& error, std::size_t size) {
      if (error) return;  // the kernel has taken the device off
      decoder_.feed(std::span(input_).first(size));
      while (const auto command = decoder_.next())
        std::visit([this](const auto& what) { this->carry_out(what); }, *command);
      scheduler_->touch();
      if (decoder_.is_broken()) return socket_.close();
      read_on();
    });
  }

  void carry_out(const UsbRequest& request) { device_.submit(request); }
  void carry_out(const UsbipCancel& cancel) {
    write(encode_usbip(cancel, device_.cancel(cancel.request)));
  }

  // The kernel reads whatever it is sent, at once.
  void write(const std::vector<std::uint8_t>& bytes) {
    boost::system::error_code gone;
    asio::write(socket_, asio::buffer(bytes), gone);
  }

  Module* module_;
  Scheduler* scheduler_;
  std::string place_;
  asio::local::stream_protocol::socket socket_;
  UsbipDecoder decoder_;
  UsbDevice device_;
  std::array<std::uint8_t, 4096> input_{};
};

}  // namespace

OpenedPort open_usb_port(asio::io_context& io, Scheduler& scheduler, Module& module,
                         UsbLayout layout, std::uint64_t seed) {
  auto cable = plug_in_virtual_usb();
  if (!cable) return tl::unexpected(cable.error());
  return std::make_unique<UsbPort>(io, scheduler, module, layout, seed, std::move(*cable));
}

}  // namespace tmcl::sim
