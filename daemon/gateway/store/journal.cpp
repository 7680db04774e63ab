#include "gateway/store/journal.hpp"

#include <utility>

#include <boost/asio/this_coro.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/value_to.hpp>

#include "async/elsewhere.hpp"
#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "gateway/store/state_file.hpp"
#include "tmcl/json_text.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;
using boost::asio::awaitable;

// What is held no more stays in the file so long.
constexpr tmcl::Duration follow_interval = std::chrono::seconds(1);
constexpr int known_version = 1;

json::object to_json(const Holding& holding) {
  json::array before;
  for (const auto& [parameter, value] : holding.before)
    before.push_back({{"parameter", parameter}, {"value", value}});
  json::object object{{"bus", holding.bus},
                      {"address", number(holding.motor.module)},
                      {"motor", holding.motor.motor},
                      {"why", holding.why},
                      {"before", std::move(before)}};
  if (const auto& seen = holding.seen) {
    object["seen"] = {
        {"value", seen->value}, {"asked_ms", seen->asked_ms}, {"answered_ms", seen->answered_ms}};
  }
  return object;
}

/// Throws if it is none.
Holding holding_from(const json::value& value) {
  Holding holding{json::value_to<std::string>(value.at("bus")),
                  {tmcl::ModuleAddress{value.at("address").to_number<std::uint16_t>()},
                   value.at("motor").to_number<std::uint8_t>()},
                  json::value_to<std::string>(value.at("why"))};
  for (const auto& setting : value.at("before").as_array())
    holding.before.push_back({setting.at("parameter").to_number<std::uint8_t>(),
                              setting.at("value").to_number<std::int32_t>()});
  if (const auto* seen = value.as_object().if_contains("seen")) {
    holding.seen = {seen->at("value").to_number<std::int32_t>(),
                    seen->at("asked_ms").to_number<std::int64_t>(),
                    seen->at("answered_ms").to_number<std::int64_t>()};
  }
  return holding;
}

std::string text_of(const Holdings& holdings) {
  json::array array;
  for (const auto& holding : holdings) array.push_back(to_json(holding));
  const json::object document{{"version", known_version}, {"axes", std::move(array)}};
  return tmcl::json_text(document) + "\n";
}

}  // namespace

tl::expected<Holdings, std::string> Journal::read(const std::string& path) {
  const auto text = read_state_file(path);
  if (!text) return tl::unexpected(text.error());
  if (!*text) return Holdings();
  try {
    const auto document = json::parse(**text);
    const auto version = document.at("version").to_number<int>();
    if (version != known_version)
      return tl::unexpected(path + " is of version " + std::to_string(version) +
                            ", and this tmcld knows version " + std::to_string(known_version));
    Holdings holdings;
    for (const auto& holding : document.at("axes").as_array())
      holdings.push_back(holding_from(holding));
    return holdings;
  } catch (const std::exception& error) {
    return tl::unexpected(path + " is no journal of tmcld: " + error.what());
  }
}

awaitable<void> Journal::write(std::shared_ptr<Journal> self) {
  if (self->closed_) co_return;
  auto held = self->held_();
  // What is being written now may be this.
  if (held == self->last_ && self->writing_ == 0) co_return;
  self->last_ = held;
  auto work = [path = self->path_, text = held.empty() ? "" : text_of(held),
               number = ++self->number_, written = self->written_]() -> std::string {
    if (*written > number) return {};
    auto failure = text.empty() ? remove_state_file(path) : replace_state_file(path, text);
    if (failure.empty()) *written = number;
    return failure;
  };
  ++self->writing_;
  std::string failure;
  try {
    failure = co_await elsewhere(self->writer_, std::move(work));
  } catch (const std::exception& error) {
    failure = "cannot write " + self->path_ + ": " + error.what();
  }
  --self->writing_;
  self->note(std::move(failure));
  if (!held.empty() && !std::exchange(self->follows_, true))
    spawn(co_await boost::asio::this_coro::executor, follow(self));
}

void Journal::note(std::string failure) {
  const bool is_news = failure_.empty() && !failure.empty();
  failure_ = std::move(failure);
  if (failure_.empty()) return;
  last_.reset();
  const auto line = "the journal is not kept, so nothing is put in order if tmcld is killed: ";
  if (const auto admitted = limiter_.admit(line + failure_, clock_.now()))
    log_(LogLevel::error, *admitted);
  if (is_news) on_failure_(failure_);
}

std::string journal_warning(const std::string& failure) {
  return "if tmcld is killed meanwhile, this is not stopped and no setting is set back: " + failure;
}

awaitable<void> Journal::follow(std::shared_ptr<Journal> self) {
  while (!self->closed_ && !(self->last_ && self->last_->empty())) {
    co_await rest(follow_interval);
    co_await write(self);
  }
  self->follows_ = false;
}

}  // namespace tmcld
