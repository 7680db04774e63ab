/// A link and the engine that drives it: what the bus on Asio and the blocking bus share.
#pragma once

#include <functional>
#include <span>

#include "engine/bus_engine.hpp"
#include "tmcl/address.hpp"
#include "tmcl/link.hpp"
#include "tmcl/traffic.hpp"

namespace tmcl {

class BusCore {
 public:
  BusCore(Link link, BusOptions options);

  engine::BusEngine& engine() { return engine_; }
  const engine::BusEngine& engine() const { return engine_; }
  int descriptor() const { return link_.descriptor(); }
  const std::string& name() const { return engine_.options().name; }
  bool is_open() const { return open_; }
  /// Part of a datagram is still to be written: tell on_writable() when the link has room again.
  bool wants_to_write() const { return !unwritten_.empty(); }

  void on_readable(TimePoint now);
  void on_writable(TimePoint now);
  /// Ends everything in progress; the descriptor stays open, because a waiter may still use it.
  void close(const std::string& why);
  /// A stop goes out past the engine, which may have no memory to send one, and takes none. Waits
  /// a moment for the answer on a serial line, whose modules would speak at once otherwise.
  void stop_at_once(AxisAddress motor) noexcept;
  /// The engine sends no movement any more.
  void refuse_movements() noexcept { refuses_movements_ = true; }
  /// Called for everything that is written and read; may be empty.
  void on_traffic(OnTraffic listener) { on_traffic_ = std::move(listener); }
  /// Closes the descriptor, so that the link can be opened again at once.
  void drop_link() { const Link closed = std::move(link_); }

  /// Does what the engine wants done: writes go to the link, the rest to the two sinks.
  void run_actions(TimePoint now, const std::function<void(engine::Completion)>& on_completion,
                   const std::function<void(const BusEvent&)>& on_event);

 private:
  bool read(TimePoint now, const Request* next);
  bool read_bytes(TimePoint now, const Request* next);
  bool read_frames(TimePoint now, const Request* next);
  void send(const engine::Send& send, TimePoint now);
  void send_bytes(const engine::Send& send, TimePoint now);
  void write_stop(const Request& stop);
  void await_silence();
  void send_frame(const engine::Send& send, TimePoint now);
  void tell(const Traffic& traffic) const {
    if (on_traffic_) on_traffic_(traffic);
  }

  Link link_;
  engine::BusEngine engine_;
  bool open_ = true;
  SerialBytes unfinished_{};
  std::span<const std::uint8_t> unwritten_;
  std::vector<BusEvent> conditions_;
  OnTraffic on_traffic_;
  bool refuses_movements_ = false;
  unsigned looks_ = 0;  ///< For input before a request, that have found some, in a row.
};

}  // namespace tmcl
