#include "gateway/bus_link.hpp"

#include <utility>

#include "async/elsewhere.hpp"

namespace tmcld {
namespace {

tmcl::BusCounters sum(tmcl::BusCounters a, const tmcl::BusCounters& b) {
  a.requests += b.requests;
  a.replies += b.replies;
  a.timeouts += b.timeouts;
  a.late_replies += b.late_replies;
  a.unexpected_replies += b.unexpected_replies;
  a.garbage_bytes += b.garbage_bytes;
  a.fences += b.fences;
  a.surplus += b.surplus;
  a.suspect += b.suspect;
  return a;
}

}  // namespace

std::string_view name_of(BusLink::State state) {
  switch (state) {
    case BusLink::State::opening: return "opening";
    case BusLink::State::open: return "open";
    case BusLink::State::lost: return "lost";
  }
  return {};
}

BusLink::BusLink(const boost::asio::any_io_executor& executor, const BusConfig& config,
                 OpenLink open)
    : executor_(executor),
      config_(config),
      open_(std::move(open)),
      traffic_(std::make_shared<TrafficLog>(std::holds_alternative<tmcl::CanName>(config.link)
                                                ? tmcl::Framing::can
                                                : tmcl::Framing::serial,
                                            config.bus_options.host_address)),
      heard_(std::make_shared<tmcl::Heard>(config.bus_options.host_address)) {}

bool BusLink::note_error(std::string why) {
  if (why == error_) return false;
  error_ = std::move(why);
  return true;
}

tmcl::BusCounters BusLink::counters() const {
  return bus_ ? sum(earlier_counters_, bus_->counters()) : earlier_counters_;
}

boost::asio::awaitable<tmcl::Result<tmcl::Link>> BusLink::open() {
  is_opening_ = true;
  auto work = [open = open_, config = config_] { return open(config); };
  auto link = co_await elsewhere(opener_, std::move(work));
  is_opening_ = false;
  co_return link;
}

bool BusLink::attach(tmcl::Link link, std::function<void(const tmcl::BusEvent&)> on_event) {
  const bool was_lost = state_ == State::lost;
  bus_ = std::make_shared<tmcl::Bus>(executor_, std::move(link), config_.bus_options);
  bus_->on_event(std::move(on_event));
  hear_anew();
  bus_->on_traffic([log = traffic_, heard = heard_](const tmcl::Traffic& traffic) {
    log->note(traffic);
    heard->note(traffic);
  });
  state_ = State::open;
  error_.clear();
  return was_lost;
}

void BusLink::detach() {
  earlier_counters_ = counters();
  bus_->on_event({});
  bus_.reset();
  state_ = State::lost;
  if (error_.empty()) error_ = "the link was lost";
}

}  // namespace tmcld
