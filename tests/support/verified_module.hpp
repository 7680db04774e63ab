/// A simulated module that is verified, in a time of its own: exchanges take as long as on a line.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <variant>
#include <vector>

#include "support/lone_module.hpp"
#include "tmcl/verification.hpp"

namespace tmcl::test {

class VerifiedModule {
 public:
  VerifiedModule(const Model& model, const sim::ModuleSettings& settings,
                 const sim::StageSettings& stage = {})
      : lone(model.number, stage, settings), model_(&model) {}

  /// What an exchange takes, from .. to.
  std::pair<Duration, Duration> exchange_time{std::chrono::microseconds(400),
                                              std::chrono::microseconds(1200)};
  std::mt19937_64 random{1};
  /// The exchange of this number fails: the module has seen it, or has not.
  std::optional<std::size_t> failing;
  bool fails_unseen = false;
  /// Asked after every exchange.
  std::function<void()> after_each;

  VerifyOptions options() {
    VerifyOptions options;
    options.model = model_;
    options.travel = {-100, 100};
    options.free_address = ModuleAddress{9};
    options.strays = [this] { return strays_; };
    for (const auto parameter : verify_parameters(*model_))
      options.settings.push_back({parameter, get(parameter)});
    return options;
  }
  Result<Verification> verify() { return verify(options()); }
  Result<Verification> verify(const VerifyOptions& options) {
    return run(verbs::verify({ModuleAddress{1}, 0}, options));
  }
  std::int32_t get(std::uint8_t parameter) { return lone.ask(Command::GAP, parameter, 0).value; }
  std::size_t exchanges() const { return exchanges_; }
  void pass(Duration time) { lone.look_at(lone.clock.now() + time); }

  template <class T>
  T run(Script<T> script) {
    auto step = script.start(lone.clock.now());
    while (step) {
      StepResult results;
      if (const auto* rest = std::get_if<step::Pause>(&*step)) {
        pass(rest->duration);
      } else if (const auto* one = std::get_if<step::Exchange>(&*step)) {
        results.push_back(exchange(*one));
      } else {
        for (const auto& each : std::get<step::ExchangeAll>(*step).exchanges)
          results.push_back(exchange(each));
      }
      step = script.resume(std::move(results), lone.clock.now());
    }
    return script.take();
  }

  LoneModule lone;

 private:
  Duration some_time() {
    const auto [least, most] = exchange_time;
    return Duration(
               std::uniform_int_distribution<std::int64_t>(least.count(), most.count())(random)) /
           2;
  }
  static Error silence() {
    Error error;
    error.code = Errc::reply_timeout;
    error.outcome = Outcome::unknown;
    return error;
  }
  Result<Answer> exchange(const step::Exchange& step) {
    Answer answer;
    answer.sent = lone.clock.now();
    const bool fails = failing == exchanges_++;
    pass(some_time());
    const bool is_other = !(step.request.address == ModuleAddress{1});
    if (fails && fails_unseen) return tl::unexpected(silence());
    if (is_other) {
      const auto addressing =
          lone.module.settings().traits.get<Addressing>(Trait::addressing, *model_);
      strays_ += addressing == Addressing::any ? 1 : 0;
      return tl::unexpected(silence());
    }
    const auto said = lone.ask(step.request);
    pass(some_time());
    if (after_each) after_each();
    if (fails) return tl::unexpected(silence());
    answer.reply = {2, 1, said.status, step.request.command, said.value};
    answer.received = lone.clock.now();
    if (!is_success(said.status)) {
      auto error = silence();
      error.code = Errc::refused_by_module;
      error.outcome = Outcome::refused;
      error.status = said.status;
      return tl::unexpected(error);
    }
    return answer;
  }

  const Model* model_;
  std::uint64_t strays_ = 0;
  std::size_t exchanges_ = 0;
};

}  // namespace tmcl::test
