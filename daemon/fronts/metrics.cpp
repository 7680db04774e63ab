#include "fronts/metrics.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include "async/gather.hpp"
#include "gateway/module/fault_report.hpp"
#include "tmcl/bus_options.hpp"

namespace tmcld {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

struct Counted {
  const char* name;
  const char* help;
  std::uint64_t tmcl::BusCounters::*of;
};
constexpr auto counters = std::to_array<Counted>({
    {"tmcl_requests_total", "Datagrams that were sent.", &tmcl::BusCounters::requests},
    {"tmcl_replies_total", "Answers that were accepted.", &tmcl::BusCounters::replies},
    {"tmcl_timeouts_total", "Requests without an answer in time.", &tmcl::BusCounters::timeouts},
    {"tmcl_late_replies_total", "Answers to requests that had been given up.",
     &tmcl::BusCounters::late_replies},
    {"tmcl_surplus_replies_total", "Replies beyond what a module was asked for.",
     &tmcl::BusCounters::surplus},
    {"tmcl_garbage_bytes_total", "Bytes that belonged to no datagram.",
     &tmcl::BusCounters::garbage_bytes},
    {"tmcl_fences_total", "Exchanges that proved that a module is in step.",
     &tmcl::BusCounters::fences},
});

void set(ClientMetric& metric, MetricType type, double value) {
  if (type == MetricType::Counter) metric.counter.value = value;
  if (type == MetricType::Gauge) metric.gauge.value = value;
}

class Page {
 public:
  /// Of a new family, or of the last one.
  void add(const char* name, const char* help, MetricType type, Labels labels, double value) {
    if (families_.empty() || families_.back().name != name)
      families_.push_back({name, help, type, {}});
    ClientMetric metric;
    metric.label = std::move(labels);
    set(metric, type, value);
    families_.back().metric.push_back(std::move(metric));
  }

  void add(const char* name, const char* help, const Latency& latency) {
    auto& family = families_.emplace_back(MetricFamily{name, help, MetricType::Histogram, {}});
    auto& histogram = family.metric.emplace_back().histogram;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < latency.counts().size(); ++i) {
      count += latency.counts()[i];
      const bool is_last = i == Latency::bounds_s.size();
      histogram.bucket.push_back(
          {count, is_last ? std::numeric_limits<double>::infinity() : Latency::bounds_s.at(i)});
    }
    histogram.sample_count = count;
    histogram.sample_sum = latency.sum_s();
  }

  std::string text() const {
    std::ostringstream text;
    prometheus::TextSerializer().Serialize(text, families_);
    return text.str();
  }

 private:
  std::vector<MetricFamily> families_;
};

void add_buses(Page& page, const Gateway& gateway) {
  for (const auto& counter : counters) {
    for (const auto& bus : gateway.buses()) {
      page.add(counter.name, counter.help, MetricType::Counter, {{"bus", bus->name()}},
               static_cast<double>(bus->link().counters().*counter.of));
    }
  }
  for (const auto& bus : gateway.buses()) {
    page.add("tmcl_bus_open", "1 while the link of the bus is open.", MetricType::Gauge,
             {{"bus", bus->name()}}, bus->state() == GatewayBus::State::open ? 1 : 0);
  }
  for (const auto& bus : gateway.buses()) {
    page.add("tmcl_bus_queue", "Exchanges that wait for their turn.", MetricType::Gauge,
             {{"bus", bus->name()}}, static_cast<double>(bus->queued()));
  }
}

void add_axes(Page& page, const Gateway& gateway) {
  const auto add = [&](const char* name, const char* help, auto&& is_so) {
    for (const auto& axis : gateway.axes()) {
      page.add(name, help, MetricType::Gauge, {{"axis", axis->name()}, {"bus", axis->bus().name()}},
               is_so(*axis) ? 1 : 0);
    }
  };
  add("tmcl_axis_up", "1 while the module of the axis answers.",
      [](const GatewayAxis& axis) { return axis.module().state() == GatewayModule::State::ready; });
  add("tmcl_axis_latched", "1 while the axis stands until a client says that it may move.",
      [](const GatewayAxis& axis) { return axis.latched().has_value(); });
  add("tmcl_axis_referenced", "1 if the axis has found its reference.",
      [](const GatewayAxis& axis) { return axis.is_referenced(); });
  add("tmcl_axis_fault", "1 while the driver of the axis or its supply reports a fault.",
      [](const GatewayAxis& axis) { return !axis.faults().empty(); });
  add("tmcl_axis_led", "1 while tmcld leads the axis: on a line, a path or a search.",
      [](const GatewayAxis& axis) { return axis.claim_kind() != ClaimKind::none; });
}

// ---- what axes do -------------------------------------------------------------------------------

/// Nothing: that axis is left out.
using Value = std::optional<double>;

/// A family with a value for each axis that has one.
template <class ValueOf>
void add_measured(Page& page, const std::vector<AxisMeasurements>& axes, const char* name,
                  const char* help, bool has_unit, ValueOf value_of) {
  for (const auto& one : axes) {
    const Value value = value_of(one);
    if (!value) continue;
    Labels labels{{"axis", one.axis->name()}, {"bus", one.axis->bus().name()}};
    if (has_unit) {
      const auto& unit = one.axis->unit();
      labels.push_back({"unit", unit.empty() ? "microsteps" : unit});
    }
    page.add(name, help, MetricType::Gauge, std::move(labels), *value);
  }
}

void add_measured_axes(Page& page, const std::vector<AxisMeasurements>& axes) {
  add_measured(page, axes, "tmcl_axis_position", "Where the axis is, in its unit.", true,
               [](const AxisMeasurements& one) -> Value {
                 if (!one.reading) return std::nullopt;
                 const auto& user = one.reading->user;
                 return user ? user->position.value
                             : static_cast<double>(one.reading->state.position.value);
               });
  add_measured(page, axes, "tmcl_axis_target", "Where it was sent to, in its unit.", true,
               [](const AxisMeasurements& one) -> Value {
                 if (!one.reading) return std::nullopt;
                 const auto& user = one.reading->user;
                 return user ? user->target.value
                             : static_cast<double>(one.reading->state.target.value);
               });
  add_measured(page, axes, "tmcl_axis_velocity", "Its speed, in its unit per second.", true,
               [](const AxisMeasurements& one) -> Value {
                 if (!one.reading) return std::nullopt;
                 const auto& user = one.reading->user;
                 if (user && user->velocity) return user->velocity->value;
                 return one.axis->unit().empty() ? one.reading->velocity_pps : std::nullopt;
               });
  add_measured(page, axes, "tmcl_axis_moving", "1 while the axis moves.", false,
               [](const AxisMeasurements& one) -> Value {
                 if (!one.reading) return std::nullopt;
                 return one.reading->state.velocity.value != 0 ? 1 : 0;
               });
  add_measured(page, axes, "tmcl_supply_volts", "Supply of the motor, by its module.", false,
               [](const AxisMeasurements& one) { return one.axis->supply_volts(); });
  add_measured(page, axes, "tmcl_temperature_celsius", "Temperature of the module.", false,
               [](const AxisMeasurements& one) { return one.temperature_celsius; });
}

/// Each flag that a driver may have, so that an alert sees one end.
void add_errors(Page& page, const Gateway& gateway) {
  for (const auto& axis : gateway.axes()) {
    for (const auto flag : driver_flags()) {
      const bool is_set = std::ranges::count(axis->faults(), flag) > 0;
      page.add("tmcl_axis_error", "1 while the driver of the axis or its supply reports this.",
               MetricType::Gauge,
               {{"axis", axis->name()}, {"bus", axis->bus().name()}, {"flag", std::string(flag)}},
               is_set ? 1 : 0);
    }
  }
}

using boost::asio::awaitable;

constexpr tmcl::Duration new_enough = std::chrono::seconds(1);

/// `is_first`: of the axes of its module, which has one temperature.
awaitable<AxisMeasurements> measure(std::shared_ptr<GatewayAxis> axis, bool is_first) {
  AxisMeasurements measured{axis, std::nullopt, std::nullopt};
  if (axis->module().state() != GatewayModule::State::ready) co_return measured;
  const auto reading = co_await axis->read_state(new_enough);
  if (!reading) co_return measured;
  measured.reading = *reading;
  if (!is_first) co_return measured;
  const auto temperature =
      co_await axis->perform(read_temperature(axis->address().module), asked_by(0));
  if (temperature) measured.temperature_celsius = *temperature;
  co_return measured;
}

/// One that speaks for a user is a connection of that user's.
std::size_t relays_of(const Gateway& gateway) {
  return static_cast<std::size_t>(std::ranges::count_if(
      gateway.clients()->rows(), [](const auto& client) { return client.second.look().relays; }));
}

}  // namespace

awaitable<std::vector<AxisMeasurements>> measure_axes(std::shared_ptr<Gateway> gateway) {
  std::vector<awaitable<AxisMeasurements>> tasks;
  std::set<const GatewayModule*> modules;
  for (const auto& axis : gateway->axes())
    tasks.push_back(measure(axis, modules.insert(&axis->module()).second));
  if (tasks.empty()) co_return std::vector<AxisMeasurements>();
  auto measured = co_await gather(std::move(tasks));
  co_return measured;
}

std::string metrics_text(const Gateway& gateway, const std::vector<AxisMeasurements>& axes,
                         const Latency& stops, std::size_t clients) {
  Page page;
  page.add("tmcl_build_info", "1, for what is running.", MetricType::Gauge,
           {{"version", TMCL_VERSION}}, 1);
  add_buses(page, gateway);
  page.add("tmcl_stop_seconds", "From when a stop came in until it was answered.", stops);
  add_axes(page, gateway);
  add_measured_axes(page, axes);
  add_errors(page, gateway);
  page.add("tmcl_leases", "Leases that clients have.", MetricType::Gauge, {},
           static_cast<double>(gateway.leases()->all().size()));
  page.add("tmcl_http_clients", "Clients that are connected by HTTP.", MetricType::Gauge, {},
           static_cast<double>(clients));
  page.add("tmcl_relays", "Connections of relays, such as tmcld-mqtt, in their own name.",
           MetricType::Gauge, {}, static_cast<double>(relays_of(gateway)));
  return page.text();
}

}  // namespace tmcld
