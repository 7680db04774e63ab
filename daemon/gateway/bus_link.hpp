/// The link of a bus: opened on a thread of its own, lost, and opened again.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "async/workers.hpp"
#include "config/config.hpp"
#include "gateway/traffic_log.hpp"
#include "tmcl/bus.hpp"
#include "tmcl/heard.hpp"

namespace tmcld {

/// How a link is opened. May block; called on a thread of its own.
using OpenLink = std::function<tmcl::Result<tmcl::Link>(const BusConfig&)>;

class BusLink {
 public:
  enum class State : std::uint8_t { opening, open, lost };

  BusLink(const boost::asio::any_io_executor& executor, const BusConfig& config, OpenLink open);

  State state() const { return state_; }
  /// Why it is not open; empty while it is.
  const std::string& error() const { return error_; }
  /// False if that was known.
  bool note_error(std::string why);
  /// Null while it is not open.
  const std::shared_ptr<tmcl::Bus>& bus() const { return bus_; }
  /// Since the daemon started, over all openings.
  tmcl::BusCounters counters() const;
  /// What went over it lately.
  const TrafficLog& traffic() const { return *traffic_; }
  /// What it brought since it was opened, or since hear_anew(). Nothing of it holds on CAN.
  const tmcl::Heard& heard() const { return *heard_; }
  void hear_anew() { heard_->begin_anew(); }
  /// One scan at a time: set while one runs.
  bool scanning = false;

  /// Blocks meanwhile.
  tmcl::Result<tmcl::Link> open_now() const { return open_(config_); }
  boost::asio::awaitable<tmcl::Result<tmcl::Link>> open();
  /// A thread may be blocked in the system, and cannot be called back.
  bool is_opening() const { return is_opening_; }
  /// Waits for that thread. After this no link is opened any more.
  void wait_for_opener() { opener_.join(); }
  /// True if one was lost before.
  bool attach(tmcl::Link link, std::function<void(const tmcl::BusEvent&)> on_event);
  void detach();

 private:
  boost::asio::any_io_executor executor_;
  const BusConfig& config_;
  OpenLink open_;
  Workers opener_{1};
  bool is_opening_ = false;
  State state_ = State::opening;
  std::string error_;
  std::shared_ptr<tmcl::Bus> bus_;
  tmcl::BusCounters earlier_counters_;
  std::shared_ptr<TrafficLog> traffic_;
  std::shared_ptr<tmcl::Heard> heard_;
};

std::string_view name_of(BusLink::State state);

}  // namespace tmcld
