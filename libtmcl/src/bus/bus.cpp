#include "tmcl/bus.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include <boost/asio/async_result.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "bus/bus_core.hpp"
#include "tmcl/timer.hpp"

namespace tmcl {

namespace asio = boost::asio;
using boost::system::error_code;

/// Lives as long as the bus or an operation of the reactor needs it.
class Bus::State : public std::enable_shared_from_this<State> {
 public:
  State(asio::any_io_executor executor, Link link, BusOptions options)
      : executor_(executor),
        core_(std::move(link), std::move(options)),
        readiness_(executor, core_.descriptor()),
        timer_(executor) {}

  // The link closes the descriptor, not Asio.
  ~State() {
    if (readiness_.is_open()) readiness_.release();
  }

  void start() { await_input(); }

  void close(const std::string& why) {
    if (core_.is_open()) core_.close(why);
    run_actions();
    hand_out_later();
  }

  using Handler = asio::async_result<asio::use_awaitable_t<>, void()>::handler_type;

  /// There is a result for each exchange, and the resumed coroutine keeps them.
  void exchange(std::span<const step::Exchange> exchanges, std::span<Result<Answer>> results,
                Handler handler) {
    if (exchanges.empty()) return asio::post(executor_, std::move(handler));
    auto& group = new_group(std::move(handler), exchanges.size());
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
      const auto ticket = next_ticket_++;
      waiting_.push_back({ticket, &group, &results[i]});
      core_.engine().submit(ticket, exchanges[i].request, exchanges[i].options, timer_.now());
    }
    run_actions();
    hand_out_later();
  }

  void end_unwanted_reads() {
    core_.engine().end_unwanted_reads(timer_.now());
    run_actions();
    hand_out_later();
  }

  BusCore& core() { return core_; }
  asio::any_io_executor executor() const { return executor_; }
  std::function<void(const BusEvent&)> on_event;

 private:
  /// Exchanges that one caller waits for together.
  struct Group {
    std::optional<Handler> handler;
    std::size_t missing = 0;
  };
  struct Place {
    engine::Ticket ticket;
    Group* group;
    Result<Answer>* result;
  };

  /// Groups are used again and again: an exchange takes no memory.
  Group& new_group(Handler handler, std::size_t missing) {
    if (unused_.empty()) {
      // One that ends must find its room.
      settled_.reserve(groups_.size() + 1);
      unused_.reserve(groups_.size() + 1);
      unused_.push_back(&groups_.emplace_back());
    }
    auto& group = *unused_.back();
    unused_.pop_back();
    group.handler.emplace(std::move(handler));
    group.missing = missing;
    return group;
  }

  void await_input() {
    readiness_.async_wait(asio::posix::stream_descriptor::wait_read,
                          [self = shared_from_this()](error_code error) {
                            if (!error) self->on_input();
                          });
  }

  void on_input() {
    try {
      core_.on_readable(timer_.now());
      run_actions();
      // Results first: setting up the next wait is a call of the kernel.
      hand_out();
    } catch (...) {
      // What ends by it still has to stop motors, and to hear whether they are.
      if (core_.is_open()) await_input();
      throw;
    }
    if (core_.is_open()) await_input();
  }

  void await_room() {
    if (awaiting_room_ || !core_.wants_to_write()) return;
    readiness_.async_wait(asio::posix::stream_descriptor::wait_write,
                          [self = shared_from_this()](error_code error) {
                            self->awaiting_room_ = false;
                            if (error) return;
                            self->core_.on_writable(self->timer_.now());
                            self->run_actions();
                            self->hand_out();
                          });
    awaiting_room_ = true;
  }

  /// A timer that is set too early only makes a round for nothing; setting it anew for each
  /// exchange costs more.
  void await_deadline() {
    const auto deadline = core_.engine().next_deadline();
    if (!deadline || (armed_for_ && *armed_for_ <= *deadline)) return;
    armed_for_.reset();
    timer_.expires_at(*deadline);
    timer_.async_wait([self = shared_from_this()](error_code error) {
      if (error) return;
      self->armed_for_.reset();
      self->core_.engine().on_deadline(self->timer_.now());
      self->run_actions();
      self->hand_out();
    });
    armed_for_ = deadline;
  }

  void run_actions() {
    core_.run_actions(
        timer_.now(), [this](engine::Completion completion) { settle(std::move(completion)); },
        [this](const BusEvent& event) { publish(event); });
    if (core_.is_open()) {
      await_room();
      await_deadline();
    } else {
      let_go();
    }
  }

  /// Verbs that have not ended yet keep this object alive, but not the link.
  void let_go() {
    timer_.cancel();
    if (!readiness_.is_open()) return;
    // Waits for the descriptor end here: the reactor does not know it any more, and it can go.
    readiness_.release();
    core_.drop_link();
  }

  void settle(engine::Completion completion) {
    const auto place = std::ranges::find(waiting_, completion.ticket, &Place::ticket);
    *place->result = std::move(completion.result);
    auto* group = place->group;
    waiting_.erase(place);
    if (--group->missing == 0) settled_.push_back(group);
  }

  /// Last in a round of the reactor: a waiter goes on here, and may submit the next request.
  void hand_out() {
    for (auto left = settled_.size(); left > 0; --left) {
      auto* group = settled_.front();
      settled_.erase(settled_.begin());
      auto handler = std::move(*group->handler);
      group->handler.reset();
      unused_.push_back(group);
      std::move(handler)();
    }
  }

  /// The submitter of a request is not yet ready for its result.
  void hand_out_later() {
    if (settled_.empty()) return;
    asio::post(executor_, [self = shared_from_this()] { self->hand_out(); });
  }

  void publish(const BusEvent& event) {
    asio::post(executor_, [self = shared_from_this(), event] {
      if (self->on_event) self->on_event(event);
    });
  }

  asio::any_io_executor executor_;
  BusCore core_;
  asio::posix::stream_descriptor readiness_;
  Timer timer_;
  std::optional<TimePoint> armed_for_;
  bool awaiting_room_ = false;
  engine::Ticket next_ticket_ = 0;
  std::deque<Group> groups_;
  std::vector<Group*> unused_;
  std::vector<Group*> settled_;
  std::vector<Place> waiting_;
};

Bus::Bus(asio::any_io_executor executor, Link link, BusOptions options)
    : clock_(executor),
      state_(std::make_shared<State>(std::move(executor), std::move(link), std::move(options))) {
  state_->start();
}
Bus::Bus(Bus&&) noexcept = default;
Bus& Bus::operator=(Bus&& other) noexcept {
  if (state_) close();
  clock_ = other.clock_;
  state_ = std::move(other.state_);
  return *this;
}
Bus::~Bus() {
  if (state_) close();
}

namespace {

/// Suspends the coroutine, which keeps what is referred to, until every exchange has ended.
template <class State>
asio::awaitable<void> exchange(State& state, std::span<const step::Exchange> exchanges,
                               std::span<Result<Answer>> results) {
  return asio::async_initiate<const asio::use_awaitable_t<>, void()>(
      [&state, exchanges, results](auto handler) {
        state.exchange(exchanges, results, std::move(handler));
      },
      asio::use_awaitable);
}

}  // namespace

asio::awaitable<Result<Answer>> Bus::execute(Request request, CallOptions options) {
  const auto state = state_;  // the bus may be gone before the exchange has ended
  const step::Exchange one{request, std::move(options)};
  Result<Answer> result;
  co_await exchange(*state, {&one, 1}, {&result, 1});
  co_return result;
}

asio::awaitable<std::optional<Error>> Bus::run_steps(std::shared_ptr<State> state,
                                                     ContextClock clock, AnyScript& script,
                                                     RunOptions options) {
  auto step = script.start(clock.now());
  while (step) {
    auto objection = options.objection ? options.objection() : std::nullopt;
    if (objection) co_return objection;
    const bool is_exchange = std::holds_alternative<step::Exchange>(*step);
    const auto asked = clock.now();
    auto result = co_await perform(state, std::move(*step), options.deadline);
    const auto now = clock.now();
    if (options.on_answer && is_exchange && result.front()) options.on_answer(now - asked);
    step = script.resume(std::move(result), now);
  }
  co_return std::nullopt;
}

asio::awaitable<StepResult> Bus::perform(std::shared_ptr<State> state, Step step,
                                         std::optional<TimePoint> deadline) {
  if (auto* pause = std::get_if<step::Pause>(&step)) {
    Timer timer(state->executor());
    timer.expires_after(pause->duration);
    co_await timer.async_wait(asio::use_awaitable);
    co_return StepResult{};
  }
  std::vector<step::Exchange> exchanges;
  if (auto* one = std::get_if<step::Exchange>(&step)) {
    exchanges.push_back(std::move(*one));
  } else {
    exchanges = std::move(std::get<step::ExchangeAll>(step).exchanges);
  }
  for (auto& one : exchanges) {
    auto& own = one.options.deadline;
    if (!own || (deadline && *deadline < *own)) own = deadline;
  }
  StepResult results(exchanges.size(), Result<Answer>{});
  co_await exchange(*state, exchanges, results);
  co_return results;
}

void Bus::on_event(std::function<void(const BusEvent&)> handler) {
  state_->on_event = std::move(handler);
}
void Bus::on_traffic(OnTraffic handler) { state_->core().on_traffic(std::move(handler)); }
std::size_t Bus::queued() const { return state_->core().engine().queued(); }
BusCounters Bus::counters() const { return state_->core().engine().counters(); }
const std::string& Bus::name() const { return state_->core().name(); }
bool Bus::is_open() const { return state_->core().is_open(); }
void Bus::stop_at_once(AxisAddress motor) noexcept { state_->core().stop_at_once(motor); }
void Bus::end_unwanted_reads() { state_->end_unwanted_reads(); }
void Bus::refuse_movements() noexcept { state_->core().refuse_movements(); }
void Bus::close() { state_->close("the bus was closed"); }

}  // namespace tmcl
