#include <algorithm>
#include <cerrno>
#include <ctime>
#include <span>

#include <poll.h>

#include "bus/bus_core.hpp"
#include "tmcl/blocking.hpp"

namespace tmcl::blocking {
namespace {

timespec to_timespec(Duration duration) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  return {seconds.count(), (duration - seconds).count()};
}

}  // namespace

class Bus::State {
 public:
  State(Link link, BusOptions options) : core_(std::move(link), std::move(options)) {}

  /// There is a result for each exchange.
  void exchange(std::span<const step::Exchange> exchanges, std::span<Result<Answer>> results) {
    first_ticket_ = next_ticket_;
    next_ticket_ += exchanges.size();
    results_ = results;
    missing_ = exchanges.size();
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
      core_.engine().submit(first_ticket_ + i, exchanges[i].request, exchanges[i].options,
                            clock_.now());
    }
    run_actions();
    while (missing_ > 0) wait_and_work(core_.engine().next_deadline());
  }

  void pause(Duration duration) {
    const auto end = clock_.now() + duration;
    while (clock_.now() < end) {
      const auto deadline = core_.engine().next_deadline();
      wait_and_work(deadline ? std::min(*deadline, end) : end);
    }
  }

  BusCore& core() { return core_; }
  std::function<void(const BusEvent&)> on_event;

 private:
  void wait_and_work(std::optional<TimePoint> until) {
    const auto room = core_.wants_to_write() ? POLLIN | POLLOUT : POLLIN;
    pollfd waiting{core_.is_open() ? core_.descriptor() : -1, static_cast<short>(room), 0};
    const auto patience = until ? std::max(Duration{}, *until - clock_.now()) : Duration{};
    const auto timeout = to_timespec(patience);
    const int ready = ppoll(&waiting, 1, until ? &timeout : nullptr, nullptr);
    const auto now = clock_.now();
    if (ready < 0 && errno != EINTR) core_.close("waiting for the link failed");
    if (ready > 0 && (waiting.revents & POLLOUT) != 0) core_.on_writable(now);
    if (ready > 0 && (waiting.revents & ~POLLOUT) != 0) core_.on_readable(now);
    const auto deadline = core_.engine().next_deadline();
    if (deadline && *deadline <= now) core_.engine().on_deadline(now);
    run_actions();
  }

  void run_actions() {
    core_.run_actions(
        clock_.now(),
        [this](engine::Completion completion) {
          results_[completion.ticket - first_ticket_] = std::move(completion.result);
          --missing_;
        },
        [this](const BusEvent& event) {
          if (on_event) on_event(event);
        });
    if (!core_.is_open()) core_.drop_link();
  }

  RealClock clock_;
  BusCore core_;
  engine::Ticket next_ticket_ = 0;
  engine::Ticket first_ticket_ = 0;
  std::span<Result<Answer>> results_;  ///< Of the exchanges that are waited for.
  std::size_t missing_ = 0;
};

Result<Bus> Bus::open(std::string_view link_name, const LinkOptions& link_options,
                      BusOptions options) {
  auto link = Link::open(link_name, link_options);
  if (!link) return tl::unexpected(std::move(link.error()));
  return Bus(std::move(*link), std::move(options));
}

Bus::Bus(Link link, BusOptions options)
    : state_(std::make_unique<State>(std::move(link), std::move(options))) {}
Bus::Bus(Bus&&) noexcept = default;
Bus& Bus::operator=(Bus&&) noexcept = default;
Bus::~Bus() = default;

Result<Answer> Bus::execute(const Request& request, const CallOptions& options) {
  const step::Exchange one{request, options};
  Result<Answer> result;
  state_->exchange({&one, 1}, {&result, 1});
  return result;
}

StepResult Bus::perform(Step step) {
  if (const auto* pause = std::get_if<step::Pause>(&step)) {
    state_->pause(pause->duration);
    return {};
  }
  const auto* many = std::get_if<step::ExchangeAll>(&step);
  const auto exchanges = many != nullptr ? std::span<const step::Exchange>(many->exchanges)
                                         : std::span(&std::get<step::Exchange>(step), 1);
  StepResult results(exchanges.size(), Result<Answer>{});
  state_->exchange(exchanges, results);
  return results;
}

void Bus::on_event(std::function<void(const BusEvent&)> handler) {
  state_->on_event = std::move(handler);
}
BusCounters Bus::counters() const { return state_->core().engine().counters(); }
const std::string& Bus::name() const { return state_->core().name(); }
bool Bus::is_open() const { return state_->core().is_open(); }

}  // namespace tmcl::blocking
