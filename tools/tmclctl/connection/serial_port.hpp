/// A serial port of this computer, opened at one rate after the other.
#pragma once

#include <optional>
#include <string>

#include "baud_search.hpp"
#include "tmcl/link.hpp"

namespace tmclctl {

class SerialPort final : public SearchedPort {
 public:
  explicit SerialPort(std::string device) : device_(std::move(device)) {}

  Result<void> open(std::uint32_t baud) override;
  Result<void> send(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> receive(std::span<std::uint8_t> into, tmcl::Duration at_most) override;
  tmcl::TimePoint now() const override { return clock_.now(); }

 private:
  std::string device_;
  std::optional<tmcl::Link> link_;
  tmcl::RealClock clock_;
};

}  // namespace tmclctl
