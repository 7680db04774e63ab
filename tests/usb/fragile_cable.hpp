/// A module by USB whose cable is pulled at a given event.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

#include "sim/bench.hpp"
#include "sim/ports/virtual_usb.hpp"
#include "sim/wire/usb_device.hpp"
#include "sim/wire/usbip.hpp"

namespace tmcl::test {

/// TMCM-3110 at address 1, in a process of its own. Events are commands of the host's controller,
/// before they are carried out, and their results, when they are on their way to it.
class FragileCable {
 public:
  explicit FragileCable(sim::UsbLayout layout) {
    auto cable = sim::plug_in_virtual_usb();
    if (!cable) throw std::runtime_error(cable.error());
    place = cable->place;
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe to be had");
    process_ = fork();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      Device(cable->end.get(), ends[0], layout).serve();
    }
    close(ends[0]);
    orders_ = ends[1];
  }
  FragileCable(const FragileCable&) = delete;
  FragileCable& operator=(const FragileCable&) = delete;
  ~FragileCable() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    close(orders_);
  }

  /// So many events pass from now on; the next one pulls the cable.
  void pull_after(std::uint8_t events) const {
    if (write(orders_, &events, 1) != 1) throw std::runtime_error("the module is gone");
  }

  std::string place;

 private:
  class Device {
   public:
    Device(int cable, int orders, sim::UsbLayout layout)
        : cable_(cable),
          orders_(orders),
          module_(bench_.add(*find_model(3110), ModuleAddress{1})),
          device_(
              bench_, module_, layout,
              [this](const sim::UsbResult& result) {
                say(sim::encode_usbip(result));
                count();
              },
              1) {}

    [[noreturn]] void serve() {
      while (true) {
        pollfd ready[] = {{orders_, POLLIN, 0}, {cable_, POLLIN, 0}};
        poll(ready, 2, 1);
        if (ready[1].revents != 0) hear();
        take_order();
        bench_.run_due();
      }
    }

   private:
    void take_order() {
      pollfd order{orders_, POLLIN, 0};
      if (poll(&order, 1, 0) <= 0) return;
      std::uint8_t events = 0;
      if (read(orders_, &events, 1) != 1) _exit(0);
      left_ = events;
    }
    void hear() {
      std::uint8_t bytes[4096];
      const auto size = read(cable_, bytes, sizeof bytes);
      if (size <= 0) _exit(0);
      decoder_.feed({bytes, static_cast<std::size_t>(size)});
      while (const auto command = decoder_.next()) {
        count();
        if (const auto* cancel = std::get_if<sim::UsbipCancel>(&*command)) {
          say(sim::encode_usbip(*cancel, device_.cancel(cancel->request)));
        } else {
          device_.submit(std::get<sim::UsbRequest>(*command));
        }
      }
    }
    void say(const std::vector<std::uint8_t>& bytes) const {
      if (send(cable_, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) _exit(0);
    }
    /// An order may have come before the event, and after the last look at orders.
    void count() {
      take_order();
      if (left_ >= 0 && left_-- == 0) _exit(0);
    }

    int cable_;
    int orders_;
    int left_ = -1;  ///< None: for ever.
    RealClock clock_;
    sim::Bench bench_{clock_};
    sim::Module& module_;
    sim::UsbDevice device_;
    sim::UsbipDecoder decoder_;
  };

  pid_t process_ = -1;
  int orders_ = -1;
};

}  // namespace tmcl::test
