#include "gateway/program_end.hpp"

#include <utility>

#include "tmcl/parameter.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;

template <class T>
bool is_refused(const tmcl::Result<T>& result) {
  return !result && result.error().outcome == tmcl::Outcome::refused;
}

/// A firmware that does not tell has no programs, as far as is known. Proven: a late answer to the
/// same question may be from before the program began.
tmcl::Script<tmcl::Result<bool>> ask_whether_program_runs(tmcl::ModuleAddress module) {
  constexpr auto status = tmcl::global_parameter::application_status;
  const tmcl::Request question{module, tmcl::Command::GGP, status, 0, 0};
  tmcl::CallOptions options;
  options.proof = tmcl::Proof::followed;
  const auto answer = co_await tmcl::exchange(question, options);
  if (answer) co_return answer->reply.value != 0;
  if (answer.error().outcome == tmcl::Outcome::refused) co_return false;
  co_return tl::unexpected(answer.error());
}

awaitable<tmcl::Result<bool>> runs_program(const StoppedModule& module, std::uint64_t client) {
  if (module.bus->motors().may_run_program(module.address)) co_return true;
  auto runs = co_await module.bus->run(ask_whether_program_runs(module.address), asked_by(client));
  co_return runs;
}

awaitable<tmcl::Result<bool>> end_if_it_runs(const StoppedModule& module, std::uint64_t client) {
  auto runs = co_await runs_program(module, client);
  if (!runs || !*runs) co_return runs;
  auto ended =
      co_await module.bus->run(tmcl::verbs::stop_program(module.address), asked_by(client));
  if (!ended) co_return tl::unexpected(std::move(ended.error()));
  for (const auto motor : module.motors) {
    ended = co_await module.bus->run(tmcl::verbs::stop_reference_search(motor), asked_by(client));
    if (!ended && !is_refused(ended)) co_return tl::unexpected(std::move(ended.error()));
  }
  co_return true;
}

void owe_end(const StoppedModule& module) {
  auto& gate = module.bus->gate();
  gate.owe({module.address, tmcl::Command::STOP_APPLICATION, 0, 0, 0});
  for (const auto motor : module.motors)
    gate.owe({motor.module, tmcl::Command::MST, 0, motor.motor, 0});
}

}  // namespace

awaitable<tmcl::Result<bool>> end_program(StoppedModule module, std::uint64_t client) {
  tmcl::Result<bool> ended = false;
  if (module.has_answered) ended = co_await end_if_it_runs(module, client);
  if (module.has_answered && (ended || is_refused(ended))) co_return ended;
  owe_end(module);
  if (!ended) {
    ended.error().hint = owed_stop_hint;
    // It is looked for, and then pays.
    if (auto* silent = module.bus->find_module(module.address)) silent->note(ended.error());
  }
  co_return ended;
}

}  // namespace tmcld
