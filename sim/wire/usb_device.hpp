/// The USB device that a module is: requests of a host controller in, their results out.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sim/wire/usb_layout.hpp"
#include "sim/wire/usb_line.hpp"

namespace tmcl::sim {

/// What the host's controller wants done, such as "give me what the module has to say".
struct UsbRequest {
  std::uint32_t id = 0;
  bool in = false;  ///< To the host.
  std::uint8_t endpoint = 0;
  std::uint32_t length = 0;             ///< At most so many bytes to the host.
  std::array<std::uint8_t, 8> setup{};  ///< Of endpoint 0.
  std::vector<std::uint8_t> data;       ///< From the host.
};

struct UsbResult {
  std::uint32_t id = 0;
  std::int32_t status = 0;         ///< 0, or an errno of Linux, negative.
  std::uint32_t transferred = 0;   ///< Bytes, either way.
  std::vector<std::uint8_t> data;  ///< To the host.
};

/// Knows what the kernel's cdc_acm and libusb ask for: descriptors, configuration, line coding,
/// control lines. The line coding is remembered and does nothing. Anything else is stalled.
class UsbDevice {
 public:
  using Output = std::function<void(const UsbResult&)>;

  static constexpr std::size_t most_answers = 16;  ///< That wait for a host that does not read.

  /// `output` must not destroy the device.
  UsbDevice(Bench& bench, Module& module, UsbLayout layout, Output output, std::uint64_t seed);

  /// Its result may come at once, or much later if there is nothing to say.
  void submit(UsbRequest request);
  /// No result will come for this. False if it has come.
  bool cancel(std::uint32_t id);

 private:
  using Bytes = std::vector<std::uint8_t>;

  void control(const UsbRequest& request);
  std::optional<Bytes> answer_to(const UsbRequest& request);
  std::optional<Bytes> standard_answer(const UsbRequest& request);
  std::optional<Bytes> class_answer(const UsbRequest& request);
  std::optional<Bytes> descriptor(std::uint8_t type, std::uint8_t index) const;
  void hear(const UsbRequest& request);
  void say(std::span<const std::uint8_t> answer);
  void hand_over();

  UsbLayout layout_;
  Output output_;
  UsbLine line_;
  std::uint8_t configuration_ = 0;
  Bytes line_coding_;
  std::deque<UsbRequest> readers_;    ///< Of the data endpoint.
  std::vector<UsbRequest> sleepers_;  ///< Of the interrupt endpoint, which says nothing.
  std::deque<Bytes> answers_;
};

}  // namespace tmcl::sim
