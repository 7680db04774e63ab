/// Answers every request on a descriptor with as little work as possible, in a process of its own.
#pragma once

#include <csignal>
#include <cstdint>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tmcl/datagram.hpp"

namespace tmcl::test {

class Responder {
 public:
  explicit Responder(int descriptor) : process_(fork()) {
    if (process_ == 0) serve(descriptor);
  }
  Responder(const Responder&) = delete;
  Responder& operator=(const Responder&) = delete;
  ~Responder() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }

 private:
  [[noreturn]] static void serve(int descriptor) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    SerialBytes bytes{};
    std::size_t have = 0;
    while (true) {
      const auto count = read(descriptor, bytes.data() + have, bytes.size() - have);
      if (count <= 0) {
        // Nobody has opened the other end yet.
        usleep(1000);
        continue;
      }
      have += static_cast<std::size_t>(count);
      if (have < bytes.size()) continue;
      have = 0;
      answer(descriptor, bytes);
    }
  }

  static void answer(int descriptor, const SerialBytes& bytes) {
    const auto request = decode_serial_request(bytes);
    if (!request) return;
    Reply reply{default_host_address, reply_byte(request->address), Status::ok, request->command,
                request->value};
    // TMCM-3110, firmware 1.09
    if (request->command == Command::GET_FIRMWARE_VERSION) reply.value = 0x0C260109;
    const auto out = encode_serial(reply);
    [[maybe_unused]] const auto written = write(descriptor, out.data(), out.size());
  }

  pid_t process_;
};

}  // namespace tmcl::test
