/// A client of the daemon on a port of this computer, which says and hears bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace tmcld::test {

class TcpPeer {
 public:
  explicit TcpPeer(std::uint16_t port);
  TcpPeer(const TcpPeer&) = delete;
  TcpPeer& operator=(const TcpPeer&) = delete;
  ~TcpPeer();

  /// What is said is there for the daemon to read when this returns.
  void say(std::string_view bytes);
  /// Since the last forget().
  const std::string& heard();
  void forget();
  bool is_cut_off();

 private:
  void read();

  int descriptor_;
  std::string heard_;
  bool is_cut_off_ = false;
};

/// One that nothing listens on now.
std::uint16_t free_tcp_port();

}  // namespace tmcld::test
