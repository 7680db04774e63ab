#include "sim/wire/usb_line.hpp"

#include <algorithm>
#include <utility>

#include "sim/bench.hpp"
#include "sim/wire/answer_bytes.hpp"

namespace tmcl::sim {

UsbLine::UsbLine(Bench& bench, Module& module, Output output, std::uint64_t seed, UsbLayout layout)
    : Line(bench),
      module_(&module),
      output_(std::move(output)),
      random_(seed),
      keeps_short_packets_(layout == UsbLayout::mk20) {}

void UsbLine::receive(std::span<const std::uint8_t> packet) {
  if (!keeps_short_packets_) heard_.clear();
  heard_.insert(heard_.end(), packet.begin(), packet.end());
  if (heard_.size() < serial_datagram_size) return;
  SerialBytes frame;
  std::copy_n(heard_.begin(), frame.size(), frame.begin());
  heard_.clear();
  if (module_->hears()) execute(frame);
}

void UsbLine::execute(const SerialBytes& frame) {
  const auto from = sender(module_->globals());
  const auto request = decode_serial_request(frame);
  const auto answer = request ? module_->execute(*request, Medium::serial, *this)
                              : Answer{Answer::Form::reply, Status::wrong_checksum, 0};
  if (answer.form == Answer::Form::none) return;
  send(answer_bytes(from, *module_, request ? request->command : Command{}, answer));
}

void UsbLine::send(const SerialBytes& bytes) {
  std::uniform_int_distribution<Duration::rep> takes(shortest_answer.count(),
                                                     longest_answer.count());
  const Duration usual(takes(random_));
  going_.send(bytes, bench().clock().now(), module_->settings().to_answer.value_or(usual));
}

void UsbLine::run_due() {
  while (const auto bytes = going_.take(bench().clock().now())) output_(*bytes);
}

void UsbLine::target_reached(const Module& module, std::int32_t motors) {
  send(encode_serial(arrival_of(sender(module.globals()), motors)));
}

}  // namespace tmcl::sim
