#include "link/usb_port.hpp"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <vector>

#include <libusb.h>
#include <poll.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "link/opening.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl {
namespace {

// A module that has not taken a request by then does not get it later, when it is not wanted any
// more. Shorter than the time for a reply.
constexpr unsigned longest_transfer_ms = 50;
constexpr unsigned longest_control_ms = 1000;
constexpr Duration longest_farewell = std::chrono::milliseconds(200);
constexpr std::size_t largest_packet = 64;  // of bulk transfers at full speed

// CDC-ACM, as USB's class definitions for communication devices have it.
constexpr std::uint8_t to_interface = 0x21;  // of this class
constexpr std::uint8_t abstract_control_model = 2;
constexpr std::uint8_t set_line_coding = 0x20;
constexpr std::uint8_t set_control_line_state = 0x22;
constexpr std::uint16_t ready_to_talk = 3;  // DTR and RTS
// 115200 baud, 8N1: modules keep it, and do nothing with it.
constexpr std::array<std::uint8_t, 7> line_coding{0x00, 0xc2, 0x01, 0x00, 0x00, 0x00, 0x08};

std::string describe(libusb_transfer_status status) {
  switch (status) {
    case LIBUSB_TRANSFER_NO_DEVICE: return "the USB device was unplugged";
    case LIBUSB_TRANSFER_STALL: return "the USB device refuses to talk (stall)";
    case LIBUSB_TRANSFER_OVERFLOW: return "the USB device sent more than its packets can hold";
    default: return "a USB transfer failed: was the device unplugged?";
  }
}

tl::unexpected<Error> refused(int error) {
  if (error == LIBUSB_ERROR_BUSY) return because(Errc::link_busy);
  // It was plugged in a moment ago.
  if (error == LIBUSB_ERROR_NOT_FOUND)
    return because(Errc::link_open_failed, "the kernel has not taken the device in yet: try again");
  return because(Errc::link_open_failed, libusb_strerror(static_cast<libusb_error>(error)));
}

/// Where the parts of a serial port are in a device. Its makers number them as they like.
struct Layout {
  std::optional<std::uint8_t> control, data;  ///< Interfaces.
  std::uint8_t in = 0;                        ///< Endpoints of the second.
  std::uint8_t out = 0;
  std::size_t in_packet = 0;
  std::size_t out_packet = 0;

  bool is_complete() const {
    return control && data && in != 0 && in_packet <= largest_packet &&
           out_packet >= serial_datagram_size;
  }
};

void note(const libusb_endpoint_descriptor& endpoint, Layout& layout) {
  if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_BULK) return;
  const bool is_in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
  (is_in ? layout.in : layout.out) = endpoint.bEndpointAddress;
  (is_in ? layout.in_packet : layout.out_packet) = endpoint.wMaxPacketSize;
}

/// The first of each kind.
Layout layout_of(const libusb_config_descriptor& configuration) {
  Layout layout;
  for (const auto& interface : std::span(configuration.interface, configuration.bNumInterfaces)) {
    if (interface.num_altsetting < 1) continue;
    const auto& first = interface.altsetting[0];
    if (first.bInterfaceClass == LIBUSB_CLASS_COMM &&
        first.bInterfaceSubClass == abstract_control_model && !layout.control)
      layout.control = first.bInterfaceNumber;
    if (first.bInterfaceClass != LIBUSB_CLASS_DATA || layout.data) continue;
    layout.data = first.bInterfaceNumber;
    for (const auto& endpoint : std::span(first.endpoint, first.bNumEndpoints))
      note(endpoint, layout);
  }
  return layout;
}

/// Without a search for devices and the thread that libusb has for it: the caller has found one.
int make_context(libusb_context** context) {
#if LIBUSB_API_VERSION >= 0x0100010A
  const libusb_init_option no_search{LIBUSB_OPTION_NO_DEVICE_DISCOVERY, {}};
  return libusb_init_context(context, &no_search, 1);
#else
  static std::once_flag told;
  std::call_once(told, [] { libusb_set_option(nullptr, LIBUSB_OPTION_NO_DEVICE_DISCOVERY); });
  return libusb_init(context);
#endif
}

class LibusbPort final : public UsbPort {
 public:
  LibusbPort(int node, int events) : node_(node), events_(events) {}
  LibusbPort(const LibusbPort&) = delete;
  LibusbPort& operator=(const LibusbPort&) = delete;
  ~LibusbPort() override;

  Result<void> open();
  tl::expected<std::size_t, std::string> read(std::span<std::uint8_t> into) override;
  tl::expected<std::size_t, std::string> write(std::span<const std::uint8_t> bytes) override;

 private:
  /// One transfer that is used again and again.
  struct Pipe {
    LibusbPort* port = nullptr;
    libusb_transfer* transfer = nullptr;
    std::array<std::uint8_t, largest_packet> buffer{};
    bool in_flight = false;
  };

  int find_layout();
  int claim();
  int greet();
  int control(std::uint8_t request, std::uint16_t value, std::span<const std::uint8_t> data);
  bool make(Pipe& pipe, std::uint8_t endpoint, unsigned timeout_ms);
  void watch();
  void submit(Pipe& pipe, std::size_t size);
  void handle_events(Duration at_most = {});
  void cancel_transfers();
  void give_back();
  static void LIBUSB_CALL on_transfer(libusb_transfer* transfer);
  void on_event_source(int descriptor, short events);

  int node_;
  int events_;
  libusb_context* context_ = nullptr;
  libusb_device_handle* device_ = nullptr;
  Layout layout_;
  std::vector<std::uint8_t> claimed_;
  Pipe in_, out_;
  std::span<const std::uint8_t> unread_;
  std::string lost_;  ///< Why nothing goes any more; empty as long as it does.
};

// ---- opening -----------------------------------------------------------------------------------

Result<void> LibusbPort::open() {
  int error = make_context(&context_);
  if (error == 0) error = libusb_wrap_sys_device(context_, node_, &device_);
  if (error == 0) error = find_layout();
  if (error != 0) return refused(error);
  if (!layout_.is_complete()) return because(Errc::bad_argument);
  error = claim();
  if (error == 0) error = greet();
  if (error != 0) return refused(error);
  if (!make(in_, layout_.in, 0) || !make(out_, layout_.out, longest_transfer_ms))
    return refused(LIBUSB_ERROR_NO_MEM);
  watch();
  submit(in_, layout_.in_packet);
  if (!lost_.empty()) return because(Errc::link_open_failed, lost_);
  return {};
}

int LibusbPort::find_layout() {
  libusb_config_descriptor* configuration = nullptr;
  const int error = libusb_get_active_config_descriptor(libusb_get_device(device_), &configuration);
  if (error != 0) return error;
  layout_ = layout_of(*configuration);
  libusb_free_config_descriptor(configuration);
  return 0;
}

int LibusbPort::claim() {
  libusb_set_auto_detach_kernel_driver(device_, 1);
  for (const auto interface : {*layout_.control, *layout_.data}) {
    if (const int error = libusb_claim_interface(device_, interface); error != 0) return error;
    claimed_.push_back(interface);
  }
  return 0;
}

/// What the kernel's driver says when a terminal is opened.
int LibusbPort::greet() {
  const int error = control(set_line_coding, 0, line_coding);
  return error != 0 ? error : control(set_control_line_state, ready_to_talk, {});
}

int LibusbPort::control(std::uint8_t request, std::uint16_t value,
                        std::span<const std::uint8_t> data) {
  auto copy = std::array<std::uint8_t, line_coding.size()>{};
  std::ranges::copy(data, copy.begin());
  const int count =
      libusb_control_transfer(device_, to_interface, request, value, *layout_.control, copy.data(),
                              static_cast<std::uint16_t>(data.size()), longest_control_ms);
  // A device need not know the request: the kernel's driver does not mind either.
  return count < 0 && count != LIBUSB_ERROR_PIPE ? count : 0;
}

bool LibusbPort::make(Pipe& pipe, std::uint8_t endpoint, unsigned timeout_ms) {
  pipe.port = this;
  pipe.transfer = libusb_alloc_transfer(0);
  if (pipe.transfer == nullptr) return false;
  libusb_fill_bulk_transfer(pipe.transfer, device_, endpoint, pipe.buffer.data(), 0, on_transfer,
                            &pipe, timeout_ms);
  return true;
}

/// All of libusb's descriptors behind the one that the link has. It takes its timeouts from one of
/// them, too.
void LibusbPort::watch() {
  libusb_set_pollfd_notifiers(
      context_,
      [](int descriptor, short events, void* port) {
        static_cast<LibusbPort*>(port)->on_event_source(descriptor, events);
      },
      [](int descriptor, void* port) {
        static_cast<LibusbPort*>(port)->on_event_source(descriptor, 0);
      },
      this);
  const auto** sources = libusb_get_pollfds(context_);
  for (const auto** source = sources; source != nullptr && *source != nullptr; ++source)
    on_event_source((*source)->fd, (*source)->events);
  libusb_free_pollfds(sources);
}

/// No events: it is no source any more.
void LibusbPort::on_event_source(int descriptor, short events) {
  epoll_event event{};
  event.events =
      ((events & POLLIN) != 0 ? EPOLLIN : 0U) | ((events & POLLOUT) != 0 ? EPOLLOUT : 0U);
  event.data.fd = descriptor;
  epoll_ctl(events_, events != 0 ? EPOLL_CTL_ADD : EPOLL_CTL_DEL, descriptor, &event);
}

// ---- talking -----------------------------------------------------------------------------------

void LibusbPort::submit(Pipe& pipe, std::size_t size) {
  pipe.transfer->length = static_cast<int>(size);
  const int error = libusb_submit_transfer(pipe.transfer);
  pipe.in_flight = error == 0;
  if (error == 0 || !lost_.empty()) return;
  lost_ = error == LIBUSB_ERROR_NO_DEVICE ? describe(LIBUSB_TRANSFER_NO_DEVICE)
                                          : libusb_strerror(static_cast<libusb_error>(error));
}

void LibusbPort::on_transfer(libusb_transfer* transfer) {
  auto& pipe = *static_cast<Pipe*>(transfer->user_data);
  auto& port = *pipe.port;
  pipe.in_flight = false;
  switch (transfer->status) {
    case LIBUSB_TRANSFER_COMPLETED:
      if (&pipe == &port.in_)
        port.unread_ =
            std::span(pipe.buffer).first(static_cast<std::size_t>(transfer->actual_length));
      return;
    case LIBUSB_TRANSFER_CANCELLED: return;
    case LIBUSB_TRANSFER_TIMED_OUT: return;
    default:
      if (port.lost_.empty()) port.lost_ = describe(transfer->status);
  }
}

void LibusbPort::handle_events(Duration at_most) {
  const auto microseconds = std::chrono::duration_cast<std::chrono::microseconds>(at_most).count();
  timeval patience{0, microseconds};
  const int error = libusb_handle_events_timeout_completed(context_, &patience, nullptr);
  if (error != 0 && error != LIBUSB_ERROR_INTERRUPTED && lost_.empty())
    lost_ = libusb_strerror(static_cast<libusb_error>(error));
}

tl::expected<std::size_t, std::string> LibusbPort::read(std::span<std::uint8_t> into) {
  if (unread_.empty()) handle_events();
  const auto count = std::min(into.size(), unread_.size());
  std::ranges::copy(unread_.first(count), into.begin());
  unread_ = unread_.subspan(count);
  if (unread_.empty() && !in_.in_flight && lost_.empty()) submit(in_, layout_.in_packet);
  // Nothing may wake the caller again to be told later.
  if (!lost_.empty()) return tl::unexpected(lost_);
  return count;
}

tl::expected<std::size_t, std::string> LibusbPort::write(std::span<const std::uint8_t> bytes) {
  if (lost_.empty() && out_.in_flight) return std::size_t{0};
  const auto count = std::min(bytes.size(), layout_.out_packet);
  std::ranges::copy(bytes.first(count), out_.buffer.begin());
  if (lost_.empty()) submit(out_, count);
  if (!lost_.empty()) return tl::unexpected(lost_);
  return count;
}

// ---- closing -----------------------------------------------------------------------------------

LibusbPort::~LibusbPort() {
  if (context_ != nullptr) libusb_set_pollfd_notifiers(context_, nullptr, nullptr, nullptr);
  if (device_ != nullptr) {
    cancel_transfers();
    if (lost_.empty()) give_back();
    libusb_close(device_);
  }
  libusb_free_transfer(in_.transfer);
  libusb_free_transfer(out_.transfer);
  if (context_ != nullptr) libusb_exit(context_);
  ::close(node_);
}

/// The system gives them back at once.
void LibusbPort::cancel_transfers() {
  for (auto* pipe : {&in_, &out_})
    if (pipe->in_flight) libusb_cancel_transfer(pipe->transfer);
  const auto end = RealClock().now() + longest_farewell;
  while ((in_.in_flight || out_.in_flight) && RealClock().now() < end)
    handle_events(std::chrono::milliseconds(10));
}

/// The data first: the kernel's driver takes both when it gets the control interface.
void LibusbPort::give_back() {
  for (; !claimed_.empty(); claimed_.pop_back()) libusb_release_interface(device_, claimed_.back());
}

}  // namespace

Result<std::shared_ptr<UsbPort>> open_usb_port(int node, int events) {
  const auto port = std::make_shared<LibusbPort>(node, events);
  return port->open().map([&]() -> std::shared_ptr<UsbPort> { return port; });
}

}  // namespace tmcl
