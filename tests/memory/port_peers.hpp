/// Hosts at ports of the daemon that are no TCP ports.
#pragma once

#include <string>

#include "memory/tcp_peer.hpp"
#include "tmcl/file_descriptor.hpp"

namespace tmcld::test {

/// Opens a pseudo terminal, whose other end this process has.
class PtyPeer final : public FrontPeer {
 public:
  explicit PtyPeer(const std::string& path);

  void say(std::string_view bytes) override;
  const std::string& heard() override;
  void forget() override;
  bool is_cut_off() override { return false; }

 private:
  void read();

  tmcl::FileDescriptor terminal_;
  int master_;  ///< The daemon's.
  std::string heard_;
};

/// Says datagrams as frames of a socket, and hears frames as datagrams.
class CanPeer final : public FrontPeer {
 public:
  /// Does not close the socket: nothing tells when a host on CAN goes.
  explicit CanPeer(int socket) : socket_(socket) { forget(); }

  void say(std::string_view bytes) override;
  const std::string& heard() override;
  void forget() override;
  bool is_cut_off() override { return false; }

 private:
  int socket_;
  std::string heard_;
};

}  // namespace tmcld::test
