/// A CAN bus with modules on it.
#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>

#include "sim/module/module.hpp"
#include "sim/wire/line.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// A module answers to its identifier (global parameter 71), as standard and as extended frame, and
/// obeys its secondary one (83, unless 0) in silence. Replies go out under the identifier of global
/// parameter 70, in the format of the request, with seven bytes for seven and otherwise eight.
///
/// As on serial lines, a change of identifiers acts after the reply. The bit rate (69) is kept and
/// has no effect: that is the interface's.
class CanLine final : public Line {
 public:
  using Output = std::function<void(const CanFrame&)>;

  /// `output` must not destroy the line.
  CanLine(Bench& bench, Output output);

  /// A data frame of the host. Bytes that a short frame lacks count as zero.
  void receive(const CanFrame& frame);

  TimePoint next_due() const override { return never; }
  void run_due() override {}
  void target_reached(const Module& module, std::int32_t motors) override;

 private:
  struct Format {
    bool extended = false;
    std::uint8_t length = can_datagram_size;
  };

  void hand_to(Module& module, const CanFrame& frame, const Request& request, Format format);

  Output output_;
  std::unordered_map<const Module*, Format> last_format_;  // events come as the host last spoke
};

}  // namespace tmcl::sim
