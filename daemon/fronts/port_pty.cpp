// A pseudo terminal, for hosts that open a serial port.
//
// Nothing tells the master that a host has opened the terminal, or closed it while another end is
// held open; so the file is watched by inotify. The daemon's own descriptor of the far end keeps
// the terminal alive between hosts.
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <exception>
#include <system_error>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "async/readiness.hpp"
#include "fronts/port.hpp"
#include "fronts/port_stream.hpp"
#include "tmcl/link_file.hpp"
#include "tmcl/pty.hpp"

namespace tmcld {
namespace {

using boost::system::error_code;
using tmcl::FileDescriptor;

/// Of answers that no host reads, no more is kept for it: a host that is there reads each.
constexpr int most_unread_bytes = 1024;

class PtyPort final : public Port, public std::enable_shared_from_this<PtyPort> {
 public:
  PtyPort(const PortConfig& config, std::shared_ptr<Gateway> gateway, tmcl::Pty pty,
          tmcl::LinkFile link, FileDescriptor watch)
      : config_(config),
        gateway_(std::move(gateway)),
        executor_(gateway_->buses().front()->executor()),
        master_(executor_, pty.master.release()),
        watch_(executor_, watch.release()),
        slave_(std::move(pty.slave)),
        link_(std::move(link)) {
    master_.non_blocking(true);
    watch_.non_blocking(true);
  }

  void start() override {
    await_input();
    await_events();
  }
  void close() override {
    end_of_host();
    error_code ignored;
    master_.close(ignored);
    watch_.close(ignored);
  }

 private:
  /// What comes before the bytes that are read: TIOCPKT.
  static constexpr std::size_t control_byte = 1;

  void await_input() {
    wait_for_input(master_, input_room_, [self = shared_from_this()](const error_code& error) {
      if (error) return;
      // A host is known to be there before it is heard.
      self->take_events();
      if (self->take_input()) self->await_input();
    });
  }
  void await_events() {
    wait_for_input(watch_, events_room_, [self = shared_from_this()](const error_code& error) {
      if (error) return;
      self->take_events();
      self->await_events();
    });
  }

  /// Reads until nothing is left. False at the end of the port.
  bool take_input() {
    while (master_.is_open()) {
      std::array<std::uint8_t, 1024> bytes{};
      error_code error;
      const auto size = master_.read_some(boost::asio::buffer(bytes), error);
      if (error == boost::asio::error::would_block) return true;
      if (error || size == 0) return false;
      if (bytes.front() == TIOCPKT_DATA) {
        hear(std::span(bytes).first(size).subspan(control_byte));
        continue;
      }
      if ((bytes.front() & TIOCPKT_FLUSHREAD) != 0 && stream_) stream_->session()->forget_answers();
      if ((bytes.front() & TIOCPKT_FLUSHWRITE) != 0 && stream_) stream_->drop_half();
    }
    return false;
  }

  void take_events() {
    alignas(inotify_event) std::array<char, 4096> events{};
    error_code error;
    while (watch_.is_open()) {
      const auto size = watch_.read_some(boost::asio::buffer(events), error);
      if (error) return;
      bool has_closed = false;
      for (std::size_t at = 0; at < size;) {
        const auto* event = reinterpret_cast<const inotify_event*>(events.data() + at);
        if ((event->mask & IN_OPEN) != 0) ++hosts_;
        if ((event->mask & IN_CLOSE) != 0 && hosts_ > 0 && --hosts_ == 0) has_closed = true;
        at += sizeof(inotify_event) + event->len;
      }
      if (has_closed && hosts_ == 0) take_input();
      if (has_closed) end_of_host();
    }
  }

  /// A host whose session has failed has another one with what it says next.
  void hear(std::span<const std::uint8_t> bytes) {
    try {
      host()->receive(bytes);
    } catch (...) {
      if (asks_for_stop(bytes)) gateway_->stop_in_need();
      fail(std::current_exception());
    }
  }
  void fail(const std::exception_ptr& failure) {
    end_of_host();
    gateway_->log_failure("port " + config_.name + ", whose host was forgotten", failure);
  }

  std::shared_ptr<PortStream> host() {
    if (stream_) return stream_;
    auto session = std::make_shared<PortSession>(
        gateway_, config_, "port " + config_.name,
        [weak = weak_from_this()](const Told& told, CanForm) {
          if (const auto self = weak.lock()) self->write(to_serial(told));
        },
        [weak = weak_from_this()] {
          if (const auto self = weak.lock()) self->end_of_host();
        });
    const auto descriptor = master_.native_handle();
    stream_ = std::make_shared<PortStream>(session, executor_,
                                           [descriptor] { return has_input(descriptor); });
    session->start();
    return stream_;
  }

  /// The next host is to find nothing that was said to this one.
  void end_of_host() {
    if (const auto stream = std::exchange(stream_, nullptr)) stream->close();
    ::tcflush(slave_.get(), TCIFLUSH);
  }

  void write(const tmcl::SerialBytes& bytes) {
    int unread = 0;
    const bool is_known = ::ioctl(slave_.get(), FIONREAD, &unread) == 0;
    if (is_known && unread > most_unread_bytes) return;
    error_code full;
    master_.write_some(boost::asio::buffer(bytes), full);
  }

  PortConfig config_;
  std::shared_ptr<Gateway> gateway_;
  boost::asio::any_io_executor executor_;
  boost::asio::posix::stream_descriptor master_;
  boost::asio::posix::stream_descriptor watch_;
  WaitingRoom input_room_;
  WaitingRoom events_room_;
  FileDescriptor slave_;
  tmcl::LinkFile link_;
  std::shared_ptr<PortStream> stream_;  ///< Null while no host is known to be there.
  int hosts_ = 0;                       ///< How often the terminal is open, besides here.
};

/// Users of the daemon's socket may use its ports.
void share_with_group(int terminal, const PortConfig& config, const Gateway& gateway) {
  const bool is_shared = ::fchown(terminal, static_cast<uid_t>(-1), ::getegid()) == 0 &&
                         ::fchmod(terminal, S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP) == 0;
  if (is_shared) return;
  gateway.log(LogLevel::warning,
              "port " + config.name + ": only root and the user of tmcld can open its terminal (" +
                  std::generic_category().message(errno) +
                  "); the service may share it with: systemctl edit tmcld, [Service] "
                  "SystemCallFilter=fchown");
}

tl::unexpected<std::string> failure(const std::string& what) {
  return tl::unexpected("cannot " + what + ": " + std::generic_category().message(errno));
}

}  // namespace

tl::expected<std::shared_ptr<Port>, std::string> open_pty_port(const PortConfig& config,
                                                               const PtyName& name,
                                                               std::shared_ptr<Gateway> gateway) {
  auto pty = tmcl::open_pty();
  if (!pty) return tl::unexpected(std::move(pty.error()));
  const int on = 1;
  if (::ioctl(pty->master.get(), TIOCPKT, &on) != 0) return failure("set up a pseudo terminal");
  share_with_group(pty->slave.get(), config, *gateway);
  FileDescriptor watch(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC));
  const bool watches = watch.valid() && ::inotify_add_watch(watch.get(), pty->slave_name.c_str(),
                                                            IN_OPEN | IN_CLOSE) >= 0;
  if (!watches) return failure("watch " + pty->slave_name);
  auto link = tmcl::LinkFile::create(name.path, pty->slave_name);
  if (!link) return tl::unexpected(std::move(link.error()));
  gateway->log(LogLevel::info, "port " + config.name + ": bus " + config.bus + " on " + name.path);
  return std::make_shared<PtyPort>(config, std::move(gateway), std::move(*pty), std::move(*link),
                                   std::move(watch));
}

}  // namespace tmcld
