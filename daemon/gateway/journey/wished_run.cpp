#include "gateway/journey/wished_run.hpp"

#include <exception>
#include <utility>

namespace tmcld {

using boost::asio::awaitable;

awaitable<void> WishedRun::run(std::shared_ptr<WishedRun> self) {
  std::exception_ptr thrown;
  try {
    self->refusal_ = co_await pass(self);
  } catch (...) {
    thrown = std::current_exception();
  }
  self->is_over_ = true;
  self->over();
  self->tell();
  if (thrown) std::rethrow_exception(thrown);
}

GatewayAxis::Awaitable<void> WishedRun::outcome(std::shared_ptr<WishedRun> self,
                                                std::uint64_t wish) {
  while (!self->is_over_ && self->carried_out() < wish)
    co_await until_told(self, tmcl::TimePoint::max());
  if (self->carried_out() >= wish) co_return tmcl::Result<void>{};
  co_return tl::unexpected(self->failure_of_run());
}

awaitable<tmcl::TimePoint> WishedRun::before_step() {
  tell();
  co_return tmcl::TimePoint::max();
}

tmcl::Error WishedRun::failure_of_run() const {
  if (refusal_) return *refusal_;
  const auto& fault = report().fault;
  if (fault && fault->error) return *fault->error;
  auto error = tmcl::not_sent(tmcl::Errc::move_interrupted,
                              fault ? text_of(*fault) : what_it_is() + " has ended");
  error.outcome = tmcl::Outcome::done;
  error.bus = axis().bus().name();
  return error;
}

}  // namespace tmcld
