// tmcld: see command_line.cpp for what it says of itself.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>

#include <unistd.h>

#include <boost/asio/io_context.hpp>

#include "command_line.hpp"
#include "config/feeding.hpp"
#include "config/http_config.hpp"
#include "config/load.hpp"
#include "daemon.hpp"
#include "fronts/http_server.hpp"
#include "log/audit_trail.hpp"
#include "log/log.hpp"
#include "tmcl/plain_number.hpp"

namespace {

using namespace tmcld;

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string shown(double value) {
  constexpr int digits = 6;
  return tmcl::plain_number(value, digits);
}

int report(const std::vector<std::string>& problems, const std::string& path) {
  for (const auto& line : problems) std::fprintf(stderr, "%s\n", line.c_str());
  if (::access(path.c_str(), F_OK) != 0) {
    std::fprintf(stderr,
                 "  'tmcld --config FILE' takes another one; 'tmcld --help' shows the least that "
                 "there can be\n");
  }
  return exit_code::bad_usage;
}

void print_mechanics(const AxisConfig& axis) {
  const auto& scale = axis.scale;
  const bool has_unit = !scale.unit.empty();
  const std::string unit = " " + (has_unit ? scale.unit : "microsteps");
  const auto say = [](const char* before, double value, const std::string& after) {
    std::printf("%s%s%s", before, shown(value).c_str(), after.c_str());
  };
  std::printf("%s:", axis.name.c_str());
  if (has_unit) say(" ", scale.units_per_revolution, unit + " a turn");
  if (scale.gear_ratio != 1) say(" behind a gear of ", scale.gear_ratio, ":1");
  if (scale.limits) {
    say(has_unit ? ", from " : " from ", scale.limits->least.value, "");
    say(" to ", scale.limits->greatest.value, unit);
  }
  if (scale.encoder_counts_per_unit)
    say(", ", *scale.encoder_counts_per_unit, " encoder counts a" + unit);
  const auto& limits = axis.motion_limits;
  if (limits.velocity) say(", at most ", *limits.velocity, unit + "/s");
  if (limits.acceleration) say(", at most ", *limits.acceleration, unit + "/s^2");
  if (limits.deceleration) say(", braking ", *limits.deceleration, unit + "/s^2");
  if (limits.corner_jump) say(", corners ", *limits.corner_jump, unit + "/s");
  if (limits.current) std::printf(", current at most %d", *limits.current);
  std::printf("\n");
}

void print_access(const AccessConfig& access) {
  std::printf("%s:", std::string(name_of(access.role)).c_str());
  for (const auto& user : access.users) std::printf(" %s", user.name.c_str());
  for (const auto& group : access.groups) std::printf(" group %s", group.name.c_str());
  std::printf("\n");
}

void print_port(const PortConfig& port) {
  constexpr auto may = [](Role role) {
    if (role == Role::configure) return "read, stop, move and configure";
    return role == Role::operate ? "read, stop and move" : "read and stop";
  };
  std::printf("port %s: hosts may %s on bus %s\n", port.name.c_str(), may(port.role),
              port.bus.c_str());
}

void print_feeding(const BusConfig& bus) {
  const auto percent = feeding_percent(bus);
  if (percent == 0) return;
  std::printf(
      "%s: modules with a deadman are sent something often enough, which takes %s %% of the wire "
      "%s\n",
      bus.name.c_str(), tmcl::plain_number(percent, 2).c_str(), feeding_wire(bus).in_words.c_str());
  const auto steady = shortest_steady_deadman(bus).count();
  for (const auto& module : bus.modules) {
    const auto ms = module.deadman_ms.value_or(0);
    if (ms == 0 || ms >= steady) continue;
    std::printf(
        "%s: the motors of module %u stop when one answer is lost: that is made up for "
        "with a deadman_ms of %lld or more, or a shorter reply_timeout_ms\n",
        bus.name.c_str(), unsigned{number(module.address)}, static_cast<long long>(steady));
  }
}

int check(const LoadedConfig& loaded, const std::optional<HttpConfig>& http) {
  const auto& config = loaded.config;
  auto problems = http ? problems_of_files(*http) : std::vector<std::string>{};
  if (auto problem = AuditTrail::problem_of(config.daemon.audit); !problem.empty())
    problems.push_back(std::move(problem));
  for (const auto& problem : problems) std::fprintf(stderr, "%s\n", problem.c_str());
  if (!problems.empty()) return exit_code::bad_usage;
  std::printf("ok: %s, %s", counted(config.buses.size(), "bus", "buses").c_str(),
              counted(config.axes.size(), "axis", "axes").c_str());
  if (loaded.files > 1) std::printf(", from %zu files", loaded.files);
  std::printf("\n");
  for (const auto& bus : config.buses) print_feeding(bus);
  for (const auto& axis : config.axes) {
    if (!axis.scale.unit.empty() || axis.scale.limits || axis.motion_limits.of_settings() ||
        axis.motion_limits.corner_jump)
      print_mechanics(axis);
  }
  for (const auto& access : config.access) print_access(access);
  for (const auto& port : config.ports) print_port(port);
  for (const auto& advice : http ? advice_on_files(*http) : std::vector<std::string>{})
    std::printf("%s\n", advice.c_str());
  return exit_code::ok;
}

[[noreturn]] void end_at_once(int code) {
  end_log();
  std::_Exit(code);
}

/// From the files as they are then.
Daemon::LoadAgain loading(const std::string& path) {
  return
      [path](const std::optional<std::string>& managed) { return load_config_with(path, managed); };
}

int serve(const Config& config, const std::string& path, const std::optional<HttpConfig>& http) {
  // A peer that has gone is an error value of the write, not the end of the daemon.
  std::signal(SIGPIPE, SIG_IGN);
  // So is a file that may not grow.
  std::signal(SIGXFSZ, SIG_IGN);
  auto service = Service::of_environment();
  if (!service) {
    log(LogLevel::error, service.error());
    return exit_code::runtime_failure;
  }
  boost::asio::io_context context(1);
  auto daemon = Daemon::create(context, config, open_configured_link, std::move(*service), http);
  if (!daemon) {
    log(LogLevel::error, daemon.error());
    return exit_code::runtime_failure;
  }
  (*daemon)->load_by(loading(path));
  (*daemon)->end_on_signals();
  log(LogLevel::info,
      "serving " + counted(config.axes.size(), "axis", "axes") + " on " + config.daemon.socket);
  const int code = (*daemon)->run() ? exit_code::ok : exit_code::runtime_failure;
  log(LogLevel::info, "ended");
  // Opening a link cannot be called back; nothing else is left to be done, so it is not waited for.
  if ((*daemon)->is_opening_links()) end_at_once(code);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  const auto parsed = parse_command_line(argc, argv);
  if (const auto* code = std::get_if<ExitCode>(&parsed)) return code->value;
  const auto& command_line = std::get<CommandLine>(parsed);
  const auto loaded = load_config(command_line.config_file);
  if (!loaded) return report(loaded.error(), command_line.config_file);
  const auto http = load_http_config(command_line.config_file);
  if (!http) return report(http.error(), command_line.config_file);
  if (command_line.only_check) return check(*loaded, *http);
  start_log(loaded->config.daemon.log_level);
  int code = exit_code::runtime_failure;
  try {
    code = serve(loaded->config, command_line.config_file, *http);
  } catch (...) {  // nothing was served yet, or nothing is any more
    log_failure(tmcld::log, "tmcld", std::current_exception());
  }
  if (!end_log()) std::_Exit(code);
  return code;
}
