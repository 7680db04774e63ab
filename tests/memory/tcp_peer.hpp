/// Clients of the daemon, which say and hear bytes; one on a TCP port of this computer.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace tmcld::test {

class FrontPeer {
 public:
  FrontPeer() = default;
  FrontPeer(const FrontPeer&) = delete;
  FrontPeer& operator=(const FrontPeer&) = delete;
  virtual ~FrontPeer() = default;

  /// What is said is there for the daemon to read when this returns.
  virtual void say(std::string_view bytes) = 0;
  /// Since the last forget().
  virtual const std::string& heard() = 0;
  virtual void forget() = 0;
  virtual bool is_cut_off() = 0;
};

class TcpPeer final : public FrontPeer {
 public:
  explicit TcpPeer(std::uint16_t port);
  ~TcpPeer() override;

  void say(std::string_view bytes) override;
  const std::string& heard() override;
  void forget() override;
  bool is_cut_off() override;

 private:
  void read();

  int descriptor_;
  std::string heard_;
  bool is_cut_off_ = false;
};

/// One that nothing listens on now.
std::uint16_t free_tcp_port();

}  // namespace tmcld::test
