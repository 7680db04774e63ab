#include "sim/wire/usb_device.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace tmcl::sim {
namespace {

constexpr std::uint8_t type_mask = 0x60;
constexpr std::uint8_t standard_type = 0x00;
constexpr std::uint8_t class_type = 0x20;

namespace descriptor_type {
constexpr std::uint8_t device = 1;
constexpr std::uint8_t configuration = 2;
constexpr std::uint8_t string = 3;
}  // namespace descriptor_type

// Chapter 9.4 of the USB specification.
namespace standard {
constexpr std::uint8_t get_status = 0;
constexpr std::uint8_t clear_feature = 1;
constexpr std::uint8_t get_descriptor = 6;
constexpr std::uint8_t get_configuration = 8;
constexpr std::uint8_t set_configuration = 9;
constexpr std::uint8_t get_interface = 10;
constexpr std::uint8_t set_interface = 11;
}  // namespace standard

// Chapter 6.3 of the specification of telephones (PSTN).
namespace telephone {
constexpr std::uint8_t set_line_coding = 0x20;
constexpr std::uint8_t get_line_coding = 0x21;
constexpr std::uint8_t set_control_line_state = 0x22;
constexpr std::uint8_t send_break = 0x23;
}  // namespace telephone

constexpr std::size_t attributes_at = 7;
constexpr std::uint8_t self_powered = 0x40;

}  // namespace

UsbDevice::UsbDevice(Bench& bench, Module& module, UsbLayout layout, Output output,
                     std::uint64_t seed)
    : layout_(layout),
      output_(std::move(output)),
      line_(
          bench, module, [this](auto answer) { say(answer); }, seed, layout),
      line_coding_{0x80, 0x25, 0, 0, 0, 0, 8} {}  // 9600 baud, eight bits, no parity

void UsbDevice::submit(UsbRequest request) {
  const auto& own = descriptors_of(layout_);
  if (request.endpoint == 0) return control(request);
  if (!request.in && request.endpoint == own.data_out) return hear(request);
  if (!request.in) return output_({request.id, -EPIPE, 0, {}});
  if (request.endpoint != own.data_in) return sleepers_.push_back(std::move(request));
  readers_.push_back(std::move(request));
  hand_over();
}

bool UsbDevice::cancel(std::uint32_t id) {
  const auto is_meant = [id](const auto& request) { return request.id == id; };
  return std::erase_if(readers_, is_meant) + std::erase_if(sleepers_, is_meant) > 0;
}

// ---- what it says ------------------------------------------------------------------------------

void UsbDevice::hear(const UsbRequest& request) {
  std::span<const std::uint8_t> rest(request.data);
  const auto packet_size = descriptors_of(layout_).packet_size;
  output_({request.id, 0, static_cast<std::uint32_t>(rest.size()), {}});
  while (!rest.empty()) {
    const auto packet = rest.first(std::min(packet_size, rest.size()));
    rest = rest.subspan(packet.size());
    line_.receive(packet);
  }
}

void UsbDevice::say(std::span<const std::uint8_t> answer) {
  if (answers_.size() == most_answers) answers_.pop_front();
  answers_.emplace_back(answer.begin(), answer.end());
  hand_over();
}

void UsbDevice::hand_over() {
  while (!readers_.empty() && !answers_.empty()) {
    auto answer = std::move(answers_.front());
    answers_.pop_front();
    const auto reader = std::move(readers_.front());
    readers_.pop_front();
    if (answer.size() > reader.length) answer.resize(reader.length);
    const auto size = static_cast<std::uint32_t>(answer.size());
    output_({reader.id, 0, size, std::move(answer)});
  }
}

// ---- endpoint 0 --------------------------------------------------------------------------------

void UsbDevice::control(const UsbRequest& request) {
  auto answer = answer_to(request);
  if (!answer) return output_({request.id, -EPIPE, 0, {}});
  if (answer->size() > request.length) answer->resize(request.length);
  const auto size = request.in ? answer->size() : request.data.size();
  output_({request.id, 0, static_cast<std::uint32_t>(size), std::move(*answer)});
}

std::optional<UsbDevice::Bytes> UsbDevice::answer_to(const UsbRequest& request) {
  switch (request.setup[0] & type_mask) {
    case standard_type: return standard_answer(request);
    case class_type: return class_answer(request);
    default: return std::nullopt;
  }
}

std::optional<UsbDevice::Bytes> UsbDevice::standard_answer(const UsbRequest& request) {
  const auto low = request.setup[2];
  const auto high = request.setup[3];
  switch (request.setup[1]) {
    case standard::get_descriptor: return descriptor(high, low);
    case standard::set_configuration: configuration_ = low; return Bytes{};
    case standard::get_configuration: return Bytes{configuration_};
    case standard::get_interface: return Bytes{0};
    case standard::set_interface:
    case standard::clear_feature: return Bytes{};
    case standard::get_status: {
      const auto attributes = descriptors_of(layout_).configuration[attributes_at];
      const bool is_of_device = (request.setup[0] & ~0x80) == 0;
      return Bytes{static_cast<std::uint8_t>(is_of_device && (attributes & self_powered) != 0), 0};
    }
    default: return std::nullopt;
  }
}

std::optional<UsbDevice::Bytes> UsbDevice::descriptor(std::uint8_t type, std::uint8_t index) const {
  const auto& own = descriptors_of(layout_);
  switch (type) {
    case descriptor_type::device: return Bytes(own.device.begin(), own.device.end());
    case descriptor_type::configuration:
      if (index != 0) return std::nullopt;
      return Bytes(own.configuration.begin(), own.configuration.end());
    case descriptor_type::string: {
      auto text = string_descriptor(layout_, index);
      if (text.empty()) return std::nullopt;
      return text;
    }
    default: return std::nullopt;  // a device of full speed has no others
  }
}

std::optional<UsbDevice::Bytes> UsbDevice::class_answer(const UsbRequest& request) {
  switch (request.setup[1]) {
    case telephone::set_line_coding:
      if (request.data.size() != line_coding_.size()) return std::nullopt;
      line_coding_ = request.data;
      return Bytes{};
    case telephone::get_line_coding: return line_coding_;
    case telephone::set_control_line_state:
    case telephone::send_break: return Bytes{};
    default: return std::nullopt;
  }
}

}  // namespace tmcl::sim
