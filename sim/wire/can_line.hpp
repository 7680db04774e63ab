/// A CAN bus with modules on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <unordered_map>
#include <utility>

#include "sim/module/module.hpp"
#include "sim/wire/line.hpp"
#include "sim/wire/pace.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// A module answers to its identifier (global parameter 71), as standard and as extended frame, and
/// obeys its secondary one (83, unless 0) in silence. Replies go out under the identifier of global
/// parameter 70, in the format of the request, with seven bytes for seven and otherwise eight.
///
/// What a module sends, the others hear: one whose identifier is that of a reply takes it for a
/// command, and executes it. So two modules may go on answering each other for ever, at the pace of
/// the wire.
///
/// A frame of less than seven bytes is executed like any other (vendor's open firmware: it copies
/// the whole buffer of its controller and looks at the length for its answer only). What a
/// controller leaves in the rest of its buffer is nowhere promised; here it is what the module was
/// sent before.
///
/// With a pace, frames of the host and of the modules pass one after the other, as they are ready:
/// which identifier would win does not matter.
///
/// As on serial lines, a change of identifiers acts after the reply. The bit rate (69) is kept and
/// has no effect: that is the interface's.
class CanLine final : public Line {
 public:
  using Output = std::function<void(const CanFrame&)>;

  /// `output` must not destroy the line.
  CanLine(Bench& bench, Output output, Pace pace = {});

  /// A data frame of the host.
  void receive(const CanFrame& frame);

  TimePoint next_due() const override;
  void run_due() override;
  void target_reached(const Module& module, std::int32_t motors) override;

 private:
  struct Format {
    bool extended = false;
    std::uint8_t length = can_datagram_size;
  };

  /// What a module's CAN controller has of the last frame that was for it.
  struct Ear {
    Format format;  ///< Events come as the module was last spoken to.
    decltype(CanFrame::data) bytes{};
  };
  struct Sent {
    const Module* sender;  ///< Null: the host.
    CanFrame frame;
  };

  void hear(Module& module, const CanFrame& frame);
  void send(const Module& sender, const CanFrame& frame);
  bool is_heard(const Module& sender, const CanFrame& frame) const;

  Output output_;
  std::unordered_map<const Module*, Ear> ears_;
  Pace pace_;
  std::deque<std::pair<TimePoint, Sent>> answering_;  ///< With a pace: from when they are ready.
  Transit<Sent> on_the_wire_;  ///< What is still to be heard; without a pace, by other modules.
};

}  // namespace tmcl::sim
