/// A bus of the world: simulated modules behind a paced line, whose replies may get lost, late or
/// doubled on their way to the gateway.
#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "sim/bench.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/wire/can_line.hpp"
#include "sim/wire/serial_line.hpp"
#include "support/random.hpp"
#include "tmcl/link.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/timer.hpp"
#include "world/trace.hpp"

namespace tmcld::test {

/// Of a thousand replies; what is left of them arrives as it was sent.
struct Faults {
  int lost = 0;
  int late = 0;
  int doubled = 0;
  tmcl::Duration latest = std::chrono::milliseconds(400);
};

/// A generator that is nobody else's: what a newcomer draws shifts nothing for the others.
inline tmcl::test::Random<> generator(std::uint64_t seed, std::string_view name) {
  Trace mixed;
  mixed.add(seed);
  mixed.add(name);
  return tmcl::test::Random<>(mixed.value());
}

class Wire {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using OnRequest = std::function<void(const tmcl::Request&)>;
  using OnAnswer = std::function<void(const tmcl::Request&, std::int32_t value)>;

  Wire(boost::asio::io_context& context, std::string name, tmcl::Framing framing,
       std::uint64_t seed, Faults faults, Trace& trace)
      : context_(&context),
        name_(std::move(name)),
        framing_(framing),
        faults_(faults),
        random_(generator(seed, name_)),
        trace_(&trace),
        clock_(context),
        bench_(clock_),
        scheduler_(context, bench_),
        serial_(
            bench_, [this](auto bytes) { pass_on(Bytes(bytes.begin(), bytes.end())); },
            {.pace = {.bits_per_second = 115'200, .to_answer = std::chrono::microseconds(500)}}),
        can_(bench_, [this](const tmcl::CanFrame& frame) { pass_on(frame); },
             {.bits_per_second = 1'000'000, .to_answer = std::chrono::microseconds(200)}),
        readiness_(context) {}

  tmcl::sim::Bench& bench() { return bench_; }
  const std::string& name() const { return name_; }
  /// Told of every request, when the gateway sends it.
  OnRequest on_request;
  /// Told of what a module really answers, whatever becomes of that on the way.
  OnAnswer on_answer;
  std::size_t requests() const { return requests_; }
  /// While set, nothing gets through either way, and nobody notices but by that.
  bool is_cut = false;

  /// While set, what a gateway asks to see that the line is in step is answered at once, in place
  /// of the module, with what that has answered before.
  bool forges_fences = false;

  /// While set, what this is true of does not get to the module, and is answered as if done. On a
  /// serial line, as all that follows.
  std::function<bool(const tmcl::Request&)> keeps_from_module;
  /// Likewise; it is answered as refused.
  std::function<bool(const tmcl::Request&)> refuses;
  /// While set, what a module tells can become something else.
  std::function<void(tmcl::Reply&)> change;
  /// Somebody else on the line sends this.
  void inject(const tmcl::Request& request) {
    const auto bytes = tmcl::encode_serial(request);
    note(request, bytes);
    serial_.receive(bytes);
    scheduler_.touch();
  }

  /// Whether such a module is on, and has started.
  bool hears(tmcl::ModuleAddress address) const {
    const auto id = static_cast<std::int32_t>(number(address));
    return std::ranges::any_of(bench_.modules(), [&](const auto& module) {
      return module->globals().value(tmcl::global_parameter::can_id) == id && module->hears();
    });
  }
  /// Something was done to the modules.
  void touch() { scheduler_.touch(); }
  /// The supply of a module fails now, and is back at once. Who has asked it gets no answer.
  void power_cycle(tmcl::sim::Module& module, tmcl::ModuleAddress address) {
    trace_->add(clock_.now(), name_ + " restarts", {});
    module.power_cycle();
    asked_[tmcl::reply_byte(address)].clear();
    scheduler_.touch();
  }
  /// The link is lost; it can be opened again at once.
  void unplug() {
    boost::system::error_code ignored;
    readiness_.close(ignored);
    far_ = std::make_unique<tmcl::Link>(std::move(tmcl::Link::memory_pair(framing_)->second));
  }
  /// The gateway's end; the one before is dead then.
  tmcl::Result<tmcl::Link> open() {
    auto ends = tmcl::Link::memory_pair(framing_);
    if (!ends) return tl::unexpected(ends.error());
    far_ = std::make_unique<tmcl::Link>(std::move(ends->second));
    boost::system::error_code ignored;
    readiness_.close(ignored);
    readiness_.assign(::dup(far_->descriptor()));
    wait();
    return std::move(ends->first);
  }

 private:
  void wait() {
    readiness_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                          [this](const auto& error) {
                            if (!error && read()) wait();
                          });
  }

  /// False when the gateway has closed its end.
  bool read() {
    const bool open = framing_ == tmcl::Framing::serial ? read_bytes() : read_frames();
    scheduler_.touch();
    return open;
  }

  bool read_bytes() {
    Bytes bytes(tmcl::serial_datagram_size);
    const auto count = far_->read(bytes);
    if (!count || *count == 0) return false;
    bytes.resize(*count);
    if (*count == tmcl::serial_datagram_size) {
      const std::span<const std::uint8_t, tmcl::serial_datagram_size> whole(bytes.data(), *count);
      const auto request = tmcl::decode_serial_request(whole);
      note(request, bytes);
      if (request && is_forged(*request)) {
        write(Bytes(forged_.at(key_of(*request))));
        return true;
      }
      if (request && keeps_from_module && keeps_from_module(*request)) {
        answer(*request, tmcl::Status::ok);
        return true;
      }
      if (request && refuses && refuses(*request)) {
        answer(*request, tmcl::Status::invalid_value);
        return true;
      }
    }
    if (!is_cut) serial_.receive(bytes);
    return true;
  }

  void answer(const tmcl::Request& request, tmcl::Status status) {
    write(bytes_of({tmcl::default_host_address, tmcl::reply_byte(request.address), status,
                    request.command, request.value}));
  }

  bool read_frames() {
    auto input = far_->read_frame();
    if (!input) return false;
    if (!*input) return true;
    const auto& frame = std::get<tmcl::CanFrame>(**input);
    const auto request = tmcl::decode_can_request(frame);
    note(request, frame.data);
    if (request && is_forged(*request)) {
      write(forged_frames_.at(key_of(*request)));
      return true;
    }
    if (!is_cut) can_.receive(frame);
    return true;
  }

  void note(const std::optional<tmcl::Request>& request, std::span<const std::uint8_t> bytes) {
    trace_->add(clock_.now(), name_ + " <", bytes);
    ++requests_;
    if (!request) return;
    if (!is_forged(*request)) asked_[tmcl::reply_byte(request->address)].push_back(*request);
    if (on_request) on_request(*request);
  }

  static std::optional<tmcl::Reply> decode(const tmcl::CanFrame& frame) {
    return tmcl::decode_can_reply(frame);
  }
  static std::optional<tmcl::Reply> decode(const Bytes& bytes) {
    if (bytes.size() != tmcl::serial_datagram_size) return std::nullopt;
    return tmcl::decode_serial_reply(
        std::span<const std::uint8_t, tmcl::serial_datagram_size>(bytes.data(), bytes.size()));
  }

  /// Modules answer in order.
  std::optional<tmcl::Request> note_answer(const tmcl::Reply& reply) {
    auto& asked = asked_[reply.module];
    while (!asked.empty()) {
      const auto request = asked.front();
      asked.pop_front();
      if (request.command != reply.command) continue;
      if (on_answer) on_answer(request, reply.value);
      return request;
    }
    return std::nullopt;
  }

  // ---- forged answers ----

  using Key = std::array<int, 3>;
  static Key key_of(const tmcl::Request& request) {
    return {number(request.address), static_cast<int>(request.command), request.type};
  }
  bool is_forged(const tmcl::Request& request) const {
    const auto key = key_of(request);
    return forges_fences && (forged_.contains(key) || forged_frames_.contains(key));
  }
  /// Every command that nobody else gives.
  static bool is_fence(const tmcl::Request& request) {
    using tmcl::Command;
    switch (request.command) {
      case Command::GET_FIRMWARE_VERSION:
      case Command::GET_APPLICATION_STATUS:
      case Command::GIO:
      case Command::GET_INFO:
      case Command::GET_AP_MAX:
      case Command::GET_AP_MIN:
      case Command::GCO:
      case Command::MEASURED_SPEED:
      case Command::GET_IDS: return true;
      case Command::GGP: return request.type == tmcl::global_parameter::serial_address;
      default: return false;
    }
  }
  void remember(const tmcl::Request& request, const Bytes& reply) {
    forged_[key_of(request)] = reply;
  }
  void remember(const tmcl::Request& request, const tmcl::CanFrame& reply) {
    forged_frames_[key_of(request)] = reply;
  }

  static Bytes bytes_of(const tmcl::Reply& reply) {
    const auto bytes = tmcl::encode_serial(reply);
    return {bytes.begin(), bytes.end()};
  }
  void change_value(tmcl::CanFrame&, const tmcl::Reply&) {}
  void change_value(Bytes& bytes, tmcl::Reply reply) {
    change(reply);
    bytes = bytes_of(reply);
  }

  template <class Reply>
  void pass_on(Reply reply) {
    const auto decoded = decode(reply);
    if (decoded && decoded->status == tmcl::Status::ok) {
      const auto request = note_answer(*decoded);
      if (forges_fences && request && is_fence(*request)) remember(*request, reply);
      if (change) change_value(reply, *decoded);
    }
    if (is_cut || drawn(faults_.lost)) return;
    if (drawn(faults_.late)) return write_later(std::move(reply));
    write(reply);
    if (drawn(faults_.doubled)) write(reply);
  }
  bool drawn(int of_thousand) { return random_.between(0, 999) < of_thousand; }

  template <class Reply>
  void write_later(Reply reply) {
    const auto timer = std::make_shared<tmcl::Timer>(context_->get_executor());
    timer->expires_after(tmcl::Duration(random_.between(1, faults_.latest.count())));
    timer->async_wait([this, timer, reply = std::move(reply)](const auto& error) {
      if (!error) write(reply);
    });
  }

  void write(const Bytes& bytes) {
    trace_->add(clock_.now(), name_ + " >", bytes);
    (void)far_->write(bytes);
  }
  void write(const tmcl::CanFrame& frame) {
    trace_->add(clock_.now(), name_ + " >", frame.data);
    (void)far_->write_frame(frame);
  }

  boost::asio::io_context* context_;
  std::string name_;
  tmcl::Framing framing_;
  Faults faults_;
  tmcl::test::Random<> random_;
  Trace* trace_;
  tmcl::ContextClock clock_;
  tmcl::sim::Bench bench_;
  tmcl::sim::Scheduler scheduler_;
  tmcl::sim::SerialLine serial_;
  tmcl::sim::CanLine can_;
  std::unique_ptr<tmcl::Link> far_;
  boost::asio::posix::stream_descriptor readiness_;
  std::size_t requests_ = 0;
  std::map<Key, Bytes> forged_;
  std::map<Key, tmcl::CanFrame> forged_frames_;
  std::map<std::uint8_t, std::deque<tmcl::Request>> asked_;  ///< By module, not answered yet.
};

}  // namespace tmcld::test
