/// Lines of the log as journald takes them from programs that know it: with fields, by which
/// `journalctl TMCL_AXIS=x` finds them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tmcld {

/// What a line says in words such as method=axis.stop, client="port lab" and {"axis":"x"}: the
/// fields TMCL_METHOD, TMCL_CLIENT, TMCL_OUTCOME, TMCL_ERROR, TMCL_BUS and TMCL_AXIS, as far as
/// they are there, each once.
std::vector<std::pair<std::string, std::string>> journald_fields(std::string_view line);

/// A datagram of journald's native protocol; `priority` by syslog's numbers.
std::string journald_entry(int priority, std::string_view line);

/// A socket that such datagrams go to.
class JournaldSocket {
 public:
  /// journald may be absent; then nothing can be sent.
  explicit JournaldSocket(const std::string& path = "/run/systemd/journal/socket");
  JournaldSocket(const JournaldSocket&) = delete;
  JournaldSocket& operator=(const JournaldSocket&) = delete;
  ~JournaldSocket();

  bool is_there() const { return descriptor_ >= 0; }
  /// Waits while journald is busy. False if it does not take it.
  bool send(std::string_view entry) const;

 private:
  int descriptor_ = -1;
};

}  // namespace tmcld
