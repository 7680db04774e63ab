/// Bytes through a pseudo terminal under a name that stays the same.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "tmcl/link_file.hpp"
#include "tmcl/pty.hpp"

namespace tmcl::sim {

class PtyStream {
 public:
  PtyStream(boost::asio::io_context& io, Pty pty, LinkFile link);

  /// Calls `receive` with what a host has written, again and again until the stream goes.
  void read(std::function<void(std::span<const std::uint8_t>)> receive);
  /// What no host takes is lost.
  void write(std::span<const std::uint8_t> bytes);

  int descriptor() { return master_.native_handle(); }
  /// "/tmp/tmcm -> /dev/pts/5"
  std::string description() const { return link_.path().string() + " -> " + slave_name_; }

 private:
  void read_on();

  boost::asio::posix::stream_descriptor master_;
  FileDescriptor slave_;
  std::string slave_name_;
  LinkFile link_;
  std::function<void(std::span<const std::uint8_t>)> receive_;
  std::array<std::uint8_t, 1024> input_{};
};

/// What a stream is made of. The error is a sentence.
struct LinkedPty {
  Pty pty;
  LinkFile link;
};
tl::expected<LinkedPty, std::string> open_linked_pty(const std::filesystem::path& path);

}  // namespace tmcl::sim
