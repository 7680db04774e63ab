#include "managed_configuration.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "config/files.hpp"
#include "daemon.hpp"
#include "gateway/store/state_file.hpp"
#include "log/log.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using tmcl::api::configuration::Managed;
using tmcl::api::configuration::Set;
using tmcl::api::configuration::Taken;

/// Told in an error, of a text that may be wrong in every line.
constexpr std::size_t most_problems = 100;

Error cannot_reload(std::string why, std::string hint = {}) {
  return not_now("cannot_reload", std::move(why), std::move(hint));
}

Error error_of_files(const tmcl::TextProblems& problems) {
  const auto first = describe(problems.front());
  if (problems.front().line == 0) return cannot_reload(first);
  auto error = param_error<&Set::toml>("bad_configuration", first);
  boost::json::array all;
  for (const auto& one : problems) {
    if (all.size() == most_problems) break;
    all.push_back(boost::json::object{
        {"file", one.file}, {"line", one.line}, {"column", one.column}, {"message", one.message}});
  }
  error.subject["problems"] = std::move(all);
  return error;
}

/// `reloaded`: the first line says why not.
Result<std::string> words_or_error(tl::expected<std::string, std::vector<std::string>> reloaded) {
  if (reloaded) return std::move(*reloaded);
  return tl::unexpected(cannot_reload(std::move(reloaded.error().front())));
}

Error not_kept(std::string message) {
  return failed("not_kept", std::move(message),
                "look at the folder of that file: is there room, and may tmcld write there?");
}

Error in_force_but_not_kept(const std::string& why) {
  auto error =
      not_kept("tmcld goes by this configuration, but would not if it were started again: " + why);
  error.outcome = tmcl::Outcome::done;
  return error;
}

}  // namespace

/// What a daemon would go by.
struct ManagedConfiguration::Next {
  std::string file;
  std::string toml;
  bool changed = true;
  Config config{};
};

std::string ManagedConfiguration::file() const {
  return daemon_.load() ? daemon_.config().managed : std::string();
}

awaitable<Result<Managed>> ManagedConfiguration::get() {
  const auto path = file();
  if (path.empty()) co_return Managed{};
  auto work = [path] { return read_managed_file(path); };
  const auto read = co_await daemon_.gateway().planner.plan(std::move(work));
  if (!read) co_return tl::unexpected(failed("not_readable", describe(read.error())));
  Managed managed{path};
  if (*read) managed.toml = (*read)->text;
  co_return managed;
}

awaitable<Result<Taken>> ManagedConfiguration::set(Set wish, Client client) {
  const auto turn = co_await daemon_.take_turn_to_load(client.number);
  auto next = co_await read(std::move(wish.toml));
  if (!next) co_return tl::unexpected(std::move(next.error()));
  Taken taken{next->changed};
  Result<std::string> words;
  if (wish.dry_run.value_or(false)) {
    words = co_await foresee(std::move(*next));
  } else {
    words = co_await carry_out(std::move(*next), std::move(client));
  }
  if (!words) co_return tl::unexpected(std::move(words.error()));
  taken.buses = std::move(*words);
  co_return taken;
}

awaitable<Result<ManagedConfiguration::Next>> ManagedConfiguration::read(std::string toml) const {
  Next next{file(), std::move(toml)};
  if (next.file.empty()) co_return tl::unexpected(not_managed());
  auto work = [load = daemon_.load(), next]() mutable -> Result<Next> {
    auto config = load(next.toml);
    if (!config) return tl::unexpected(error_of_files(config.error()));
    const auto present = read_managed_file(next.file);
    // One that cannot be read is another one.
    next.changed = !present || !*present || (*present)->text != next.toml;
    next.config = std::move(*config);
    return std::move(next);
  };
  auto read = co_await daemon_.gateway().planner.plan(std::move(work));
  if (read && read->config.daemon.managed != read->file) {
    co_return tl::unexpected(cannot_reload("'managed' in [daemon] has changed",
                                           "let tmcld take that over: systemctl reload tmcld"));
  }
  co_return read;
}

awaitable<Result<std::string>> ManagedConfiguration::foresee(Next next) const {
  auto foreseen = co_await Daemon::foresee(daemon_, next.config);
  co_return words_or_error(std::move(foreseen));
}

// The text is on the disk before the daemon goes by it, so that a full disk changes nothing, and it
// takes the place of the old one after that, so that no text is ever found there which a daemon has
// refused. Between the two is a rename: if that fails, or the computer does, the old text is there.
awaitable<Result<std::string>> ManagedConfiguration::carry_out(Next next, Client client) const {
  auto& planner = daemon_.gateway().planner;
  auto write = [file = next.file, toml = std::move(next.toml)] {
    return StagedFile::write(file, toml);
  };
  auto staged = co_await planner.plan(std::move(write));
  if (!staged)
    co_return tl::unexpected(not_kept("the configuration stays as it was: " + staged.error()));
  auto reloaded = co_await Daemon::reload(daemon_, std::move(next.config));
  auto words = words_or_error(std::move(reloaded));
  if (!words) co_return words;
  log(LogLevel::info, fmt::format("the configuration was set by {}: {}", client.name, *words));
  auto replace = [file = std::move(*staged)]() mutable { return file.put_in_place(); };
  const auto failure = co_await planner.plan(std::move(replace));
  if (failure.empty()) co_return words;
  log(LogLevel::error,
      "the configuration that was set would be lost if tmcld were started again: " + failure);
  co_return tl::unexpected(in_force_but_not_kept(failure));
}

}  // namespace tmcld
