/// A unix socket that carries lines of text.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "tmcl/client.hpp"

namespace tmcl::client {

/// Move-only; closes its descriptor.
class LineSocket final : public LineChannel {
 public:
  /// Waits so long for a socket that is not there yet.
  static Result<LineSocket> open(const std::string& path, Duration wait,
                                 std::function<bool()> cancelled);
  LineSocket(LineSocket&& other) noexcept;
  LineSocket& operator=(LineSocket&& other) noexcept;
  ~LineSocket() override;

  const std::string& name() const override { return path_; }
  Result<void> write_line(std::string line, TimePoint deadline) override;
  Result<std::optional<std::string>> read_line(TimePoint deadline) override;

 private:
  LineSocket(int descriptor, std::string path, std::function<bool()> cancelled);

  std::optional<std::string> take_line();
  Result<void> receive();
  /// False when the deadline came first.
  Result<bool> wait_for(short events, TimePoint deadline);
  Error lost(std::string_view why) const;

  int descriptor_ = -1;
  std::string path_;
  std::function<bool()> cancelled_;
  std::string received_;
};

}  // namespace tmcl::client
